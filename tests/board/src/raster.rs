//! A raster image of pixels each of which has another power than the one before, sample by sample.

use crate::conversation::{Conversation, Moment};
use crate::expected::Expected;
use crate::port::Port;
use anyhow::{Context, Result, ensure};
use std::ops::ControlFlow;
use trirrr_bench::faulty_link::Random;
use trirrr_client::JobWork;
use trirrr_client::local::HostNumber;
use trirrr_core::setpoint::{Pose, Quintics, Segment};
use trirrr_plan::course::PathPiece;
use trirrr_plan::piece::Piece;
use trirrr_protocol::message::{FULL_LEVEL, LEVEL_PARTS, LevelRange, Telemetry, TelemetryFields};
use trirrr_scene::{JobLevels, JobMove, JobPath, LevelRow, Scene, Tool, offer};

/// Length of a pixel, m.
const PITCH_M: f64 = 1e-4;

/// Pixels of a row.
const PIXELS: usize = 540;

/// Way before and behind a row, m.
const OVERSCAN_M: f64 = 3e-3;

/// Speed along rows, m/s.
const FEED_M_S: f64 = 0.1;

/// Power at the full level and that speed.
const POWER: f64 = 0.8;

/// Distance of a border of pixels, in pixels, within which either of both may be played: what the number type rounds.
const BORDER: f64 = 0.01;

/// Rows to and fro on the same line, and their levels.
struct RasterJob {
    moves: Vec<JobMove>,
    /// Moves of a pass to and fro.
    pass: usize,
    levels: JobLevels,
    /// Levels of all rows.
    tones: Vec<[u8; PIXELS]>,
    /// Of each move of a pass that is on a row: the row of the pass.
    rows: Vec<Option<usize>>,
}

/// Power lists of `seconds` or a little more.
///
/// # Errors
/// The machine cannot play the rows.
fn job(scene: &Scene, seconds: f64, seed: u64) -> Result<RasterJob> {
    let start = scene.job.start;
    let at = |way: f64| Pose::from_f64(start.position.x + way, start.position.y, start.angle);
    let end = 2.0 * OVERSCAN_M + PIXELS as f64 * PITCH_M;
    let ends = [0.0, OVERSCAN_M, end - OVERSCAN_M, end];
    let forth = ends.windows(2).map(|pair| [pair[0], pair[1]]);
    let back = ends.windows(2).rev().map(|pair| [pair[1], pair[0]]);
    let ways: Vec<[f64; 2]> = forth.chain(back).collect();
    let is_row = |source: usize| source % 3 == 1;
    let pieces = ways.iter().enumerate();
    let pieces = pieces.map(|(source, [from, to])| PathPiece {
        piece: Piece::line(at(*from), at(*to)),
        feed_m_s: Some(FEED_M_S),
        source,
        stops: source % 3 == 0,
        setting: usize::from(is_row(source)),
    });
    let tool = Tool {
        power: POWER,
        speed_m_s: FEED_M_S,
    };
    let row = |source: usize| LevelRow {
        source,
        ends_m: ways[source].map(|way| at(way).position.into()),
        levels: vec![0; PIXELS],
    };
    let path = JobPath {
        pieces: pieces.collect(),
        tools: (0..ways.len())
            .map(|source| is_row(source).then_some(tool))
            .collect(),
        rows: vec![row(1), row(4)],
        tolerance_m: 1e-5,
        tolerance_rad: 1e-4,
        ..JobPath::default()
    };
    let mut planned = scene.clone();
    planned.take_path(&path)?;
    let mut moves = planned.job.moves;
    // A pass ends where the next one begins, but for rounding.
    moves.last_mut().context("no moves")?.to = moves[0].from;
    let ranges = planned.job.levels.ranges;
    let mut rows = vec![None; moves.len()];
    let mut pass = Vec::new();
    let mut begin = [0; 2];
    for (index, range) in &ranges {
        let each = &moves[*index as usize];
        // Forth, or back.
        let row = usize::from(each.to.position.x < each.from.position.x);
        rows[*index as usize] = Some(row);
        // The place of a move is known to some parts of a level.
        let whole = u64::from(LEVEL_PARTS);
        let first = ((begin[row] + whole / 2 - u64::from(range.offset)) / whole) as usize;
        pass.push((*index, row, first, *range));
        begin[row] += u64::from(range.span);
    }
    let ticks: u64 = moves
        .iter()
        .map(|each| u64::from(each.duration_ticks))
        .sum();
    let passes = (seconds * scene.tick_rate_hz / ticks as f64)
        .ceil()
        .max(1.0) as usize;
    let mut random = Random::new(seed);
    let (mut levels, mut tones) = (JobLevels::default(), Vec::new());
    for count in 0..passes {
        let mut before = 0;
        for _ in 0..2 {
            tones.push([0; PIXELS].map(|_: u8| {
                // Another than the one before.
                before = (before + 1 + random.below(255)) % 256;
                before as u8
            }));
        }
        for (index, row, first, range) in &pass {
            let own = &tones[2 * count + row][*first..*first + usize::from(range.count)];
            let first = levels.levels.len() as u32;
            levels.levels.extend_from_slice(own);
            let index = (count * moves.len()) as u32 + index;
            levels.ranges.push((index, LevelRange { first, ..*range }));
        }
    }
    Ok(RasterJob {
        pass: moves.len(),
        moves: moves.repeat(passes),
        levels,
        tones,
        rows,
    })
}

