//! From angles to whole microsteps.
//!
//! Whole numbers keep the sum exact: the position after a tick is the rounded angle of that tick, and no
//! rounding is left over from the ticks before.

use crate::count::Countable;
use crate::winding::Winding;
use core::fmt;

/// Microsteps per turn of a joint. Behind a gear the number need not be whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepsPerTurn {
    whole: u32,
    /// Fraction, in 2^-32.
    part: u32,
}

impl StepsPerTurn {
    /// Largest number of microsteps per turn.
    pub const MAX: f64 = 2_147_483_647.0;

    /// `per_turn` microsteps per turn of the rotor, and `gear_ratio` turns of the rotor per turn of the joint,
    /// positive. A product above [`Self::MAX`] is cut to that.
    pub const fn new(per_turn: u32, gear_ratio: f64) -> Self {
        let steps = per_turn as f64 * gear_ratio;
        let steps = if steps < Self::MAX { steps } else { Self::MAX };
        let whole = steps as u32;
        Self {
            whole,
            part: ((steps - whole as f64) * 4_294_967_296.0) as u32,
        }
    }

    /// Microsteps from the angle 0, in 2^-32 of one, modulo 2^64.
    #[inline(always)]
    fn times(self, winding: Winding) -> i64 {
        let per_turn = u64::from(self.whole) << 32 | u64::from(self.part);
        let turns = i64::from(winding.whole).wrapping_mul(per_turn as i64);
        let within = u64::from(winding.part) * u64::from(self.whole);
        let rest = (u64::from(winding.part) * u64::from(self.part)) >> 32;
        turns.wrapping_add(within.wrapping_add(rest) as i64)
    }
}

/// Stepper behind a gear, with its position in microsteps from the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepMotor<N: Countable> {
    per_turn: StepsPerTurn,
    /// Most microsteps in a tick.
    most_per_tick: u32,
    /// Last commanded joint angle,
    angle: N::Angle,
    /// with its turns.
    winding: Winding,
    /// [`StepsPerTurn::times`] at position 0.
    origin: i64,
    /// Microsteps from the start.
    position: i32,
}

