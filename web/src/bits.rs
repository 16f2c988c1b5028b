//! The bits of a job's results, to be compared between WebAssembly and the native core.

use crate::Reading;
use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_scene::{JobMove, JobPlayer, Scene, in_number_type, pipeline};
use wasm_bindgen::prelude::wasm_bindgen;

/// Offset and prime of the 64-bit FNV-1a, here over words in place of bytes.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Numbers of a move: poses, velocities and accelerations at both ends, ticks.
const MOVE: usize = 19;

/// Hash over the bits of `ticks` records of the job in `text`, in hexadecimal.
///
/// The job is played in the number type of the scene until there are enough ticks, each time with moves that are a tick longer, so that no
/// setpoint comes twice. A setpoint without a motion counts with its reason. `moves`, if there are any, go in place of those of a path:
/// plans take functions of the platform's library of mathematics, whose last bit differs from one to another. `machine` is as in
/// [`Reading::draft`].
///
/// # Errors
/// The refusal of the scene; `moves` that are none.
#[wasm_bindgen(js_name = bitsOf)]
pub fn bits_of(
    text: &str,
    file: &str,
    machine: Option<String>,
    ticks: u32,
    moves: &[f64],
) -> Result<String, String> {
    let scene = match moves {
        [] => good(text, file, machine)?,
        numbers => {
            let draft = Reading::draft(text, file, machine);
            let mut scene = draft.draft_scene()?.clone();
            scene.job.moves = moves_from(numbers)?;
            scene
        }
    };
    let hash = in_number_type!(scene.number, N => hash::<N>(&scene, ticks))?;
    Ok(format!("{hash:016x}"))
}

/// Moves of the path in `text` as numbers for [`bits_of`]; none of a job without a path.
///
/// # Errors
/// The refusal of the scene.
pub fn planned_moves(text: &str, file: &str, machine: Option<String>) -> Result<Vec<f64>, String> {
    let scene = good(text, file, machine)?;
    let pose = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let moves = scene.job.moves.iter().filter_map(|each| {
        let [begin, end] = each.accelerations?;
        let ends = [
            pose(&each.from),
            pose(&each.to),
            each.start_velocity.into(),
            each.end_velocity.into(),
            begin.into(),
            end.into(),
        ];
        let ticks = f64::from(each.duration_ticks);
        Some(ends.into_iter().flatten().chain([ticks]))
    });
    Ok(match scene.job.path {
        Some(_) => moves.flatten().collect(),
        None => Vec::new(),
    })
}

fn good(text: &str, file: &str, machine: Option<String>) -> Result<Scene, String> {
    let reading = Reading::whole(text, file, machine);
    let scene = reading.good().cloned();
    scene.map_err(|reason| reading.refusal().unwrap_or(reason))
}

fn moves_from(numbers: &[f64]) -> Result<Vec<JobMove>, String> {
    let moves = numbers.chunks(MOVE).map(|numbers| {
        let numbers = <[f64; MOVE]>::try_from(numbers).ok();
        let ticks = numbers.map_or(0.0, |numbers| numbers[MOVE - 1]);
        let numbers = numbers.filter(|_| (1.0..=f64::from(u32::MAX)).contains(&ticks));
        let [x, y, alpha, to_x, to_y, to_alpha, ends @ .., _] =
            numbers.ok_or("a move has 19 numbers: six triples, and ticks from 1")?;
        let triple = |index: usize| Vector3::from_column_slice(&ends[3 * index..][..3]);
        Ok(JobMove {
            from: Pose::from_f64(x, y, alpha),
            to: Pose::from_f64(to_x, to_y, to_alpha),
            start_velocity: triple(0),
            end_velocity: triple(1),
            accelerations: Some([triple(2), triple(3)]),
            duration_ticks: ticks as u32,
            tool: None,
        })
    });
    moves.collect()
}

fn hash<N: Number>(scene: &Scene, ticks: u32) -> Result<u64, String> {
    let job = pipeline::scene::<N>(scene)?;
    let mut moves = scene.job.in_units(&job.units);
    let period = job.units.time(scene.period_s());
    let mut hash = OFFSET;
    let mut add = |word: u64| hash = (hash ^ word).wrapping_mul(PRIME);
    let mut left = ticks;
    while left > 0 {
        let player = JobPlayer::<N>::new(&moves, period);
        let count = left.min(player.ticks().saturating_add(1));
        for tick in 0..count {
            match job.machine.evaluate(f64::from(tick), &player.at(tick)) {
                Ok(record) => record.tick_row(true).for_each(|value| add(value.to_bits())),
                Err(status) => status.to_string().bytes().for_each(|byte| add(byte.into())),
            }
        }
        left -= count;
        for each in &mut moves.moves {
            each.duration_ticks = each.duration_ticks.saturating_add(1);
        }
    }
    Ok(hash)
}
