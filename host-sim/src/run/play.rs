//! Plays a job tick by tick, in real time or as fast as the computer can.

use super::End;
use crate::histogram::Histogram;
use crate::realtime::{Deadlines, Pacer};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};
use trirrr_client::Failure;
use trirrr_client::runner::{JobRunner, Part, PlayedTick};
use trirrr_service::ServiceNumber;

/// Result of a job, besides its ticks.
pub(super) struct RunResult {
    pub(super) end: End,
    pub(super) elapsed: Duration,
    pub(super) computation: Histogram,
    /// How the deadlines were kept, if the job was paced.
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
            break End::Stopped;
        }
        if runner.part() == Part::Path {
            start.get_or_insert_with(Instant::now);
            if let Some(rate_hz) = rate_hz
                && !pacer
                    .get_or_insert_with(|| Pacer::start(rate_hz))
                    .wait(tick, stop)
            {
                break End::Stopped;
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
            break End::Stopped;
        }
    };
    RunResult {
        end,
        elapsed: start.map_or(Duration::ZERO, |start| start.elapsed()),
        computation,
        deadlines: rate_hz.map(|_| pacer.map(Pacer::finish).unwrap_or_default()),
    }
}

fn ended<N: ServiceNumber>(runner: &JobRunner<'_, N>, result: Result<(), Failure<N>>) -> End {
    let Err(failure) = result else {
        return End::Complete;
    };
    let why = runner.describe(&failure);
    match failure {
        Failure::Refused { .. } | Failure::Inadmissible { .. } => End::Refused(why),
        _ => End::Fault(why),
    }
}
