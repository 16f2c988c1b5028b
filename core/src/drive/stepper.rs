//! A stepper on step and direction: from angles to whole microsteps, and where in a tick each of
//! them falls. Whole numbers keep the sum exact: whatever the rounding of an angle, the position
//! after a tick is that angle rounded, and no step is ever lost in the arithmetic.

use crate::number::{Coarse, Number};
use core::fmt;

/// What it takes to count steps in a number type.
pub trait Countable: Number {
    /// The nearest whole number, halves away from zero; the nearest bound where it is too large,
    /// 0 for what is not a number.
    fn nearest(self) -> i32;
}

macro_rules! countable {
    ($($float:ident),*) => {$(
        impl Countable for $float {
            #[inline(always)]
            fn nearest(self) -> i32 {
                // The cast cuts towards zero and saturates.
                let cut = self as i32;
                let rest = self - cut as $float;
                if rest >= 0.5 {
                    cut.saturating_add(1)
                } else if rest <= -0.5 {
                    cut.saturating_sub(1)
                } else {
                    cut
                }
            }
        }
    )*};
}
countable!(f32, f64);

impl Countable for Coarse {
    #[inline(always)]
    fn nearest(self) -> i32 {
        self.0.nearest()
    }
}

/// A stepper behind a gear, its position counted in microsteps from where it was switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepMotor<N: Number> {
    /// Microsteps per radian of the joint.
    per_radian: N,
    pi: N,
    /// Largest number of microsteps in a tick.
    most_per_tick: u32,
    /// The joint angle that `position` was last rounded from.
    angle: N::Angle,
    /// What rounding has left over, microsteps, -1/2 to 1/2.
    rest: N,
    /// Microsteps from the start.
    position: i32,
}

/// More microsteps than the driver can take in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManySteps {
    /// The microsteps asked for, of either sign.
    pub steps: i32,
    /// The most of either sign.
    pub most: u32,
}

impl fmt::Display for TooManySteps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} microsteps in a tick, at most {} are possible",
            self.steps, self.most
        )
    }
}

impl core::error::Error for TooManySteps {}

impl<N: Countable> StepMotor<N> {
    /// A motor of `per_turn` microsteps per turn of the rotor behind a gear of `gear_ratio`, that
    /// stands at joint angle `angle`, and whose driver takes `most_per_tick` microsteps in a tick.
    pub fn new(per_turn: u32, gear_ratio: f64, most_per_tick: u32, angle: N::Angle) -> Self {
        Self {
            per_radian: N::from_f64(f64::from(per_turn) * gear_ratio / core::f64::consts::TAU),
            pi: N::from_f64(core::f64::consts::PI),
            most_per_tick,
            angle,
            rest: N::ZERO,
            position: 0,
        }
    }

    /// Microsteps from the start.
    pub fn position(&self) -> i32 {
        self.position
    }

    /// The microsteps that bring the motor to `angle`, the short way round, within half a
    /// microstep.
    ///
    /// # Errors
    /// [`TooManySteps`]; the motor stays where it is.
    #[inline]
    pub fn move_to(&mut self, angle: N::Angle) -> Result<i32, TooManySteps> {
        let mut turned = N::radians(angle - self.angle);
        if turned > self.pi {
            turned = turned - self.pi - self.pi;
        } else if turned < -self.pi {
            turned = turned + self.pi + self.pi;
        }
        let wanted = turned * self.per_radian + self.rest;
        let steps = wanted.nearest();
        if steps.unsigned_abs() > self.most_per_tick {
            return Err(TooManySteps {
                steps,
                most: self.most_per_tick,
            });
        }
        self.angle = angle;
        let taken = N::ratio(steps.unsigned_abs(), 1);
        self.rest = if steps < 0 {
            wanted + taken
        } else {
            wanted - taken
        };
        self.position = self.position.wrapping_add(steps);
        Ok(steps)
    }
}

/// Microsteps spread evenly over the slots of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    steps: i32,
    slots: u32,
}

impl Schedule {
    /// `steps` over `slots` slots, at least one.
    pub fn new(steps: i32, slots: u32) -> Self {
        Self {
            steps,
            slots: slots.max(1),
        }
    }

    /// Microsteps due by the end of `slot`, counted from 0: `steps` by the end of the last.
    #[inline]
    pub fn due(&self, slot: u32) -> i32 {
        let done = i64::from(slot.saturating_add(1).min(self.slots));
        // No more than `steps`, so it fits.
        (i64::from(self.steps) * done / i64::from(self.slots)) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn the_sum_of_the_steps_is_the_rounded_angle() {
        // Over many turns and back in steps that no microstep divides, in both number types.
        fn check<N: Countable<Angle = N>>(tolerance: f64) {
            let mut motor = StepMotor::<N>::new(3200, 10.0, 10_000, N::ZERO);
            let (mut unwrapped, mut sum) = (0.0_f64, 0_i64);
            for tick in 0..20_000 {
                unwrapped += 0.37 * f64::sin(f64::from(tick) * 1e-3) + 0.05;
                let angle = f64::sin(unwrapped).atan2(f64::cos(unwrapped));
                sum += i64::from(motor.move_to(N::from_f64(angle)).unwrap());
                let exact = unwrapped * 32_000.0 / core::f64::consts::TAU;
                assert!((sum as f64 - exact).abs() <= 0.5 + tolerance, "{tick}");
                assert_eq!(sum, i64::from(motor.position()));
            }
        }
        // Rounding adds up over 20,000 sums: 2e4 * 2^-53 * 1e4 steps; in f32 an angle within a
        // turn is 5e3 * 2^-24 * pi steps off, each time.
        check::<f64>(1e-6);
        check::<f32>(20_000.0 * 5e3 * 3.2 / 16_777_216.0);
    }

    #[test]
    fn steps_are_spread_evenly_and_all_of_them() {
        for (steps, slots) in [(7, 100), (100, 7), (-13, 10), (0, 5), (5, 1), (i32::MIN, 3)] {
            let schedule = Schedule::new(steps, slots);
            let due: Vec<i64> = (0..slots).map(|slot| schedule.due(slot).into()).collect();
            assert_eq!(*due.last().unwrap(), i64::from(steps));
            let even = i64::from(steps) / i64::from(slots);
            let mut before = 0;
            for now in due {
                let delta = now - before;
                assert!((delta - even).abs() <= 1, "{steps} over {slots}: {delta}");
                before = now;
            }
        }
    }

    #[test]
    fn too_fast_is_refused_and_leaves_the_motor_where_it_is() {
        let mut motor = StepMotor::<f64>::new(200, 1.0, 10, 0.0);
        let refused = motor.move_to(1.0);
        assert_eq!(
            refused,
            Err(TooManySteps {
                steps: 32,
                most: 10
            })
        );
        assert_eq!(motor.position(), 0);
        assert_eq!(motor.move_to(-0.3), Ok(-10));
    }
}
