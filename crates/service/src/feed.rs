//! Time along the path: how a hold, a stop and a resume slow it down and speed it up.
//!
//! The path's own time s runs at the speed u = k / R of a tick per tick, where the level k is a
//! whole number, R at normal speed and 0 at rest, and changes by at most one per tick. Between two
//! ticks u is linear in time, so s advances by (k + k') / (2 R) ticks exactly: in parts of 1 / (2 R)
//! of a tick s is a whole number. Nothing is rounded and nothing drifts, and whoever runs at normal
//! speed stands at whole ticks of the path.
//!
//! From normal speed to rest takes R ticks and R^2 parts, which is R / 2 ticks of the path. So does
//! the way back, and both together are R whole ticks. Where a ramp was broken off that does not come
//! out; then the way back spends one tick more at the level d for which it does: d adds 2 d parts,
//! and d = 0 .. R - 1 reaches every remainder, for remainders are even.

/// Position on the path, in the path's own time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PathPosition {
    /// Whole ticks since the start of the move.
    pub(super) tick: u32,
    /// Parts of 1 / (2 R) of a tick, less than 2 R.
    pub(super) part: u32,
}

impl PathPosition {
    /// The start of a move.
    pub(super) const START: Self = Self { tick: 0, part: 0 };
}

/// The speed along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FeedScale {
    /// R, positive.
    ramp: u32,
    /// k.
    level: u32,
    /// Level at which the way up spends one tick more; [`NOWHERE`] if it does not.
    dwell: u32,
}

/// No level.
const NOWHERE: u32 = u32::MAX;

/// One tick of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// k' after it.
    pub(super) level: u32,
    /// k' - k: -1, 0 or 1.
    pub(super) slope: i32,
    /// Parts of a tick that the path advances.
    parts: u32,
}

impl FeedScale {
    /// At rest; `ramp`: R, at most 2^16.
    pub(super) fn new(ramp: u16) -> Self {
        Self {
            ramp: u32::from(ramp).max(1),
            level: 0,
            dwell: NOWHERE,
        }
    }

    /// R.
    pub(super) fn ramp(&self) -> u32 {
        self.ramp
    }

    /// At normal speed from one tick to the next: for the start of a move that starts at rest.
    pub(super) fn start(&mut self) {
        self.level = self.ramp;
        self.dwell = NOWHERE;
    }

    /// At rest from one tick to the next: where a path ends.
    pub(super) fn end(&mut self) {
        self.level = 0;
        self.dwell = NOWHERE;
    }

    /// Returns true if the path stands.
    pub(super) fn is_at_rest(&self) -> bool {
        self.level == 0
    }

    /// One tick towards rest.
    pub(super) fn slower(&self) -> Step {
        self.step_length(self.level.saturating_sub(1))
    }

    /// One tick towards normal speed, or at it.
    pub(super) fn faster(&self) -> Step {
        let next = if self.level == self.dwell {
            self.level
        } else {
            (self.level + 1).min(self.ramp)
        };
        self.step_length(next)
    }

    fn step_length(&self, level: u32) -> Step {
        Step {
            level,
            slope: level as i32 - self.level as i32,
            parts: self.level + level,
        }
    }

    /// Prepares the way from rest to normal speed such that it ends at a whole tick.
    pub(super) fn aim(&mut self, part: u32) {
        // R^2 + 2 d + part = 0 (mod 2 R). The part's parity is that of the levels that were
        // climbed, that of R: d = -(R^2 + part) / 2 (mod R), and R^2 / 2 is R times a whole number,
        // or half an R more where R is odd.
        let odd = self.ramp % 2;
        let half = (part + odd * self.ramp) / 2;
        let over = if half < self.ramp {
            half
        } else {
            half - self.ramp
        };
        self.dwell = if over == 0 { NOWHERE } else { self.ramp - over };
    }

