//! From microsteps to the slots of a tick.

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

    /// The same schedule slot by slot, without a division.
    pub const fn walk(&self) -> Walk {
        Walk {
            left: self.steps.unsigned_abs(),
            each: self.steps.unsigned_abs(),
            slots: self.slots,
            reached: 0,
        }
    }
}

/// [`Schedule`] slot by slot, at most one step in each: further steps come later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    /// Steps that are still to come.
    left: u32,
    each: u32,
    slots: u32,
    /// Parts of a step, `slots` to one.
    reached: u32,
}

impl Walk {
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
}
