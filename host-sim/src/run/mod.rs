//! `trirrr run`: plays the job of a scene on its service, tick by tick, in real time or as fast as the
//! computer can.

mod args;
pub(crate) mod document;
mod plant;
mod play;
mod progress;
mod tolerances;

pub use args::RunArgs;
pub use plant::Simulated;

use crate::failure::CliError;
use crate::figures::JobMarks;
use crate::histogram::Histogram;
use crate::job_file::{self, LongMoves, QueuedJob};
use crate::lagrange::{LagrangeColumns, LagrangeFound};
use crate::realtime::Deadlines;
use crate::recording::{DriveRecorder, MotorLoad, Peaks, Recorded, RecordedDrives, Recorder};
use crate::redundant;
use crate::results::ResultFolder;
use crate::supply::{MoveSupply, WAITING_CHUNKS};
use crate::terminal::{say, show};
use plant::PlantRecorder;
use play::{ClosedLoop, SentTick, play};
use progress::ProgressDisplay;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;
use trirrr_client::JobWork;
use trirrr_client::describe::Units;
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_client::records::{Samples, is_of_a_job};
use trirrr_client::runner::JobRunner;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_protocol::message::DriveSample;
use trirrr_scene::NumberType;
use trirrr_scene::Scene;
use trirrr_scene::in_number_type;
use trirrr_scene::offer;
use trirrr_scene::pipeline;
use trirrr_service::ServiceNumber;

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

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobEnd {
    /// The whole job was played.
    Complete,
    /// The user stopped the run.
    Stopped,
    /// The machine refused the job or one of its moves, for this reason.
    Refused(String),
    /// The machine has this fault.
    Fault(String),
}

impl JobEnd {
    /// Reason why the job is not complete.
    fn reason(&self) -> Option<String> {
        match self {
            JobEnd::Complete => None,
            JobEnd::Stopped => Some(STOPPED.into()),
            JobEnd::Refused(why) | JobEnd::Fault(why) => Some(why.clone()),
        }
    }
}

/// Reason of a run that the user ended.
const STOPPED: &str = "stopped by the user";

/// Result of a run, besides the files.
#[derive(Clone, Debug)]
pub struct RunReport {
    /// End of the run.
    pub end: JobEnd,
    /// Number of setpoints that have a record, from the first on.
    pub records: u64,
    /// Number of setpoints of the whole job.
    pub setpoints: u64,
    /// Duration of the run.
    pub elapsed: Duration,
    /// Durations of the computation of a tick.
    pub computation: Histogram,
    /// Statistics of the deadlines, in real time.
    pub deadlines: Option<Deadlines>,
    /// Extremes of the motion. `None` without a record.
    pub peaks: Option<Peaks>,
    /// Loads of the motors.
    pub loads: [MotorLoad; 3],
    /// Differences from Lagrange's equations, if they were asked for.
    pub lagrange: Option<LagrangeFound>,
    /// Number type of the computation.
    pub scalar: NumberType,
    /// Written files.
    pub files: Vec<PathBuf>,
    /// Records of the drives, if they were simulated and tell something.
    pub drives: Option<RecordedDrives>,
    /// Result of the plant, if the scene has one.
    pub plant: Option<Simulated>,
}

impl RunReport {
    /// Reason why the results are not complete.
    fn reason(&self) -> Option<String> {
        self.end.reason().or_else(|| self.plant.as_ref()?.reason())
    }

