//! A stepper on step and direction: from angles to whole microsteps, and where in a tick each of
//! them falls. Whole numbers keep the sum exact: the position after a tick is the tick's own angle,
//! rounded, and nothing is left over from the ticks before. No step is ever lost in the arithmetic.

use super::count::Countable;
use super::winding::Winding;
use core::fmt;

/// Microsteps per turn of a joint: not whole behind every gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepsPerTurn {
    whole: u32,
    /// The rest, in 2^-32.
    part: u32,
}

impl StepsPerTurn {
    /// The most that can be counted with.
    pub const MAX: f64 = 2_147_483_647.0;

    /// `per_turn` microsteps per turn of the rotor behind a gear of `gear_ratio`, positive. Their
    /// product is taken as checked against [`Self::MAX`]; beyond, it is cut.
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

/// A stepper behind a gear, its position counted in microsteps from where it was switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepMotor<N: Countable> {
    per_turn: StepsPerTurn,
    /// Largest number of microsteps in a tick.
    most_per_tick: u32,
    /// The joint angle that it was commanded last,
    angle: N::Angle,
    /// with its turns.
    winding: Winding,
    /// What [`StepsPerTurn::times`] gives at position 0.
    origin: i64,
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
    /// A motor that stands at joint angle `angle`, and whose driver takes `most_per_tick`
    /// microsteps in a tick.
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

    /// The joint angle that the motor was last moved to.
    pub fn angle(&self) -> N::Angle {
        self.angle
    }

    /// The motor has been found to stand at joint angle `angle`: no step is taken. Its place
    /// between two microsteps is that of the angle.
    pub fn stands_at(&mut self, angle: N::Angle) {
        self.angle = angle;
        self.winding = Winding::at::<N>(angle);
        let position = i64::from(self.position) << 32;
        self.origin = self.per_turn.times(self.winding).wrapping_sub(position);
    }

    /// The microsteps that bring the motor to `angle`, the short way round, within half a
    /// microstep.
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

/// Microsteps spread evenly over the slots of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    steps: i32,
    slots: u32,
}

impl Schedule {
    /// `steps` over `slots` slots, at least one.
    pub const fn new(steps: i32, slots: u32) -> Self {
        Self {
            steps,
            slots: if slots == 0 { 1 } else { slots },
        }
    }

    /// Microsteps due by the end of `slot`, counted from 0: `steps` by the end of the last.
    #[inline]
    pub fn due(&self, slot: u32) -> i32 {
        let done = i64::from(slot.saturating_add(1).min(self.slots));
        // No more than `steps`, so it fits.
        (i64::from(self.steps) * done / i64::from(self.slots)) as i32
    }

    /// The same slot by slot, without a division.
    pub const fn walk(&self) -> Walk {
        Walk {
            left: self.steps.unsigned_abs(),
            each: self.steps.unsigned_abs(),
            slots: self.slots,
            reached: 0,
        }
    }
}

/// A [`Schedule`] slot by slot. No more than one step to a slot: what is more comes later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    /// Steps that have not come yet.
    left: u32,
    each: u32,
    slots: u32,
    /// Parts of a step, `slots` to one.
    reached: u32,
}

impl Walk {
    /// Steps that have not come yet.
    #[inline(always)]
    pub fn left(&self) -> u32 {
        self.left
    }

    /// Whether a step falls into this slot; to be asked once per slot. With `may` not set none
    /// does, and what is due comes in a later one.
    #[inline(always)]
    pub fn step(&mut self, may: bool) -> bool {
        if self.left == 0 {
            return false;
        }
        self.reached = self.reached.saturating_add(self.each);
        if !may || self.reached < self.slots {
            return false;
        }
        self.reached -= self.slots;
        self.left -= 1;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;
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
        motor.stands_at(-2.0);
        assert_eq!((motor.position(), motor.angle()), (16, -2.0));
        assert_eq!(motor.move_to(-2.0), Ok(0));
        // 31.8 microsteps from there.
        assert_eq!(motor.move_to(-1.0), Ok(32));
        assert_eq!(motor.position(), 48);
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
    fn a_walk_is_the_schedule_slot_by_slot() {
        for (steps, slots) in [
            (7, 100),
            (-13, 29),
            (50, 101),
            (0, 5),
            (1, 1),
            (1, 2),
            (100, 100),
        ] {
            let schedule = Schedule::new(steps, slots);
            let mut walk = schedule.walk();
            let mut done = 0;
            for slot in 0..slots {
                done += i32::from(walk.step(true));
                assert_eq!(
                    done,
                    schedule.due(slot).abs(),
                    "{steps} over {slots}: {slot}"
                );
            }
            assert_eq!(walk.left(), 0);
            assert!(!walk.step(true));
        }
    }

    #[test]
    fn a_step_that_may_not_come_comes_later() {
        let mut walk = Schedule::new(2, 4).walk();
        let may = [true, false, true, true, true];
        let came = may.map(|may| walk.step(may));
        assert_eq!(came, [false, false, true, true, false]);
        assert_eq!(walk.left(), 0);
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
