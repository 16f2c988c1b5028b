//! `trirrr run`: plays the job of a scene on its service, tick by tick, in real time or as fast as the
//! computer can.

mod args;
pub(crate) mod document;
mod plant;
mod plant_document;
mod play;
mod progress;
mod report;
mod simulate;
mod tolerances;

pub use args::RunArgs;
pub(crate) use plant::PlantTable;
pub use plant::Simulated;
pub use report::{JobEnd, RunReport, RunResult};

use crate::failure::CliError;
use crate::figures::DrawnJob;
use crate::job_file::{self, LongMoves, QueuedJob};
use crate::player::{PlayedScene, STOPPED};
use crate::recording::Recorder;
use crate::redundant;
use crate::results::ResultFolder;
use crate::terminal::{say, show};
use document::RunScene;
use simulate::simulate_in;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use trirrr_figures::document::Facts;
use trirrr_scene::{NumberType, Scene, in_number_type};

/// Ticks that may wait for the recorder before the machine has to. Each is about 1 KB.
const WAITING: usize = 4096;

/// Rows and columns of `ticks.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickRows {
    /// The first of so many ticks has a row.
    pub every: u32,
    /// Rows have the torques of Lagrange's equations too.
    pub lagrange: bool,
}

impl TickRows {
    /// All ticks.
    pub const ALL: Self = Self {
        every: 1,
        lagrange: false,
    };

    fn of(args: &RunArgs) -> Self {
        Self {
            every: args.every,
            lagrange: args.lagrange,
        }
    }
}

/// `trirrr run`: reads the scene, runs it, prints the summary. `stop` ends it early.
///
/// Returns how the run ended.
///
/// # Errors
/// Refused: the scene, or its number type. Failed: something cannot be written.
pub fn command(args: &RunArgs, stop: &AtomicBool) -> Result<JobEnd, CliError> {
    args.pictures.require()?;
    if redundant::is_redundant(&args.scene, &args.job) {
        return redundant::run(args, stop);
    }
    // Tolerances look at all moves, and numbers of little range need units for all.
    let moves = match args.tolerances || args.scalar == Some(NumberType::Fixed) {
        true => LongMoves::InMemory,
        false => LongMoves::InFile,
    };
    let (out, then) = (args.out.as_deref(), &args.then);
    let mut jobs = job_file::load_queue(&args.scene, then, &args.job, moves, out, "")?;
    // A job of its own file is none that the board repeats.
    let own = jobs
        .iter_mut()
        .filter(|queued| queued.job.machine.is_none());
    own.for_each(|queued| unroll(&mut queued.job.scene));
    refuse_folders(&jobs)?;
    jobs.iter().for_each(|queued| queued.job.warn());
    for QueuedJob { file, job, folder } in &jobs {
        let end = run_job(args, file, &job.scene, folder, stop)?;
        if end != JobEnd::Complete {
            return Ok(end);
        }
    }
    Ok(JobEnd::Complete)
}

/// Gives a job that its board plays by itself all its passes.
fn unroll(scene: &mut Scene) {
    let Some(own) = scene.service.autonomous else {
        return;
    };
    let played = scene.unroll();
    if played != own.passes {
        say("the board repeats this job by itself: one pass of it is played here");
    }
}

/// Refuses folders that cannot take the results, before the first job is played.
fn refuse_folders(jobs: &[QueuedJob]) -> Result<(), CliError> {
    for QueuedJob { job, folder, .. } in jobs {
        ResultFolder::for_command(folder, "run")?
            .claim(Recorder::names(&DrawnJob::of(&job.scene)))?;
    }
    Ok(())
}

fn run_job(
    args: &RunArgs,
    file: &Path,
    scene: &Scene,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<JobEnd, CliError> {
    // First: a scene that is refused leaves no files.
    if args.lagrange && !scene.torque {
        return Err(CliError::Refused(format!(
            "{}: --lagrange compares torques, and the scene computes none (torque = false)",
            file.display()
        )));
    }
    let analysis = match args.tolerances {
        true => Some(tolerances::prepare(file, scene)?),
        false => None,
    };
    let scalar = args.scalar.unwrap_or(scene.number);
    let mut results = ResultFolder::for_command(folder, "run")?.with_pictures(args.pictures.png);
    if analysis.is_some() {
        results.claim(tolerances::names(scene.torque))?;
    }
    let rows = TickRows::of(args);
    let (mut report, mut results) = simulate_into(scene, scalar, !args.fast, rows, results, stop)?;
    report.job.files.extend(results.pictures()?);
    results.end(report.reason().as_deref())?;
    let number = Facts::new().pair("number", "numbers", scalar.name());
    let played = RunScene {
        name: &scene.name,
        description: &scene.description,
        file,
        moves: scene.job.count(),
        ticks: scene.ticks(),
        rate_hz: scene.tick_rate_hz,
        torque: scene.torque,
        head: number.words(scalar.to_string()),
        hold: scene.longest_stop().map(|longest| longest.to_string()),
    };
    let mut document = document::document(played, &report);
    let mut files = report.all_files();
    let mut end = report.end();
    if let Some(analysis) = analysis.filter(|_| report.played.end == JobEnd::Complete) {
        results.end(Some("the tolerances are under way"))?;
        let bounded = tolerances::bound(scene, analysis, &mut results, stop)?;
        files.extend(bounded.files().iter().cloned().chain(results.pictures()?));
        let why = bounded.is_stopped().then(|| STOPPED.into());
        let why = why.or_else(|| report.reason());
        results.end(why.as_deref())?;
        bounded.add_to(&mut document);
        if bounded.is_stopped() {
            end = Ok(JobEnd::Stopped);
        }
    }
    match &report.plant {
        Some(simulated) => plant_document::add_to(&mut document, simulated),
        None => {
            document.data("plant", ());
        }
    }
    show(document.files(files), args.json)?;
    end
}

/// Runs `scene` in the number type `scalar`, paced in real time if `paced`, and writes
/// `ticks.csv`, with its `rows`, and the figures into `folder`, which is made if it is missing. `stop` ends the run
/// early; what was computed until then is written.
///
/// # Errors
/// Refused: the number type, or a machine that the scene's reader would have refused. Failed:
/// something cannot be written.
pub fn simulate(
    scene: &Scene,
    scalar: NumberType,
    paced: bool,
    rows: TickRows,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<RunReport, CliError> {
    let results = ResultFolder::for_command(folder, "run")?;
    simulate_into(scene, scalar, paced, rows, results, stop).map(|(report, _)| report)
}

/// Runs as [`simulate`] into `results`, and returns them for those of others.
fn simulate_into(
    scene: &Scene,
    scalar: NumberType,
    paced: bool,
    rows: TickRows,
    results: ResultFolder,
    stop: &AtomicBool,
) -> Result<(RunReport, ResultFolder), CliError> {
    in_number_type!(scalar, N => {
        let played = PlayedScene::<N>::new(scene, scalar)?;
        simulate_in(&played, paced, rows, results, stop)
    })
}
