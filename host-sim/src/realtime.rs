//! Real time. Each tick has an absolute deadline, so that no delay adds up.

use crate::histogram::Histogram;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Last part of a wait, spent in a loop: the system wakes a thread up to this late, sometimes later.
const SPIN: Duration = Duration::from_micros(300);
/// Longest sleep, so that a stop is noticed.
const NAP: Duration = Duration::from_millis(50);

/// Statistics of the deadlines.
#[derive(Clone, Debug, Default)]
pub struct Deadlines {
    /// Time from each deadline to the begin of the tick.
    pub release: Histogram,
    /// Ticks whose result came after the next deadline.
    pub late: u64,
}

/// Paces ticks in real time.
pub(crate) struct Pacer {
    start: Instant,
    rate_hz: f64,
    deadlines: Deadlines,
}

impl Pacer {
    /// Starts the clock: tick 0 is due now.
    pub(crate) fn start(rate_hz: f64) -> Self {
        Self {
            start: Instant::now(),
            rate_hz,
            deadlines: Deadlines::default(),
        }
    }

    fn due(&self, tick: u64) -> Instant {
        // From the start and never from the tick before: nothing accumulates.
        self.start + Duration::from_secs_f64(tick as f64 / self.rate_hz)
    }

    /// Waits until `tick` is due. Returns false if `stop` was raised before.
    pub(crate) fn wait(&mut self, tick: u64, stop: &AtomicBool) -> bool {
        let due = self.due(tick);
        loop {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            let now = Instant::now();
            match due.checked_duration_since(now) {
                None | Some(Duration::ZERO) => {
                    self.deadlines.release.push(now - due);
                    return true;
                }
                Some(left) if left > SPIN => std::thread::sleep((left - SPIN).min(NAP)),
                Some(_) => std::hint::spin_loop(),
            }
        }
    }

    /// Returns the time until `tick` is due. Zero begins the tick.
    pub(crate) fn left(&mut self, tick: u64) -> Duration {
        let now = Instant::now();
        let left = self.due(tick).saturating_duration_since(now);
        if left.is_zero() {
            self.deadlines.release.push(now - self.due(tick));
        }
        left
    }

    /// Lets the clock stand while the computer is busy elsewhere: a `tick` that is more than `most` late is due now, and those behind it
    /// a period from each other.
    pub(crate) fn stand(&mut self, tick: u64, most: Duration) {
        let late = Instant::now().saturating_duration_since(self.due(tick));
        if late > most {
            self.start += late;
        }
    }

    /// Notes that `tick` has its result. Returns true if it was late.
    pub(crate) fn done(&mut self, tick: u64) -> bool {
        let late = Instant::now() > self.due(tick + 1);
        self.deadlines.late += u64::from(late);
        late
    }

    pub(crate) fn finish(self) -> Deadlines {
        self.deadlines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_tick_begins_before_it_is_due() {
        let stop = AtomicBool::new(false);
        let mut pacer = Pacer::start(1000.0);
        for tick in 0..20 {
            assert!(pacer.wait(tick, &stop));
            assert!(Instant::now() >= pacer.due(tick));
            pacer.done(tick);
        }
        assert_eq!(pacer.finish().release.count(), 20);
    }

    #[test]
    fn a_result_after_the_next_deadline_is_late() {
        let stop = AtomicBool::new(false);
        let mut pacer = Pacer::start(1000.0);
        assert!(pacer.wait(0, &stop));
        std::thread::sleep(Duration::from_millis(3));
        pacer.done(0);
        assert_eq!(pacer.finish().late, 1);
    }

    #[test]
    fn the_clock_stands_while_the_computer_is_busy() {
        let mut pacer = Pacer::start(1000.0);
        std::thread::sleep(Duration::from_millis(30));
        // A little late: all that is missed follows.
        pacer.stand(0, Duration::from_secs(3600));
        assert!(pacer.left(20).is_zero());
        // Too late for that.
        pacer.stand(0, Duration::from_millis(10));
        assert!(pacer.left(0).is_zero());
        assert!(Instant::now() < pacer.due(20_000));
    }

    #[test]
    fn a_stop_ends_a_long_wait() {
        let stop = AtomicBool::new(true);
        let mut pacer = Pacer::start(1e-3);
        assert!(!pacer.wait(1, &stop));
        assert_eq!(pacer.finish().release.count(), 0);
    }
}
