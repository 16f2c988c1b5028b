//! The bits of a job's results, to be compared between WebAssembly and the native core.

use crate::Reading;
use trirrr_core::number::Number;
use trirrr_scene::{JobPlayer, Scene, in_number_type, pipeline};
use wasm_bindgen::prelude::wasm_bindgen;

/// Offset and prime of the 64-bit FNV-1a, here over words in place of bytes.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Hash over the bits of `ticks` records of the job in `text`, in hexadecimal.
///
/// The job is played in the number type of the scene until there are enough ticks, each time with moves that are a tick longer, so that no
/// setpoint comes twice. A setpoint without a motion counts with its reason. A path is planned here: the moves of a plan have the same bits on
/// every machine, too. `machine` is as in [`Reading::draft`].
///
/// # Errors
/// The refusal of the scene.
#[wasm_bindgen(js_name = bitsOf)]
pub fn bits_of(
    text: &str,
    file: &str,
    machine: Option<String>,
    ticks: u32,
) -> Result<String, String> {
    let reading = Reading::whole(text, file, machine);
    let scene = reading.good();
    let scene = scene.map_err(|reason| reading.refusal().unwrap_or(reason))?;
    let hash = in_number_type!(scene.number, N => hash::<N>(scene, ticks))?;
    Ok(format!("{hash:016x}"))
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