    /// Files of the job, of the drives and of the plant.
    fn all_files(&self) -> Vec<PathBuf> {
        let of_drives = self.drives.iter().flat_map(|drives| &drives.files);
        let of_plant = self.plant.iter().flat_map(|plant| &plant.files);
        let own = self.files.iter().chain(of_drives);
        own.chain(of_plant).cloned().collect()
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
    jobs.iter_mut()
        .for_each(|queued| unroll(&mut queued.job.scene));
    refuse_folders(&jobs)?;
    jobs.iter().for_each(|queued| queued.job.warn_of_pauses());
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
        ResultFolder::for_command(folder, "run")?.claim(Recorder::names(job.scene.torque))?;
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
    report.files.extend(results.pictures()?);
    let why = report.reason();
    results.end(why.as_deref().map_or(Ok(()), Err))?;
    let mut document = document::document(file, scene, &report);
    let mut files = report.all_files();
    let mut end = ended(&report);
    if let Some(analysis) = analysis.filter(|_| report.end == JobEnd::Complete) {
        results.end(Err("the tolerances are under way"))?;
        let bounded = tolerances::bound(scene, analysis, &mut results, stop)?;
        files.extend(bounded.files().iter().cloned().chain(results.pictures()?));
        let why = bounded.is_stopped().then(|| STOPPED.into());
        let why = why.or_else(|| report.reason());
        results.end(why.as_deref().map_or(Ok(()), Err))?;
        bounded.add_to(&mut document);
        if bounded.is_stopped() {
            end = Ok(JobEnd::Stopped);
        }
    }
    match &report.plant {
        Some(simulated) => plant::add_to(&mut document, simulated),
        None => {
            document.data("plant", ());
        }
    }
    show(document.files(files), args.json)?;
    end
}

/// End of the job and of its plant.
fn ended(report: &RunReport) -> Result<JobEnd, CliError> {
    let end = report.end.clone();
    let Some(simulated) = report.plant.as_ref().filter(|_| end == JobEnd::Complete) else {
        return Ok(end);
    };
    match (&simulated.outcome.end, simulated.reason()) {
        (trirrr_plant::PlantEnd::Interrupted { .. }, _) => Ok(JobEnd::Stopped),
        (_, Some(reason)) => Err(CliError::Failed(reason)),
        (_, None) => Ok(end),
    }
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
    in_number_type!(scalar, N => simulate_in::<N>(scene, scalar, paced, rows, results, stop))
}

fn simulate_in<N: HostNumber + Countable>(
    scene: &Scene,
    scalar: NumberType,
    paced: bool,
    rows: TickRows,
    mut results: ResultFolder,
    stop: &AtomicBool,
) -> Result<(RunReport, ResultFolder), CliError> {
    let refused = |error: String| CliError::Refused(format!("scene {}: {error}", scene.name));
    let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let pipeline =
        pipeline::of_scene::<N>(scene, units).map_err(|error| refused(error.to_string()))?;
    let supply = scene.job.spool.as_deref().map(MoveSupply::<N>::whole);
    let work = match &supply {
        Some(supply) => supply.work()?,
        None => JobWork::of(offer::moves::<N>(scene, &units), &scene.job.levels),
    };
    let units = Units::of_scene(scene, &units);
    let setpoints = u64::from(scene.ticks()) + 1;
    let line = Line::new();
    let mut plant = match &scene.plant {
        Some(_) => Some(PlantRecorder::create(scene, &line, &mut results)?),
        None => None,
    };
    // The service hears the drives of the plant: both tick in one thread.
    let is_closed = plant.is_some() && scene.feedback.is_some();
    let drives = match is_closed {
        true => DriveRecorder::create(&mut results, scene, units, 1)?,
        false => None,
    };
    let lagrange = rows.lagrange.then(|| LagrangeColumns::of_scene(scene));
    let marks = JobMarks::of(scene);
    let recorder =
        Recorder::create(results, setpoints, scene.torque, marks, lagrange)?.thinned(rows.every);
    let expected = paced.then(|| Duration::from_secs_f64(setpoints as f64 / scene.tick_rate_hz));
    let recording = Recording {
        samples: Samples::new(&*pipeline, units),
        recorder,
        progress: ProgressDisplay::new(setpoints, expected),
        drives,
        plant: plant.take_if(|_| !is_closed),
    };

    let run = |machine: &mut dyn LocalService<N>| {
        let (sender, receiver) = sync_channel(WAITING);
        std::thread::scope(|scope| {
            let recording = scope.spawn(move || recording.record_all(&receiver));
            let angles = machine.motors().each_ref().map(|motor| motor.angle);
            let closed = plant.as_mut().map(|plant| ClosedLoop::new(plant, angles));
            let hello = local::hello::<N>(scene);
            let runner = JobRunner::new(machine, work, hello, scene.tick_rate_hz)
                .with_outputs(&scene.job.outputs);
            let rate_hz = paced.then_some(scene.tick_rate_hz);
            let chunks = supply.as_ref().map(|supply| {
                let (sender, chunks) = sync_channel(WAITING_CHUNKS);
                scope.spawn(move || supply.send_all(&sender));
                chunks
            });
            let played = play(runner, closed, chunks.as_ref(), rate_hz, stop, &sender);
            // The thread that reads ends with its receiver.
            drop(chunks);
            // The recorder ends with the last tick that it is sent.
            drop(sender);
            // A panic there is a bug and goes on here.
            let recorded = recording.join();
            (
                played,
                recorded.unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            )
        })
    };
    let (played, recorded) = match is_closed {
        true => local::with_machine_measured::<N, _>(scene, run),
        false => local::with_machine::<N, _>(scene, run),
    }?;
    let is_complete = played.end == JobEnd::Complete;
    let (recorder, drives, open) = recorded?;
    let plant = plant.or(open);
    let (recorded, mut results) = recorder.finish(&scene.name, is_complete)?;
    let Recorded {
        rows,
        peaks,
        loads,
        lagrange,
        files,
        motors,
    } = recorded;
    let drives = drives.filter(|_| results.has_begun());
    let drives = drives
        .map(|drives| drives.finish(&mut results, &scene.name))
        .transpose()?;
    let plant = plant.filter(|_| results.has_begun());
    let plant = plant.map(|plant| plant.finish(&mut results, &scene.name, motors, stop));
    let plant = plant.transpose()?;
    let report = RunReport {
        end: played.end,
        records: rows,
        setpoints,
        elapsed: played.elapsed,
        computation: played.computation,
        deadlines: played.deadlines,
        peaks,
        loads,
        lagrange,
        scalar,
        files,
        drives,
        plant,
    };
    let why = report.reason();
    results.end(why.as_deref().map_or(Ok(()), Err))?;
    Ok((report, results))
}

/// Consumers of the ticks: the record, and the plant. They have a thread of their own, so that a slow
/// disk does not delay a tick.
struct Recording<'a, N: ServiceNumber> {
    samples: Samples<'a, N>,
    recorder: Recorder,
    progress: ProgressDisplay,
    drives: Option<DriveRecorder<N>>,
    /// Plant that is no part of the loop.
    plant: Option<PlantRecorder<'a, N>>,
}

