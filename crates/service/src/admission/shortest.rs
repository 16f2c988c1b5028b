//! The shortest duration at which a move would pass.

use super::Offer;
use super::bounds::{JerkBounds, MotorBounds};
use super::path::Path;
use super::scan::{Scan, Scanned};
use super::taylor::{Float, TaylorModel};
use crate::admission::Enclose;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{CurveKind, Segment};
use trirrr_protocol::message::LeastDuration;

/// Intervals in which the offered move is measured for a first guess: 2^this.
const SURVEY: u32 = 6;

/// Halvings of the range in which the speed that keeps the limits of an interval is looked for.
const SPEED_BITS: u32 = 16;

/// Durations that are tried upwards before the search is given up. The steps double from a 64th:
/// the last is 2^8 times the first guess.
const MOST_UPWARDS: u32 = 15;

/// A search under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<N: Enclose, K: CurveKind> {
    offered: Offer<N, K>,
    segment: Segment<TaylorModel<N>, K>,
    scan: Scan<Float<N>>,
    stage: Stage<Float<N>>,
}

#[derive(Clone, Copy, Debug)]
enum Stage<N> {
    /// Looks for the speed, in parts of the offered move's, that would keep the limits of every
    /// interval.
    Survey {
        speed: N,
        /// As in a trial.
        too_short: u32,
    },
    /// Tries durations by the full check.
    Try(Trial),
}

/// Durations in ticks.
#[derive(Clone, Copy, Debug)]
struct Trial {
    /// The longest that is known to fail, below `passed`.
    failed: u32,
    /// The longest that breaks a limit for certain; 0 if there is none yet.
    too_short: u32,
    /// The shortest that is known to pass.
    passed: Option<u32>,
    /// Under check.
    tried: u32,
    /// From the one tried to the next.
    step: u32,
    /// Number of those that have failed without any that passed.
    upwards: u32,
}

/// Progress of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    NotYet,
    /// The shortest duration; none if none was found.
    Shortest(Option<LeastDuration>),
}

impl<N: Enclose, K: CurveKind> Search<N, K> {
    /// For a move that fails, for certain or not.
    pub(super) fn new(offered: Offer<N, K>, certain: bool) -> Self {
        Self {
            segment: offered.segment(offered.ticks),
            scan: Scan::at_level(SURVEY),
            stage: Stage::Survey {
                speed: <Float<N>>::ONE,
                too_short: if certain { offered.ticks } else { 0 },
            },
            offered,
        }
    }

    /// Measures one interval.
    pub(super) fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Found {
        match &mut self.stage {
            Stage::Survey { speed, too_short } => {
                // What is not certain about reach or singularities is left to the trials.
                let mut motors = [MotorBounds::UNMEASURED; 3];
                let mut jerks = [JerkBounds::UNMEASURED; 3];
                let jerks: &mut [_] = if K::JERK { &mut jerks } else { &mut [] };
                let interval = self.scan.interval();
                let measured = path.measure(&self.segment, interval, &mut None, &mut motors, jerks);
                if measured.is_ok() {
                    let keeps = |speed: Float<N>| {
                        motors.iter().enumerate().all(|(index, motor)| {
                            let least = &path.least;
                            let jerk = jerks.get(index);
                            motor
                                .check::<M, K>(index, jerk, &path.limits, speed, least)
                                .is_ok()
                        })
                    };
                    if !keeps(*speed) {
                        *speed = greatest(*speed, keeps);
                    }
                }
                if !self.scan.advance() {
                    return Found::NotYet;
                }
                let guess = slower(self.offered.ticks, *speed);
                self.stage = Stage::Try(Trial {
                    failed: self.offered.ticks,
                    too_short: *too_short,
                    passed: None,
                    tried: guess,
                    step: (guess / 64).max(1),
                    upwards: 0,
                });
                self.restart(guess)
            }
            Stage::Try(trial) => match self.scan.step(path, &self.segment, None) {
                Scanned::Undecided => Found::NotYet,
                Scanned::Passed => {
                    let next = match self.offered.jump(path, &self.segment) {
                        Ok(()) => trial.after_pass(),
                        Err((breach, _)) => trial.after_failure(breach.certain),
                    };
                    self.go_on(next)
                }
                Scanned::Failed { breach, .. } => {
                    // From rest to rest no duration changes where the path leads.
                    if self.offered.rest_to_rest && !breach.is_of_speed() {
                        return Found::Shortest(None);
                    }
                    let next = trial.after_failure(breach.certain);
                    self.go_on(next)
                }
            },
        }
    }

    fn go_on(&mut self, next: Result<u32, Option<LeastDuration>>) -> Found {
        match next {
            Ok(ticks) => self.restart(ticks),
            Err(shortest) => Found::Shortest(shortest),
        }
    }

    fn restart(&mut self, ticks: u32) -> Found {
        self.segment = self.offered.segment(ticks);
        self.scan = Scan::new::<N>();
        Found::NotYet
    }
}

/// Ticks of a move of `ticks` at `speed`, 0 to 1, at least one more.
pub(super) fn slower<B: Arithmetic>(ticks: u32, speed: B) -> u32 {
    // Doubled until it is slow enough, then halved down: without a conversion of B to integers.
    let slow = |longer: u32| B::ratio(ticks, longer) <= speed;
    let mut longest = ticks.saturating_add(1);
    while !slow(longest) && longest < u32::MAX {
        longest = longest.saturating_mul(2);
    }
    let mut shortest = ticks;
    while longest - shortest > 1 {
        let middle = shortest + (longest - shortest) / 2;
        if slow(middle) {
            longest = middle;
        } else {
            shortest = middle;
        }
    }
    longest
}

impl Trial {
    /// The next to try, or the answer.
    fn after_pass(&mut self) -> Result<u32, Option<LeastDuration>> {
        self.passed = Some(self.tried);
        self.between(self.tried)
    }

    fn after_failure(&mut self, certain: bool) -> Result<u32, Option<LeastDuration>> {
        self.failed = self.tried;
        if certain {
            self.too_short = self.too_short.max(self.tried);
        }
        if let Some(passed) = self.passed {
            // The way down overshot: from here on the range is halved.
            self.step = u32::MAX;
            return self.between(passed);
        }
        self.upwards += 1;
        if self.upwards > MOST_UPWARDS || self.tried == u32::MAX {
            return Err(None);
        }
        self.tried = self.tried.saturating_add(self.step);
        self.step = self.step.saturating_mul(2);
        Ok(self.tried)
    }

    /// Between the longest that fails and the shortest that passes.
    fn between(&mut self, passed: u32) -> Result<u32, Option<LeastDuration>> {
        let range = passed - self.failed;
        if range <= 1 {
            return Err(Some(LeastDuration {
                enough: passed,
                too_short: self.too_short,
            }));
        }
        let step = self.step.min(range / 2);
        self.step = self.step.saturating_mul(2);
        self.tried = passed - step;
        Ok(self.tried)
    }
}

/// The greatest speed up to `fast`, which is too fast, that `keeps` allows, to 2^-16 of `fast` and
/// from below; that small a part if none is.
fn greatest<N: Arithmetic>(fast: N, keeps: impl Fn(N) -> bool) -> N {
    let mut step = fast;
    let mut slow = N::ZERO;
    for _ in 0..SPEED_BITS {
        step *= N::HALF;
        if keeps(slow + step) {
            slow += step;
        }
    }
    if slow > N::ZERO { slow } else { step }
}
