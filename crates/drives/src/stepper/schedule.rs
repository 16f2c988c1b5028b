//! From positions to the slots of a tick.

/// Fraction bits of a position that the tick hands to the slots.
pub(super) const FRACTION_BITS: u32 = 8;

/// A microstep in units of [`Line`](super::Line): 2^-8 of a microstep.
pub const MICROSTEP: i32 = 1 << FRACTION_BITS;

/// Microsteps from `before` to `position`, both rounded to the nearest whole one. Positions have units of [`MICROSTEP`] and may
/// wrap around.
#[inline(always)]
fn whole_between(before: i32, position: i32) -> i32 {
    let whole = |position: i32| position.wrapping_add(MICROSTEP / 2) & -MICROSTEP;
    whole(position).wrapping_sub(whole(before)) >> FRACTION_BITS
}

/// Straight line between the positions of two ticks. A microstep falls where the line crosses the middle between two of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    from: i32,
    to: i32,
    slots: u32,
}

impl Schedule {
    /// From `from` to `to`, in units of [`MICROSTEP`], over `slots` slots, at least one. The positions may wrap around.
    pub const fn new(from: i32, to: i32, slots: u32) -> Self {
        Self {
            from,
            to,
            slots: if slots == 0 { 1 } else { slots },
        }
    }

    /// Microsteps of the whole line.
    pub fn steps(&self) -> i32 {
        whole_between(self.from, self.to)
    }

    /// Microsteps due in the middle of `slot`, counted from 0. The last ones may be due in slot `slots`, the one to spare.
    #[inline]
    pub fn due(&self, slot: u32) -> i32 {
        let travel = i64::from(self.to.wrapping_sub(self.from));
        let double = 2 * i64::from(self.slots);
        let done = (2 * i64::from(slot) + 1).min(double);
        // No more than `travel`, so it fits.
        let line = (travel * done).div_euclid(double) as i32;
        whole_between(self.from, self.from.wrapping_add(line))
    }

    /// The same schedule slot by slot, without a division, for a motor at the microstep nearest to `from`.
    pub fn walk(&self) -> Walk {
        let given = self.from.wrapping_add(MICROSTEP / 2) & -MICROSTEP;
        Walk::new(self.steps(), given, *self)
    }
}

/// [`Schedule`] slot by slot, at most one step in each: further steps come later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    /// Steps that are still to come.
    left: u32,
    /// Parts of a step in a slot.
    each: i32,
    /// Parts of a step.
    step: i32,
    /// Parts of the next step that the line is past, in the middle of the slot before.
    reached: i32,
}

impl Walk {
    /// No step.
    pub(super) const REST: Self = Self {
        left: 0,
        each: 0,
        step: 0,
        reached: 0,
    };

    /// `steps` of a motor that was given the position `given`, along `line`, which runs in their direction.
    #[inline(always)]
    pub(super) fn new(steps: i32, given: i32, line: Schedule) -> Self {
        let (mut travel, mut past) = (
            line.to.wrapping_sub(line.from),
            line.from.wrapping_sub(given),
        );
        if steps < 0 {
            (travel, past) = (travel.wrapping_neg(), past.wrapping_neg());
        }
        let slots = line.slots as i32;
        // Half a step past the motor's position the line crosses the middle to the next one.
        let past = past.wrapping_add(MICROSTEP / 2).wrapping_mul(slots);
        Self {
            left: steps.unsigned_abs(),
            each: travel,
            step: slots.wrapping_mul(MICROSTEP),
            // From the begin of the first slot to the middle of the one before it.
            reached: past.wrapping_sub(travel / 2),
        }
    }

    /// Steps that are still to come.
    #[inline(always)]
    pub fn left(&self) -> u32 {
        self.left
    }

    /// Returns `true` if a step falls into this slot. Call once per slot. If not `may`, a step that is due
    /// falls into a later slot.
    #[inline(always)]
    pub fn step(&mut self, may: bool) -> bool {
        if self.left == 0 {
            return false;
        }
        self.reached = self.reached.saturating_add(self.each);
        if !may || self.reached < self.step {
            return false;
        }
        self.reached -= self.step;
        self.left -= 1;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const LINES: [(i32, i32, u32); 9] = [
        (0, 7 * MICROSTEP, 100),
        (40, 50 * MICROSTEP + 3, 101),
        (100, -13 * MICROSTEP - 90, 29),
        (128, 127, 5),
        (0, 0, 5),
        (120, 136, 1),
        (-128, MICROSTEP, 2),
        (-77, 100 * MICROSTEP, 201),
        // Across the end of the numbers.
        (i32::MAX - 300, i32::MIN + 600, 11),
    ];

    #[test]
    fn steps_fall_where_the_line_crosses_the_middle_between_two() {
        for (from, to, slots) in LINES {
            let schedule = Schedule::new(from, to, slots);
            let travel = f64::from(to.wrapping_sub(from)) / f64::from(MICROSTEP);
            let phase = f64::from(from.wrapping_add(128) & 255) / f64::from(MICROSTEP) - 0.5;
            for slot in 0..=slots {
                let part = ((f64::from(slot) + 0.5) / f64::from(slots)).min(1.0);
                let line = phase + travel * part;
                let off = f64::from(schedule.due(slot)) - line;
                assert!(
                    off.abs() <= 0.5 + 1.0 / 256.0,
                    "{from} to {to}: {slot} {off}"
                );
            }
            assert_eq!(schedule.due(slots), schedule.steps());
        }
    }

    #[test]
    fn a_walk_is_the_schedule_slot_by_slot() {
        for (from, to, slots) in LINES {
            let schedule = Schedule::new(from, to, slots);
            let mut walk = schedule.walk();
            assert_eq!(walk.left(), schedule.steps().unsigned_abs());
            let mut done = 0;
            for slot in 0..=slots {
                done += i32::from(walk.step(true));
                // Backwards the middle itself belongs to the lower one: 2^-8 of a microstep earlier or later.
                let near = [slot.saturating_sub(1), slot, slot + 1];
                let due = near.map(|slot| schedule.due(slot).abs());
                assert!(due[0] <= done && done <= due[2], "{from} to {to}: {slot}");
                if to.wrapping_sub(from) >= 0 {
                    assert_eq!(done, due[1], "{from} to {to}: {slot}");
                }
            }
            assert_eq!(walk.left(), 0);
            assert!(!walk.step(true));
        }
    }

    #[test]
    fn a_step_that_may_not_come_comes_later() {
        let mut walk = Schedule::new(0, 2 * MICROSTEP, 4).walk();
        let may = [true, false, true, true, true];
        let came: Vec<bool> = may.map(|may| walk.step(may)).into();
        assert_eq!(came, [false, false, true, true, false]);
        assert_eq!(walk.left(), 0);
    }

    #[test]
    fn a_line_goes_on_where_the_last_one_ended() {
        // 1.5 microsteps in each tick of 30 slots: a step every 20 slots, whatever tick it falls into.
        let (mut at, mut slot, mut steps) = (10, 0, Vec::new());
        for _ in 0..40 {
            let to = at + 3 * MICROSTEP / 2;
            let mut walk = Schedule::new(at, to, 30).walk();
            for _ in 0..30 {
                if walk.step(true) {
                    steps.push(slot);
                }
                slot += 1;
            }
            assert_eq!(walk.left(), 0);
            at = to;
        }
        assert_eq!(steps.len(), 60);
        assert!(
            steps.windows(2).all(|pair| pair[1] - pair[0] == 20),
            "{steps:?}"
        );
    }
}