/// Parts that are left to be ended: records, samples of the drives, plant.
type Recorders<'a, N> = (
    Recorder,
    Option<DriveRecorder<N>>,
    Option<PlantRecorder<'a, N>>,
);

impl<'a, N: ServiceNumber> Recording<'a, N> {
    /// Takes every tick until the sender is gone. After an error the receiver is gone, which the
    /// sender notices.
    fn record_all(mut self, ticks: &Receiver<SentTick<N>>) -> Result<Recorders<'a, N>, CliError> {
        for (tick, readings) in ticks {
            if let Some(plant) = &mut self.plant {
                plant.tick(&tick.sample);
            }
            // After the job only the plant goes on.
            if !is_of_a_job(tick.sample.state) {
                continue;
            }
            let record = self.samples.played(&tick).map_err(|status| {
                let number = tick.sample.tick;
                CliError::Failed(format!("tick {number} of the machine: {status}"))
            })?;
            self.recorder.record(&record)?;
            if let (Some(drives), Some(readings)) = (&mut self.drives, readings) {
                drives.drives(&DriveSample {
                    tick: tick.sample.tick,
                    drives: readings,
                })?;
                drives.command(&tick.sample)?;
            }
            self.progress.update(self.recorder.rows(), record.t);
        }
        self.progress.finish();
        Ok((self.recorder, self.drives, self.plant))
    }
}
