//! Angle of a joint over any number of turns.

use crate::count::Countable;

/// Angle with its whole turns. It follows angles that are known up to a turn, the short way round, and sums
/// whole turns only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Winding {
    /// Whole turns,
    pub(crate) whole: i32,
    /// and the fraction in 2^-32 of a turn.
    pub(crate) part: u32,
}

impl Winding {
    /// At `angle`, within the turn from 0 up.
    pub(crate) fn at<N: Countable>(angle: N::Angle) -> Self {
        Self {
            whole: 0,
            part: N::turn(angle),
        }
    }

    /// At `angle`, within half a turn of 0.
    pub(crate) fn near_zero<N: Countable>(angle: N::Angle) -> Self {
        let part = N::turn(angle);
        Self {
            whole: if part >> 31 == 0 { 0 } else { -1 },
            part,
        }
    }

    /// At `turns`, as precise as binary32.
    pub(crate) fn of_turns(turns: f32) -> Self {
        let half = if turns < 0.0 { -0.5 } else { 0.5 };
        // The cast cuts, and saturates.
        let nearest = (turns + half) as i32;
        // Half a turn of either sign: 2^30 units of 2^-31.
        let part = ((turns - nearest as f32) * 2_147_483_648.0) as i32;
        Self {
            whole: nearest.wrapping_sub(i32::from(part < 0)),
            part: (part as u32) << 1,
        }
    }

    /// Winding `by` 2^-32 of a turn farther.
    pub(crate) fn turned(self, by: i32) -> Self {
        let (part, carried) = self.part.overflowing_add(by as u32);
        // A negative step is a whole turn less than its bits.
        let whole = i32::from(carried) - i32::from(by < 0);
        Self {
            whole: self.whole.wrapping_add(whole),
            part,
        }
    }

    /// Winding after a turn to `angle`, the short way round.
    #[inline(always)]
    #[must_use]
    pub(crate) fn after<N: Countable>(self, angle: N::Angle) -> Self {
        let part = N::turn(angle);
        let forward = (part.wrapping_sub(self.part) as i32) >= 0;
        let crossed = match forward {
            true => i32::from(part < self.part),
            false => -i32::from(part > self.part),
        };
        Self {
            whole: self.whole.wrapping_add(crossed),
            part,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use trirrr_core::number::{Arithmetic, Fixed};

    #[test]
    fn whole_turns_are_counted_both_ways() {
        fn check<N: Countable>() {
            let mut winding = Winding::near_zero::<N>(N::angle_from_f64(-0.5));
            assert_eq!(winding.whole, -1);
            let mut turned = -0.5;
            for step in 0..4000 {
                // Up to nearly half a turn at a time, ten turns forth, then back again.
                turned += if step < 2000 { 0.031 } else { -2.9 };
                let wrapped = f64::sin(turned).atan2(f64::cos(turned));
                winding = winding.after::<N>(N::angle_from_f64(wrapped));
                let found = f64::from(winding.whole) + f64::from(winding.part) / 4_294_967_296.0;
                assert!((found - turned / TAU).abs() < 1e-6, "{step}: {found}");
            }
            assert!(winding.whole < -900);
        }
        check::<f64>();
        check::<f32>();
        check::<Fixed>();
    }

    fn turns_of(winding: Winding) -> f64 {
        f64::from(winding.whole) + f64::from(winding.part) / 4_294_967_296.0
    }

    #[test]
    fn turns_and_steps_add_up() {
        for turns in [0.0_f32, 0.25, -0.25, 0.5, -0.5, 0.75, -3.999, 17.3, -1e-6] {
            let winding = Winding::of_turns(turns);
            assert!(
                (turns_of(winding) - f64::from(turns)).abs() < 1e-9,
                "{turns}"
            );
            for step in [0, 1, -1, i32::MAX, i32::MIN, 1 << 20] {
                let there = turns_of(winding.turned(step));
                let exact = turns_of(winding) + f64::from(step) / 4_294_967_296.0;
                assert!((there - exact).abs() < 1e-12, "{turns} {step}");
            }
        }
    }

    #[test]
    fn standing_still_turns_nothing() {
        for angle in [0.0_f64, 3.1, -3.1] {
            let winding = Winding::at::<f64>(angle);
            assert_eq!(winding.after::<f64>(angle), winding);
        }
        let zero = Winding::at::<f32>(f32::angle_from_f64(0.0));
        assert_eq!((zero.whole, zero.part), (0, 0));
    }
}