    /// Takes the step: the position after it. `slope` up and down alike.
    pub(super) fn take(&mut self, step: Step, from: PathPosition) -> PathPosition {
        if step.slope == 0 && step.level == self.dwell {
            self.dwell = NOWHERE;
        }
        self.level = step.level;
        let whole = 2 * self.ramp;
        // At most two ramps, one tick.
        let part = from.part + step.parts;
        if part < whole {
            PathPosition { part, ..from }
        } else {
            PathPosition {
                tick: from.tick.wrapping_add(1),
                part: part - whole,
            }
        }
    }

    /// Returns true if the path can still come to rest after `step` within what is left.
    /// What is left before it are `ticks` whole ones less `part`.
    pub(super) fn can_stop(&self, step: Step, ticks: u32, part: u32) -> bool {
        // Beyond a ramp there is no question, and below the product fits.
        if ticks > self.ramp {
            return true;
        }
        let left = u64::from(ticks) * u64::from(2 * self.ramp);
        let level = u64::from(step.level);
        left >= u64::from(part) + u64::from(step.parts) + level * level
    }

    /// Returns true if `ticks` less `part` are enough to come to rest from normal speed.
    pub(super) fn is_enough(&self, ticks: u32, part: u32) -> bool {
        let at_normal_speed = Step {
            level: self.ramp,
            slope: 0,
            parts: 0,
        };
        self.can_stop(at_normal_speed, ticks, part)
    }
}

impl Step {
    /// Returns true if the step is one at normal speed all along.
    pub(super) fn is_normal(&self, feed: &FeedScale) -> bool {
        self.slope == 0 && self.level == feed.ramp
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn walk(feed: &mut FeedScale, position: &mut PathPosition, step: Step) {
        *position = feed.take(step, *position);
    }

    #[test]
    fn a_hold_and_a_resume_take_whole_ticks() {
        for ramp in [1, 2, 3, 7, 10, 100, u16::MAX] {
            let mut feed = FeedScale::new(ramp);
            feed.start();
            let mut position = PathPosition { tick: 5, part: 0 };
            let mut ticks = 0;
            while !feed.is_at_rest() {
                let step = feed.slower();
                walk(&mut feed, &mut position, step);
                ticks += 1;
            }
            assert_eq!(ticks, u32::from(ramp));
            // R^2 parts of 1 / (2 R).
            assert_eq!(
                2 * (position.tick - 5) + position.part / u32::from(ramp),
                u32::from(ramp)
            );
            feed.aim(position.part);
            while feed.level < feed.ramp {
                let step = feed.faster();
                walk(&mut feed, &mut position, step);
            }
            assert_eq!(
                position,
                PathPosition {
                    tick: 5 + u32::from(ramp),
                    part: 0
                }
            );
            let step = feed.faster();
            assert!(step.is_normal(&feed));
            walk(&mut feed, &mut position, step);
            assert_eq!(
                position,
                PathPosition {
                    tick: 6 + u32::from(ramp),
                    part: 0
                }
            );
        }
    }

    proptest! {
        /// However often ramps are broken off, normal speed stands at whole ticks; a path that can
        /// stop before its end does. Down from anywhere, up from rest only, as the service does it.
        #[test]
        fn normal_speed_is_at_whole_ticks(
            ramp in 1u16..40,
            wishes in proptest::collection::vec((any::<bool>(), 1u32..60), 1..30),
            length in 40u32..2000,
        ) {
            let mut feed = FeedScale::new(ramp);
            let mut position = PathPosition::START;
            feed.start();
            let mut down = false;
            for (go, ticks) in wishes {
                for _ in 0..ticks {
                    if feed.is_at_rest() && go {
                        down = false;
                        feed.aim(position.part);
                    }
                    let up = feed.faster();
                    let left = length - position.tick;
                    down = down || !go || !feed.can_stop(up, left, position.part);
                    let step = if down { feed.slower() } else { up };
                    position = feed.take(step, position);
                    prop_assert!(position.part < 2 * u32::from(ramp));
                    let at_the_end = position.tick == length && position.part == 0;
                    prop_assert!(position.tick < length || at_the_end);
                    if step.is_normal(&feed) {
                        prop_assert_eq!(position.part, 0);
                    }
                }
            }
        }
    }
}
