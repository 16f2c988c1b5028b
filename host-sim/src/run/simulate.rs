//! A run of a 3-RRR: its service plays the job, its drives and its plant follow.

use super::plant::PlantRecorder;
use super::play::{ClosedLoop, SentTick, play};
use super::progress::ProgressDisplay;
use super::report::{JobEnd, RunReport, RunResult};
use super::{TickRows, WAITING};
use crate::failure::CliError;
use crate::figures::DrawnJob;
use crate::player::{JobFiles, JobRecorder, PlayedScene, RecordedJob};
use crate::recording::LagrangeColumns;
use crate::results::ResultFolder;
use crate::supply::{MoveSupply, WAITING_CHUNKS};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;
use trirrr_client::JobWork;
use trirrr_client::local::{self, HostNumber, LocalService, Sensed};
use trirrr_client::records::is_of_a_job;
use trirrr_client::runner::JobRunner;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_protocol::message::DriveSample;
use trirrr_scene::offer;
use trirrr_service::ServiceNumber;

/// A job on a machine in this program.
struct HostRun<'s, N: ServiceNumber> {
    scene: &'s PlayedScene<'s, N>,
    work: JobWork<N>,
    /// Moves of a long job.
    supply: Option<MoveSupply<'s, N>>,
    /// Ticks are played at their times.
    is_paced: bool,
    stop: &'s AtomicBool,
}

/// Plays the job of `played`, with the files in `results`; as [`simulate`](super::simulate).
pub(super) fn simulate_in<N: HostNumber + Countable>(
    played: &PlayedScene<'_, N>,
    is_paced: bool,
    rows: TickRows,
    mut results: ResultFolder,
    stop: &AtomicBool,
) -> Result<(RunReport, ResultFolder), CliError> {
    let scene = played.scene;
    let supply = scene.job.spool.as_deref().map(MoveSupply::<N>::whole);
    let work = match &supply {
        Some(supply) => supply.work()?,
        None => JobWork::of(offer::moves::<N>(scene, &played.units), &scene.job.levels),
    };
    let line = Line::new();
    let plant = scene.plant.as_ref();
    let plant = plant.map(|_| PlantRecorder::create(scene, &line, &mut results));
    let mut plant = plant.transpose()?;
    // The service hears the drives of the plant: both tick in one thread.
    let is_closed = plant.is_some() && scene.feedback.is_some();
    let setpoints = u64::from(scene.ticks()) + 1;
    let files = JobFiles {
        records: setpoints,
        every: rows.every,
        drawn: DrawnJob::of(scene),
        lagrange: rows.lagrange.then(|| LagrangeColumns::of_scene(scene)),
        drives_every: is_closed.then_some(1),
    };
    let expected = is_paced.then(|| Duration::from_secs_f64(setpoints as f64 / scene.tick_rate_hz));
    let recording = Recording {
        recorder: JobRecorder::create(played, results, files)?,
        progress: ProgressDisplay::new(setpoints, expected),
        plant: plant.take_if(|_| !is_closed),
    };
    let run = HostRun {
        scene: played,
        work,
        supply,
        is_paced,
        stop,
    };
    let sensed = match is_closed {
        true => Sensed::drives(scene),
        false => Sensed::default(),
    };
    let (job, recorded) = local::with_machine_in(scene, played.units, sensed, |machine| {
        run.play_and_record(machine, plant.as_mut(), recording)
    })?;
    let (recorder, open) = recorded?;
    let recorded = recorder.finish(job.end == JobEnd::Complete)?;
    let RecordedJob {
        job: mut files,
        drives,
        mut results,
    } = recorded;
    let plant = plant.or(open).filter(|_| results.has_begun());
    let motors = std::mem::take(&mut files.motors);
    let plant = plant.map(|plant| plant.finish(&mut results, &scene.name, &motors, stop));
    let report = RunReport {
        played: job,
        setpoints,
        job: files,
        scalar: played.scalar,
        drives,
        plant: plant.transpose()?,
    };
    results.end(report.reason().as_deref())?;
    Ok((report, results))
}

impl<N: HostNumber> HostRun<'_, N> {
    /// Plays the job on `machine`, with a `plant` that its service hears, and records the ticks in a thread of their own.
    fn play_and_record<'a>(
        self,
        machine: &mut dyn LocalService<N>,
        plant: Option<&mut PlantRecorder<'_, N>>,
        recording: Recording<'a, N>,
    ) -> (RunResult, Result<Recorders<'a, N>, CliError>) {
        let scene = self.scene.scene;
        let angles = machine.motors().each_ref().map(|motor| motor.angle);
        let closed = plant.map(|plant| ClosedLoop::new(plant, angles));
        let hello = local::hello::<N>(scene);
        let runner = JobRunner::new(machine, self.work, hello, scene.tick_rate_hz);
        let runner = runner.with_outputs(&scene.job.outputs);
        let rate_hz = self.is_paced.then_some(scene.tick_rate_hz);
        let supply = self.supply;
        let (sender, receiver) = sync_channel(WAITING);
        std::thread::scope(|scope| {
            let recording = scope.spawn(move || recording.record_all(&receiver));
            let chunks = supply.as_ref().map(|supply| {
                let (sender, chunks) = sync_channel(WAITING_CHUNKS);
                scope.spawn(move || supply.send_all(&sender));
                chunks
            });
            let played = play(runner, closed, chunks.as_ref(), rate_hz, self.stop, &sender);
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
    }
}

/// Consumers of the ticks: the record, and the plant. They have a thread of their own, so that a slow
/// disk does not delay a tick.
struct Recording<'a, N: ServiceNumber> {
    recorder: JobRecorder<'a, N>,
    progress: ProgressDisplay,
    /// Plant that is no part of the loop.
    plant: Option<PlantRecorder<'a, N>>,
}

/// Parts that are left to be ended: the record, and the plant that is no part of the loop.
type Recorders<'a, N> = (JobRecorder<'a, N>, Option<PlantRecorder<'a, N>>);

impl<'a, N: ServiceNumber> Recording<'a, N> {
    /// Takes every tick until the sender is gone. After an error the receiver is gone, which the
    /// sender notices.
    fn record_all(mut self, ticks: &Receiver<SentTick<N>>) -> Result<Recorders<'a, N>, CliError> {
        for (tick, readings) in ticks {
            let sample = &tick.sample;
            if let Some(plant) = &mut self.plant {
                plant.tick(sample);
            }
            // After the job only the plant goes on.
            if !is_of_a_job(sample.state) {
                continue;
            }
            let record = self.recorder.samples.played(&tick).map_err(|status| {
                CliError::Failed(format!("tick {} of the machine: {status}", sample.tick))
            })?;
            if let Some(drives) = readings {
                self.recorder.drives(&DriveSample {
                    tick: sample.tick,
                    drives,
                })?;
            }
            self.recorder.write(&record, sample)?;
            self.progress.update(self.recorder.rows(), record.t);
        }
        self.progress.finish();
        Ok((self.recorder, self.plant))
    }
}