impl RasterJob {
    /// Powers that the tool may have at a tick of a move, with the number of the pixel in all rows: one, or two at a border.
    fn powers(&self, scene: &Scene, index: usize, at: u32) -> Vec<(Option<usize>, f64)> {
        let Some(row) = self.rows[index % self.pass] else {
            return vec![(None, 0.0)];
        };
        let each = &self.moves[index];
        let period_s = scene.period_s();
        let segment: Segment<f64, Quintics> = each.segment(each.duration_ticks, period_s);
        let setpoint = segment.at(at);
        let [vx, vy] = [setpoint.velocity.x, setpoint.velocity.y];
        // The tool keeps its power for the tick: the pixel is that of its middle.
        let x = setpoint.pose.position.x + 0.5 * vx * period_s;
        let way = (x - scene.job.start.position.x - OVERSCAN_M) / PITCH_M;
        let place = if row == 0 { way } else { PIXELS as f64 - way };
        let row = 2 * (index / self.pass) + row;
        let power = |place: f64| {
            let pixel = (place.max(0.0) as usize).min(PIXELS - 1);
            let level = f64::from(self.tones[row][pixel]) / f64::from(FULL_LEVEL);
            (
                Some(row * PIXELS + pixel),
                POWER * vx.hypot(vy) / FEED_M_S * level,
            )
        };
        let mut powers = vec![power(place - BORDER), power(place + BORDER)];
        powers.dedup_by_key(|(pixel, _)| *pixel);
        powers
    }
}

pub(crate) fn run<N: HostNumber>(
    expected: &Expected<N>,
    mut port: Port,
    seconds: f64,
    seed: u64,
) -> Result<()> {
    let job = job(&expected.scene, seconds, seed)?;
    let ticks: u64 = job
        .moves
        .iter()
        .map(|each| u64::from(each.duration_ticks))
        .sum();
    let mut scene = expected.scene.clone();
    scene.job.moves.clone_from(&job.moves);
    let moves = offer::moves::<N>(&scene, &expected.units);
    port.wait_for_board::<N>()?;
    let mut conversation = Conversation::undisturbed(port).with_fields(TelemetryFields::TOOL);
    let mut seen = vec![false; job.tones.len() * PIXELS];
    let (mut samples, mut last) = (0_u64, None);
    let work = JobWork::of(moves, &job.levels);
    let see = |sample: &Telemetry<N>, moment: Moment| {
        let index = sample.number as usize;
        if !sample.state.is_running() || index >= job.moves.len() {
            return Ok(if moment.over {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            });
        }
        ensure!(sample.part == 0, "off the ticks of the path: {sample:?}");
        let powers = job.powers(&expected.scene, index, sample.at);
        let tool = sample.tool.to_f64();
        let found = powers.iter().find(|(_, power)| (tool - power).abs() < 1e-3);
        let Some((pixel, _)) = found else {
            anyhow::bail!(
                "move {index}, tick {}: a power of {tool}, expected is {powers:?}",
                sample.at
            );
        };
        if let Some(pixel) = pixel {
            seen[*pixel] = true;
        }
        samples += 1;
        last = Some(sample.tick);
        Ok(ControlFlow::Continue(()))
    };
    let client = conversation.play(expected, work, see)?;
    let status = client.status().context("no status")?;
    let burnt = seen.iter().filter(|seen| **seen).count();
    let seconds = ticks as f64 / expected.scene.tick_rate_hz;
    println!(
        "{} rows of {PIXELS} pixels of {} mm at {} mm/s, {} moves in {seconds:.1} s: {burnt} of {} pixels seen in {samples} samples, each with \
         its power; {} samples lost, {} dry ticks, {:.0} bytes/s to the board",
        job.tones.len(),
        1e3 * PITCH_M,
        1e3 * FEED_M_S,
        job.moves.len(),
        seen.len(),
        status.lost,
        client.dry_ticks(),
        conversation.tally.bytes as f64 / seconds,
    );
    ensure!(
        client.dry_ticks() == 0,
        "the queue was dry for {} ticks",
        client.dry_ticks()
    );
    // A sample that is lost hides a pixel.
    let missed = seen.len() - burnt;
    ensure!(
        missed <= status.lost as usize,
        "{missed} pixels were not burnt"
    );
    ensure!(
        last.is_some() && 2 * samples > ticks,
        "{samples} samples of {ticks} ticks"
    );
    Ok(())
}
