//! Plays a job tick by tick, in real time or as fast as the computer can.

use super::plant::PlantRecorder;
use super::report::{JobEnd, RunResult};
use crate::failure::CliError;
use crate::histogram::Histogram;
use crate::realtime::Pacer;
use crate::supply::{SuppliedChunk, next_chunk};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};
use trirrr_client::JobFailure;
use trirrr_client::runner::{JobPart, JobRunner, PlayedTick};
use trirrr_drives::ObeyingDrives;
use trirrr_protocol::message::State;
use trirrr_service::board::Readings;
use trirrr_service::{Output, ServiceNumber};

/// Machine whose service hears the drives of the plant, in one thread with it.
pub(super) struct ClosedLoop<'p, 'l, N: ServiceNumber> {
    plant: &'p mut PlantRecorder<'l, N>,
    /// Drives until the job begins: the plant stands in its brakes.
    drives: ObeyingDrives<N>,
}

impl<'p, 'l, N: ServiceNumber> ClosedLoop<'p, 'l, N> {
    /// Joins `plant` to a machine whose motors stand at `angles`.
    pub(super) fn new(plant: &'p mut PlantRecorder<'l, N>, angles: [N::Angle; 3]) -> Self {
        Self {
            plant,
            drives: ObeyingDrives::new(angles),
        }
    }

    /// Returns the readings of the drives before a tick.
    fn measure(&mut self, part: JobPart) -> Readings<N> {
        let of_plant = match part {
            JobPart::Before => None,
            JobPart::Path | JobPart::After => self.plant.measure(),
        };
        of_plant.unwrap_or_else(|| self.drives.measure())
    }

    fn follow(&mut self, part: JobPart, output: &Output<N>) {
        self.drives.apply(output);
        if part != JobPart::Before {
            self.plant.follow(output);
        }
    }
}

/// Result of a tick, and the readings of the drives before it.
pub(super) type SentTick<N> = (PlayedTick<N>, Option<Readings<N>>);

/// Chunks of a long job, which another thread reads: no tick waits for a disk.
pub(super) type Chunks<N> = Receiver<Result<SuppliedChunk<N>, CliError>>;

/// Plays the job of `runner` and sends each tick, from the first of the path on. With a `rate_hz`,
/// each tick of the path waits until it is due. In a closed loop the plant follows each tick at once. The moves of a long job
/// come in `chunks`.
pub(super) fn play<N: ServiceNumber>(
    mut runner: JobRunner<'_, N>,
    mut closed: Option<ClosedLoop<'_, '_, N>>,
    chunks: Option<&Chunks<N>>,
    rate_hz: Option<f64>,
    stop: &AtomicBool,
    ticks: &SyncSender<SentTick<N>>,
) -> RunResult {
    let mut computation = Histogram::default();
    let mut start = None;
    let mut pacer = None;
    let mut tick = 0;
    let mut end = None;
    let end = loop {
        if end.is_none() {
            if let Some(Err(error)) = chunks.map(|chunks| supply(&mut runner, chunks)) {
                break JobEnd::Fault(error.to_string());
            }
            end = runner.talk().map(|result| ended(&runner, result));
        }
        // After a fault the machine still comes to rest.
        match end {
            Some(end) if closed.is_none() || runner.state() != State::Reacting => break end,
            _ => {}
        }
        if stop.load(Ordering::Relaxed) {
            break JobEnd::Stopped;
        }
        let part = runner.part();
        let readings = closed.as_mut().map(|closed| closed.measure(part));
        if let Some(readings) = readings {
            runner.hear(readings);
        }
        if part == JobPart::Path {
            start.get_or_insert_with(Instant::now);
            if let Some(rate_hz) = rate_hz
                && !pacer
                    .get_or_insert_with(|| Pacer::start(rate_hz))
                    .wait(tick, stop)
            {
                break JobEnd::Stopped;
            }
            computation.push(runner.tick());
            if let Some(pacer) = &mut pacer {
                pacer.done(tick);
            }
            tick += 1;
        } else {
            // Before and after the path nothing is due, and nothing is measured.
            runner.tick();
        }
        if let Some(closed) = &mut closed {
            closed.follow(part, runner.output());
        }
        if let Some(played) = runner.collect()
            && ticks.send((played, readings)).is_err()
        {
            // The recorder has gone: it says why when it is joined.
            break JobEnd::Stopped;
        }
    };
    RunResult {
        end,
        elapsed: start.map_or(Duration::ZERO, |start| start.elapsed()),
        computation,
        deadlines: rate_hz.map(|_| pacer.map(Pacer::finish).unwrap_or_default()),
    }
}

/// Supplies the moves that are wanted.
fn supply<N: ServiceNumber>(
    runner: &mut JobRunner<'_, N>,
    chunks: &Chunks<N>,
) -> Result<(), CliError> {
    while runner.wants().is_some() {
        let SuppliedChunk { first, moves, .. } = next_chunk(chunks)?;
        runner.supply(first, moves);
    }
    Ok(())
}

fn ended<N: ServiceNumber>(runner: &JobRunner<'_, N>, result: Result<(), JobFailure<N>>) -> JobEnd {
    let Err(failure) = result else {
        return JobEnd::Complete;
    };
    let why = runner.describe(&failure);
    match failure {
        JobFailure::Refused { .. } | JobFailure::Inadmissible { .. } => JobEnd::Refused(why),
        _ => JobEnd::Fault(why),
    }
}
