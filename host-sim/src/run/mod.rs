//! Runs a scene: its job tick by tick, in real time or as fast as it goes.

mod histogram;
mod pace;
mod plant;
mod progress;
mod summary;

pub use histogram::Histogram;
pub use pace::Deadlines;
pub use plant::{Simulated, simulate_plant};

use crate::cli::RunArgs;
use crate::evaluator;
use crate::failure::Failure;
use crate::record::Record;
use crate::recording::{Peaks, Recorded, Recorder};
use crate::scalar::Scalar;
use pace::Pacer;
use progress::Progress;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use trirrr_core::number::{Coarse, Fixed, Number};
use trirrr_core::status::Status;
use trirrr_scene::{JobPlayer, Scene};

/// Records that may wait for the recorder before a tick has to.
const WAITING: usize = 16_384;

/// How a run came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The whole job was run.
    Complete,
    /// It was stopped from outside.
    Stopped,
    /// The setpoint of this tick has no motion.
    Status {
        /// The tick, counted from 0.
        tick: u64,
        /// Why.
        status: Status,
    },
}

/// What a run gives, besides what it writes.
#[derive(Clone, Debug)]
pub struct Report {
    /// How it ended.
    pub end: End,
    /// Setpoints that have a record, from the first on.
    pub records: u64,
    /// Setpoints of the whole job.
    pub setpoints: u64,
    /// How long it took.
    pub elapsed: Duration,
    /// How long the computation of a tick took.
    pub computation: Histogram,
    /// How the deadlines were kept, in real time.
    pub deadlines: Option<Deadlines>,
    /// The extremes of the motion; none without a record.
    pub peaks: Option<Peaks>,
    /// The number type it was computed in.
    pub scalar: Scalar,
    /// What was written.
    pub files: Vec<PathBuf>,
}

/// `host-sim run`: reads the scene, runs it, prints the summary. `stop` ends it early.
///
/// Returns how the run ended.
///
/// # Errors
/// Refused: the scene, or its number type. Failed: something cannot be written.
pub fn command(args: &RunArgs, stop: &AtomicBool) -> Result<End, Failure> {
    let scene = Scene::read(&args.scene).map_err(|error| {
        // Every line names the file already.
        Failure::Refused(error.to_string())
    })?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&scene.name),
    };
    let scalar = args.scalar.unwrap_or_else(|| scene.number.into());
    let report = simulate(&scene, scalar, !args.fast, &folder, stop)?;
    match summary::print(&mut io::stdout().lock(), &args.scene, &scene, &report) {
        // Who closes standard output early does not want the summary.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            return Err(Failure::Failed(format!("standard output: {error}")));
        }
        _ => {}
    }
    if scene.plant.is_none() || report.end != End::Complete {
        return Ok(report.end);
    }
    let simulated = simulate_plant(&scene, scalar, &folder, stop)?;
    match plant::print(&mut io::stdout().lock(), &simulated) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            return Err(Failure::Failed(format!("standard output: {error}")));
        }
        _ => {}
    }
    match simulated.outcome.end {
        crate::plant::simulate::End::Complete => Ok(report.end),
        crate::plant::simulate::End::Interrupted { .. } => Ok(End::Stopped),
        crate::plant::simulate::End::Ended(ending) => {
            Err(Failure::Failed(format!("the plant {ending}")))
        }
        crate::plant::simulate::End::Failed(reason) => {
            Err(Failure::Failed(format!("the plant: {reason}")))
        }
    }
}

