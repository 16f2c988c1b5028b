//! `trirrr run` for a redundant machine.

use super::document::played;
use super::plant::{plant_table, simulate_plant};
use super::read;
use crate::failure::CliError;
use crate::figures::DrawnJob;
use crate::histogram::Histogram;
use crate::realtime::Pacer;
use crate::recording::{LagrangeColumns, Recorder};
use crate::results::ResultFolder;
use crate::run::{JobEnd, RunArgs, RunReport, RunResult};
use crate::terminal::show;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use trirrr_linkage::redundant::scene::{RedundantPlayer, RedundantScene};
use trirrr_plant::redundant::RedundantOutcome;
use trirrr_scene::NumberType;

/// Result of a run.
pub(super) type RedundantReport = RunReport<RedundantOutcome>;

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
    report.end()
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
    let results = ResultFolder::for_command(folder, "run")?;
    let mut results = results.with_pictures(args.pictures.png);
    let table = plant_table(scene, &mut results)?;
    let setpoints = u64::from(player.ticks()) + 1;
    let lagrange = args.lagrange.then(|| LagrangeColumns::of_redundant(scene));
    let drawn = DrawnJob::of_redundant(scene);
    let mut recorder = Recorder::create(results, setpoints, drawn, lagrange)?.thinned(args.every);
    let mut computation = Histogram::default();
    let start = Instant::now();
    let mut pacer = (!args.fast).then(|| Pacer::start(scene.tick_rate_hz));
    let mut end = JobEnd::Complete;
    for tick in 0..=player.ticks() {
        let is_due = match &mut pacer {
            Some(pacer) => pacer.wait(u64::from(tick), stop),
            None => !stop.load(Ordering::Relaxed),
        };
        if !is_due {
            end = JobEnd::Stopped;
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
    let played = RunResult {
        end,
        elapsed: start.elapsed(),
        computation,
        deadlines: pacer.map(Pacer::finish),
    };
    let is_complete = played.end == JobEnd::Complete;
    let (job, mut results) = recorder.finish(&scene.name, is_complete)?;
    let plant = table
        .filter(|_| is_complete)
        .map(|table| simulate_plant(scene, table, &mut results, &job.motors, stop));
    let mut report = RunReport {
        played,
        setpoints,
        scalar: NumberType::F64,
        drives: None,
        plant: plant.transpose()?,
        job,
    };
    report.job.files.extend(results.pictures()?);
    results.end(report.reason().as_deref())?;
    Ok(report)
}