/// Refusal of more microsteps than the driver takes in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManySteps {
    /// Microsteps asked for, of either sign.
    pub steps: i32,
    /// Most microsteps of either sign.
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
    /// Motor at joint angle `angle`, whose driver takes up to `most_per_tick` microsteps in a tick.
    pub fn new(per_turn: StepsPerTurn, most_per_tick: u32, angle: N::Angle) -> Self {
        let winding = Winding::at::<N>(angle);
        Self {
            per_turn,
            most_per_tick,
            angle,
            winding,
            origin: per_turn.times(winding),
            position: 0,
        }
    }

    /// Microsteps from the start, modulo 2^32.
    #[inline(always)]
    pub fn position(&self) -> i32 {
        self.position
    }

    /// Joint angle that the motor was last moved to.
    pub fn angle(&self) -> N::Angle {
        self.angle
    }

    /// Sets the joint angle of a motor that stands elsewhere than counted. No step is taken.
    pub fn set_angle(&mut self, angle: N::Angle) {
        self.angle = angle;
        self.winding = Winding::at::<N>(angle);
        let position = i64::from(self.position) << 32;
        self.origin = self.per_turn.times(self.winding).wrapping_sub(position);
    }

    /// Moves the motor to `angle`, the short way round, to the nearest microstep. Returns the microsteps.
    ///
    /// # Errors
    /// [`TooManySteps`]; the motor stays where it is.
    #[inline]
    pub fn move_to(&mut self, angle: N::Angle) -> Result<i32, TooManySteps> {
        let winding = self.winding.after::<N>(angle);
        let exact = self.per_turn.times(winding).wrapping_sub(self.origin);
        let position = (exact.wrapping_add(1 << 31) >> 32) as i32;
        let steps = position.wrapping_sub(self.position);
        if steps.unsigned_abs() > self.most_per_tick {
            return Err(TooManySteps {
                steps,
                most: self.most_per_tick,
            });
        }
        self.angle = angle;
        self.winding = winding;
        self.position = position;
        Ok(steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::number::Fixed;

    #[test]
    fn the_sum_of_the_steps_is_the_rounded_angle() {
        // Over many turns and back, in steps that no microstep divides, behind a gear that gives
        // no whole number of microsteps per turn, in all number types alike.
        fn check<N: Countable>(tolerance: f64) {
            let gear = 10.37;
            let per_radian = 3200.0 * gear / core::f64::consts::TAU;
            let start = 0.7;
            let mut motor = StepMotor::<N>::new(
                StepsPerTurn::new(3200, gear),
                10_000,
                N::angle_from_f64(start),
            );
            let (mut unwrapped, mut sum) = (start, 0_i64);
            let mut clear = 0;
            for tick in 0..20_000 {
                unwrapped += 0.37 * f64::sin(f64::from(tick) * 1e-3) + 0.05;
                let angle = f64::sin(unwrapped).atan2(f64::cos(unwrapped));
                sum += i64::from(motor.move_to(N::angle_from_f64(angle)).unwrap());
                let exact = (unwrapped - start) * per_radian;
                assert!((sum as f64 - exact).abs() <= 0.5 + tolerance, "{tick}");
                // Unless it lies on the edge between two steps it is the rounded angle itself.
                if ((exact - exact.floor()) - 0.5).abs() > tolerance {
                    assert_eq!(sum as f64, exact.round(), "{tick}");
                    clear += 1;
                }
                assert_eq!(sum, i64::from(motor.position()));
            }
            assert!(clear > 19_000);
        }
        // No error adds up: a turn is 33,184 steps, so an angle that is off by a turn's 2^-32 is
        // off by 8e-6 of a step. `unwrapped` itself is a sum of 20,000 values of up to 5e3 rad, off by
        // 1e-8 rad, 5e-5 of a step. An f32 angle is off by 2^-23 rad, and twice that in turns: 2e-3.
        check::<f64>(1e-4);
        check::<Fixed>(1e-4);
        check::<f32>(4e-3);
    }

    #[test]
    fn a_year_of_ticks_leaves_nothing_over() {
        // The same angles again and again: the position comes back to where it was, in the bits.
        let mut motor = StepMotor::<f32>::new(StepsPerTurn::new(3200, 7.3), 10_000, 0.1);
        let angles = [0.3, 1.9, 2.8, -2.7, -1.3, -0.2, 0.1];
        for angle in angles {
            motor.move_to(angle).unwrap();
        }
        let turn = motor.position();
        assert_eq!(turn, 23_360);
        for round in 2..1000 {
            for angle in angles {
                motor.move_to(angle).unwrap();
            }
            assert_eq!(motor.position(), 23_360 * round);
        }
    }

    #[test]
    fn a_motor_found_elsewhere_takes_no_step() {
        let mut motor = StepMotor::<f64>::new(StepsPerTurn::new(200, 1.0), 100, 0.0);
        assert_eq!(motor.move_to(0.5), Ok(16)); // 15.9
        motor.set_angle(-2.0);
        assert_eq!((motor.position(), motor.angle()), (16, -2.0));
        assert_eq!(motor.move_to(-2.0), Ok(0));
        // 31.8 microsteps from there.
        assert_eq!(motor.move_to(-1.0), Ok(32));
        assert_eq!(motor.position(), 48);
    }

    #[test]
    fn too_fast_is_refused_and_leaves_the_motor_where_it_is() {
        let mut motor = StepMotor::<f64>::new(StepsPerTurn::new(200, 1.0), 10, 0.0);
        let refused = motor.move_to(1.0);
        assert_eq!(
            refused,
            Err(TooManySteps {
                steps: 32,
                most: 10
            })
        );
        assert_eq!((motor.position(), motor.angle()), (0, 0.0));
        assert_eq!(motor.move_to(-0.3), Ok(-10));
    }
}