/// Runs `scene` in the number type `scalar`, paced in real time if `paced`, and writes
/// `ticks.csv` and the figures into `folder`, which is made if it is missing. `stop` ends the run
/// early; what was computed until then is written.
///
/// # Errors
/// Refused: the number type, or a machine that the scene's reader would have refused. Failed:
/// something cannot be written.
pub fn simulate(
    scene: &Scene,
    scalar: Scalar,
    paced: bool,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<Report, Failure> {
    match scalar {
        Scalar::F64 => simulate_in::<f64>(scene, scalar, paced, folder, stop),
        Scalar::F32 => simulate_in::<f32>(scene, scalar, paced, folder, stop),
        Scalar::Fixed => simulate_in::<Fixed>(scene, scalar, paced, folder, stop),
        Scalar::Micromath => simulate_in::<Coarse>(scene, scalar, paced, folder, stop),
    }
}

fn simulate_in<N: Number>(
    scene: &Scene,
    scalar: Scalar,
    paced: bool,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<Report, Failure> {
    let evaluator::Played {
        machine, player, ..
    } = evaluator::scene::<N>(scene)
        .map_err(|error| Failure::Refused(format!("scene {}: {error}", scene.name)))?;
    let setpoints = u64::from(scene.ticks()) + 1;
    let job = Job {
        player,
        evaluator: &*machine,
        rate_hz: scene.tick_rate_hz,
    };

    let recorder = Recorder::create(folder, setpoints)?;
    let expected = paced.then(|| Duration::from_secs_f64(setpoints as f64 / scene.tick_rate_hz));
    let progress = Progress::new(setpoints, expected);

    let (sender, receiver) = sync_channel(WAITING);
    let (played, recorded) = std::thread::scope(|scope| {
        let recording = scope.spawn(move || record_all(recorder, &receiver, progress));
        let played = job.play(paced, stop, sender);
        // A panic there is a bug and goes on here.
        (
            played,
            recording
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        )
    });
    let is_complete = played.end == End::Complete;
    let Recorded { rows, peaks, files } = recorded?.finish(&scene.name, is_complete)?;
    Ok(Report {
        end: played.end,
        records: rows,
        setpoints,
        elapsed: played.elapsed,
        computation: played.computation,
        deadlines: played.deadlines,
        peaks,
        scalar,
        files,
    })
}

/// Takes every record until the sender is gone. It has a thread of its own, so that a slow disk does
/// not delay a tick. After an error no more are taken, which the sender notices.
fn record_all(
    mut recorder: Recorder,
    records: &Receiver<Record>,
    mut progress: Progress,
) -> Result<Recorder, Failure> {
    for record in records {
        recorder.record(&record)?;
        progress.update(recorder.rows(), record.t);
    }
    progress.finish();
    Ok(recorder)
}

/// A job ready to be played.
struct Job<'a, N: Number> {
    player: JobPlayer<N>,
    evaluator: &'a dyn evaluator::Evaluator<N>,
    rate_hz: f64,
}

/// What playing a job gives, besides the records.
struct Played {
    end: End,
    elapsed: Duration,
    computation: Histogram,
    deadlines: Option<Deadlines>,
}

impl<N: Number> Job<'_, N> {
    /// Sends the record of every tick, each when it is due if `paced`.
    fn play(&self, paced: bool, stop: &AtomicBool, records: SyncSender<Record>) -> Played {
        let start = Instant::now();
        let mut computation = Histogram::default();
        let mut pacer = paced.then(|| Pacer::start(self.rate_hz));
        let mut end = End::Complete;
        for tick in 0..=self.player.ticks() {
            let number = u64::from(tick);
            let go_on = match &mut pacer {
                Some(pacer) => pacer.wait(number, stop),
                None => !stop.load(Ordering::Relaxed),
            };
            if !go_on {
                end = End::Stopped;
                break;
            }
            let t = f64::from(tick) / self.rate_hz;
            let begin = Instant::now();
            let result = self.evaluator.evaluate(t, &self.player.at(tick));
            computation.push(begin.elapsed());
            if let Some(pacer) = &mut pacer {
                pacer.done(number);
            }
            match result {
                // The recorder has gone: it says why when it is joined.
                Ok(record) if records.send(record).is_err() => break,
                Ok(_) => {}
                Err(status) => {
                    end = End::Status {
                        tick: number,
                        status,
                    };
                    break;
                }
            }
        }
        let deadlines = pacer.map(Pacer::finish);
        Played {
            end,
            elapsed: start.elapsed(),
            computation,
            deadlines,
        }
    }
}
