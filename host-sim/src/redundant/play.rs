//! `trirrr run` for a redundant machine.

use super::document::played;
use super::peaks::RedundantPeaks;
use super::plant::{SimulatedMachine, claim_plant, simulate_plant};
use super::read;
use super::record::RedundantRecorder;
use crate::failure::CliError;
use crate::histogram::Histogram;
use crate::player::STOPPED;
use crate::realtime::Pacer;
use crate::recording::{LagrangeColumns, LagrangeFound};
use crate::results::ResultFolder;
use crate::run::{JobEnd, RunArgs, RunResult};
use crate::terminal::show;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use trirrr_linkage::redundant::scene::{RedundantPlayer, RedundantScene};
use trirrr_scene::NumberType;

/// Result of a run.
pub(super) struct RedundantReport {
    pub(super) played: RunResult,
    pub(super) rows: u64,
    pub(super) peaks: Option<RedundantPeaks>,
    pub(super) lagrange: Option<LagrangeFound>,
    pub(super) plant: Option<SimulatedMachine>,
    pub(super) files: Vec<PathBuf>,
}

impl RedundantReport {
    /// Files of the job and of the plant.
    pub(super) fn all_files(&self) -> Vec<PathBuf> {
        let of_plant = self.plant.iter().flat_map(|plant| &plant.files);
        self.files.iter().chain(of_plant).cloned().collect()
    }
}

/// Plays the job of the scene, and its plant if it has one; prints the summary. `stop` ends the run early.
///
/// # Errors
/// Refused: the scene, or an argument that is for a 3-RRR alone. Failed: something cannot be written, or the plant ends
/// early.
pub fn run(args: &RunArgs, stop: &AtomicBool) -> Result<JobEnd, CliError> {
    refuse_arguments(args)?;
    let scene = read(&args.scene, &args.job)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&scene.name),
    };
    let report = play(&scene, args, &folder, stop)?;
    show(&played(&args.scene, &scene, &report), args.json)?;
    let plant = report.plant.as_ref().map(|plant| &plant.outcome);
    let failure = plant.and_then(|outcome| outcome.failure.as_ref());
    match failure {
        Some(failure) => Err(CliError::Failed(format!("plant: {failure}"))),
        None if report.played.end != JobEnd::Complete
            || plant.is_some_and(|outcome| outcome.is_stopped) =>
        {
            Ok(JobEnd::Stopped)
        }
        None => Ok(JobEnd::Complete),
    }
}

/// Refuses what a redundant machine has not.
fn refuse_arguments(args: &RunArgs) -> Result<(), CliError> {
    let number = args.scalar.filter(|number| *number != NumberType::F64);
    let reason = match (number, args.then.is_empty(), args.tolerances) {
        (Some(_), ..) => "--scalar: a redundant machine is computed in f64",
        (_, false, _) => "a redundant machine plays one scene at a time",
        (_, _, true) => "--tolerances bounds a 3-RRR alone",
        _ => return Ok(()),
    };
    Err(CliError::Refused(format!(
        "{}: {reason}",
        args.scene.display()
    )))
}

fn play(
    scene: &RedundantScene,
    args: &RunArgs,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<RedundantReport, CliError> {
    let machine = scene
        .pipeline()
        .map_err(|error| CliError::Refused(format!("scene {}: {error}", scene.name)))?;
    let player = RedundantPlayer::new(scene);
    let mut results = ResultFolder::for_command(folder, "run")?;
    claim_plant(scene, &mut results)?;
    let lagrange = args.lagrange.then(|| LagrangeColumns::of_redundant(scene));
    let mut recorder = RedundantRecorder::create(&mut results, scene, args.every, lagrange)?;
    results.begin()?;
    let mut computation = Histogram::default();
    let start = Instant::now();
    let mut pacer = (!args.fast).then(|| Pacer::start(scene.tick_rate_hz));
    let mut is_complete = true;
    for tick in 0..=player.ticks() {
        let is_due = match &mut pacer {
            Some(pacer) => pacer.wait(u64::from(tick), stop),
            None => !stop.load(Ordering::Relaxed),
        };
        if !is_due {
            is_complete = false;
            break;
        }
        let begin = Instant::now();
        let record = player.record(&*machine, tick);
        computation.push(begin.elapsed());
        if let Some(pacer) = &mut pacer {
            pacer.done(u64::from(tick));
        }
        // The reader has evaluated every tick.
        let record = record.map_err(|status| CliError::Failed(format!("tick {tick}: {status}")))?;
        recorder.record(&record)?;
    }
    let elapsed = start.elapsed();
    let (rows, peaks) = (recorder.rows, recorder.peaks.take());
    let heading = match is_complete {
        true => scene.name.clone(),
        false => format!("{} until tick {rows}", scene.name),
    };
    let (files, lagrange) = recorder.finish(&mut results, &heading)?;
    let plant = match &scene.plant {
        Some(_) if is_complete => Some(simulate_plant(scene, &mut results, stop)?),
        _ => None,
    };
    let report = RedundantReport {
        played: RunResult {
            end: match is_complete {
                true => JobEnd::Complete,
                false => JobEnd::Stopped,
            },
            elapsed,
            computation,
            deadlines: pacer.map(Pacer::finish),
        },
        rows,
        peaks,
        lagrange,
        plant,
        files,
    };
    let outcome = report.plant.as_ref().map(|plant| &plant.outcome);
    let why = match outcome {
        _ if !is_complete => Some(STOPPED),
        Some(outcome) if outcome.is_stopped => Some(STOPPED),
        Some(outcome) => outcome.failure.as_deref(),
        None => None,
    };
    results.end(why)?;
    Ok(report)
}
