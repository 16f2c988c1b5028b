//! From angles to positions in microsteps, with a fraction.
//!
//! Whole numbers keep the sum exact: the position after a tick is the angle of that tick within [`PLAY`], and no
//! rounding is left over from the ticks before.

use super::schedule::FRACTION_BITS;
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

/// Way that an angle turns back before the position follows, to either side of it: 1/16 of a microstep, in 2^-32 of one. An angle
/// that rests between two microsteps, with its last bits going up and down, steps once and not back and forth.
const PLAY: i64 = 1 << 28;

/// Half a microstep.
const HALF: i64 = 1 << 31;

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
    /// Microsteps from the start in 2^-32 of one, within [`PLAY`] of the angle.
    place: i64,
}

/// Where a motor stands after a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorPlace<N: Countable> {
    angle: N::Angle,
    winding: Winding,
    place: i64,
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
            place: 0,
        }
    }

    /// Microsteps from the start, to the nearest, modulo 2^32.
    #[inline(always)]
    pub fn position(&self) -> i32 {
        whole(self.place)
    }

    /// Position in units of [`MICROSTEP`](super::MICROSTEP), modulo 2^24 microsteps.
    #[inline(always)]
    pub fn place(&self) -> i32 {
        (self.place >> (32 - FRACTION_BITS)) as i32
    }

    /// Joint angle that the motor was last moved to.
    pub fn angle(&self) -> N::Angle {
        self.angle
    }

    /// Sets the joint angle of a motor that stands elsewhere than counted. No step is taken.
    pub fn set_angle(&mut self, angle: N::Angle) {
        self.angle = angle;
        self.winding = Winding::at::<N>(angle);
        self.origin = self.per_turn.times(self.winding).wrapping_sub(self.place);
    }

    /// Moves the motor to `angle`, the short way round. Its position follows within a sixteenth of a microstep. Returns the microsteps.
    ///
    /// # Errors
    /// [`TooManySteps`]; the motor stays where it is.
    #[inline]
    pub fn move_to(&mut self, angle: N::Angle) -> Result<i32, TooManySteps> {
        let winding = self.winding.after::<N>(angle);
        let exact = self.per_turn.times(winding).wrapping_sub(self.origin);
        let way = exact.wrapping_sub(self.place);
        let place = if way > PLAY {
            exact.wrapping_sub(PLAY)
        } else if way < -PLAY {
            exact.wrapping_add(PLAY)
        } else {
            self.place
        };
        let steps = whole(place).wrapping_sub(self.position());
        if steps.unsigned_abs() > self.most_per_tick {
            return Err(TooManySteps {
                steps,
                most: self.most_per_tick,
            });
        }
        self.return_to(MotorPlace {
            angle,
            winding,
            place,
        });
        Ok(steps)
    }

    /// Where the motor stands.
    #[inline(always)]
    pub(super) fn stands(&self) -> MotorPlace<N> {
        MotorPlace {
            angle: self.angle,
            winding: self.winding,
            place: self.place,
        }
    }

    /// Takes the motor to where it [stood](Self::stands), in the bits.
    #[inline(always)]
    pub(super) fn return_to(&mut self, stood: MotorPlace<N>) {
        self.angle = stood.angle;
        self.winding = stood.winding;
        self.place = stood.place;
    }
}

/// Nearest whole microstep.
#[inline(always)]
fn whole(place: i64) -> i32 {
    (place.wrapping_add(HALF) >> 32) as i32
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
                let off = 0.0625 + tolerance;
                assert!((sum as f64 - exact).abs() <= 0.5 + off, "{tick}");
                // Unless it lies on the edge between two steps it is the rounded angle itself.
                if ((exact - exact.floor()) - 0.5).abs() > off {
                    assert_eq!(sum as f64, exact.round(), "{tick}");
                    clear += 1;
                }
                assert_eq!(sum, i64::from(motor.position()));
            }
            assert!(clear > 17_000, "{clear}");
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

    /// Steps in either direction where an angle creeps at `rate` microsteps per tick, and its last bits go up and down by `noise`.
    fn creep<N: Countable>(rate: f64, noise: f64, ticks: u32) -> (i32, i32) {
        let per_radian = 16_000.0 / core::f64::consts::TAU;
        // Just below the edge between two microsteps.
        let mut motor =
            StepMotor::<N>::new(StepsPerTurn::new(3200, 5.0), 10, N::angle_from_f64(0.7));
        let (mut forth, mut back) = (0, 0);
        let mut random = 1_u32;
        for tick in 0..ticks {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let dither = (f64::from(random >> 8) / f64::from(1 << 23) - 1.0) * noise;
            let microsteps = 0.49 + rate * f64::from(tick) + dither;
            let steps = motor.move_to(N::angle_from_f64(0.7 + microsteps / per_radian));
            let steps = steps.expect("slow");
            forth += steps.max(0);
            back -= steps.min(0);
        }
        (forth, back)
    }

    #[test]
    fn a_resting_or_creeping_joint_never_steps_back_and_forth() {
        fn check<N: Countable>() {
            // At rest on the edge: a single step, once.
            let (forth, back) = creep::<N>(0.0, 0.06, 20_000);
            assert!(forth <= 1 && back == 0, "{forth} {back}");
            // Slower than the noise: each edge is crossed once.
            let (forth, back) = creep::<N>(1e-3, 0.06, 20_000);
            assert!((19..=21).contains(&forth) && back == 0, "{forth} {back}");
            let (forth, back) = creep::<N>(-1e-3, 0.06, 20_000);
            assert!((19..=21).contains(&back) && forth == 0, "{forth} {back}");
        }
        check::<f64>();
        check::<f32>();
        check::<Fixed>();
        // The test can fail: beyond the play there are steps both ways.
        let (forth, back) = creep::<f64>(0.0, 0.2, 20_000);
        assert!(forth > 1000 && back > 1000, "{forth} {back}");
    }

    #[test]
    fn the_place_has_the_fraction_that_the_position_rounds() {
        let mut motor = StepMotor::<f64>::new(StepsPerTurn::new(200, 1.0), 100, 0.0);
        let microstep = core::f64::consts::TAU / 200.0;
        assert_eq!(motor.move_to(2.75 * microstep), Ok(3));
        // 2.75 less the play, 704 - 16 units.
        assert!((motor.place() - 688).abs() <= 1, "{}", motor.place());
        assert_eq!(motor.move_to(2.25 * microstep), Ok(-1));
        assert!((motor.place() - 592).abs() <= 1, "{}", motor.place());
    }

    #[test]
    fn a_motor_found_elsewhere_takes_no_step() {
        let mut motor = StepMotor::<f64>::new(StepsPerTurn::new(200, 1.0), 100, 0.0);
        assert_eq!(motor.move_to(0.5), Ok(16)); // 15.9
        motor.set_angle(-2.0);
        assert_eq!((motor.position(), motor.angle()), (16, -2.0));
        assert_eq!(motor.move_to(-2.0), Ok(0));
        // 31.83 microsteps from there, which was 15.85 and not 16.
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
        assert_eq!(motor.move_to(-0.32), Ok(-10)); // -10.2
    }
}
