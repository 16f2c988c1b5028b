//! Plays a job tick by tick, in real time or as fast as the computer can.

use super::JobEnd;
use crate::histogram::Histogram;
use crate::realtime::{Deadlines, Pacer};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};
use trirrr_client::JobFailure;
use trirrr_client::runner::{JobPart, JobRunner, PlayedTick};
use trirrr_service::ServiceNumber;

/// Result of a job, besides its ticks.
pub(super) struct RunResult {
    pub(super) end: JobEnd,
    pub(super) elapsed: Duration,
    pub(super) computation: Histogram,
    /// Deadlines met and missed, if the job was paced.
    pub(super) deadlines: Option<Deadlines>,
}

/// Plays the job of `runner` and sends each tick, from the first of the path on. With a `rate_hz`,
/// each tick of the path waits until it is due.
pub(super) fn play<N: ServiceNumber>(
    mut runner: JobRunner<'_, N>,
    rate_hz: Option<f64>,
    stop: &AtomicBool,
    ticks: &SyncSender<PlayedTick<N>>,
) -> RunResult {
    let mut computation = Histogram::default();
    let mut start = None;
    let mut pacer = None;
    let mut tick = 0;
    let end = loop {
        if let Some(result) = runner.talk() {
            break ended(&runner, result);
        }
        if stop.load(Ordering::Relaxed) {
            break JobEnd::Stopped;
        }
        if runner.part() == JobPart::Path {
            start.get_or_insert_with(Instant::now);
            if let Some(rate_hz) = rate_hz
                && !pacer
                    .get_or_insert_with(|| Pacer::start(rate_hz))
                    .wait(tick, stop)
            {
                break JobEnd::Stopped;
            }
            let begin = Instant::now();
            runner.tick();
            computation.push(begin.elapsed());
            if let Some(pacer) = &mut pacer {
                pacer.done(tick);
            }
            tick += 1;
        } else {
            // Before and after the path nothing is due, and nothing is measured.
            runner.tick();
        }
        if let Some(played) = runner.collect()
            && ticks.send(played).is_err()
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
