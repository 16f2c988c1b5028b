//! [`Enclose`]: bounds of what a number type rounds.

use super::two_word::TwoWord;
use trirrr_core::number::{Arithmetic, Coarse, Fixed, Number};

/// A number type of the tick whose moves can be admitted: bounds of its values and of its rounding
/// errors are computed in a float.
pub trait Enclose: Number {
    /// The float in which bounds are computed before a move is played: the type itself where its
    /// functions are as accurate as its numbers.
    type Bound: Number;
    /// Holds the middle of an enclosure: `Bound` itself, or a number of more digits.
    type Centre: Centre<Self::Bound>;

    /// Halvings of a move before its first interval is measured. One is the least where the results of the tick
    /// are proven: the tick computes a setpoint from the nearer end of the move.
    const COARSEST: u32 = 1;
    /// True if an interval can be measured in two ways, roughly or precisely.
    const IS_ROUGH_FIRST: bool = false;

    /// The value as a bound, to one [conversion](Self::conversion).
    fn bound(self) -> Self::Bound;
    /// A bound of the distance between a value of this size in [`Bound`](Self::Bound) and the same
    /// value in this type; 0 where the two types are one.
    fn conversion(size: Self::Bound) -> Self::Bound;
    /// A bound of the distance between a coefficient of this size in [`Centre`](Self::Centre) and in this type.
    #[inline(always)]
    fn coefficient(size: Self::Bound) -> Self::Bound {
        Self::conversion(size)
    }
    /// Returns the bound that the results of a tick keep in a motion that keeps `limit`. The same, where the
    /// admission proves the results themselves.
    #[inline(always)]
    fn of_result(limit: Self) -> Self {
        limit
    }
    /// The angle as a bound, to two conversions.
    fn angle_bound(angle: Self::Angle) -> <Self::Bound as Arithmetic>::Angle;
    /// The nearest value to `bound`.
    fn from_bound(bound: Self::Bound) -> Self;
    /// A bound of the rounding error of one operation whose result is of this size, not negative,
    /// in this type as well as in [`Bound`](Self::Bound). Underflow is left out.
    #[inline(always)]
    fn roundoff(size: Self::Bound) -> Self::Bound {
        Self::roundoffs(1, size)
    }
    /// As many [roundoffs](Self::roundoff).
    fn roundoffs(count: u8, size: Self::Bound) -> Self::Bound;
}

/// A number that holds the middle of an enclosure, for bounds in `B`.
pub trait Centre<B>: Number {
    /// `bound`, exactly.
    fn exactly(bound: B) -> Self;
    /// The nearest bound.
    fn nearest(self) -> B;
    /// A bound of what is lost where bounds of `size` are computed from the [nearest](Self::nearest).
    fn lost(size: B) -> B;
    /// The size of what the [nearest](Self::nearest) bound leaves out.
    fn rest(self) -> B;
    /// The size that a [roundoff](Enclose::roundoff) is of, where an operation rounds terms of the total size `total`
    /// in the tick and in the centre, and terms of the size `width` in `B` too.
    fn rounded_size(total: B, width: B) -> B;
    /// `error`, which is not, marked as that of a model whose centre is one bound; `error` itself where every centre is.
    fn marked(error: B) -> B;
    /// The error without its mark.
    fn unmarked(error: B) -> B;
    /// Returns `true` if one of the errors is marked, or no centre has more digits than a bound.
    fn is_one_bound(errors: [B; 2]) -> bool;
}

impl<B: Number> Centre<B> for B {
    #[inline(always)]
    fn exactly(bound: Self) -> Self {
        bound
    }
    #[inline(always)]
    fn nearest(self) -> Self {
        self
    }
    /// Nothing; the rounding of the bounds is among what operations count. -0 is no operation, 0 would be one.
    #[inline(always)]
    fn lost(_: Self) -> Self {
        -B::ZERO
    }
    #[inline(always)]
    fn rest(self) -> Self {
        -B::ZERO
    }
    #[inline(always)]
    fn rounded_size(total: Self, _width: Self) -> Self {
        total
    }
    #[inline(always)]
    fn marked(error: Self) -> Self {
        error
    }
    #[inline(always)]
    fn unmarked(error: Self) -> Self {
        error
    }
    #[inline(always)]
    fn is_one_bound(_: [Self; 2]) -> bool {
        true
    }
}

impl Centre<f32> for TwoWord {
    #[inline(always)]
    fn exactly(bound: f32) -> Self {
        Self::new(bound)
    }
    #[inline(always)]
    fn nearest(self) -> f32 {
        Self::nearest(self)
    }
    /// The word left out, and the rounding of a few sums.
    #[inline(always)]
    fn lost(size: f32) -> f32 {
        size * (8.0 * f32::UNIT_ROUNDOFF)
    }
    #[inline(always)]
    fn rest(self) -> f32 {
        self.low().abs()
    }
    #[inline(always)]
    fn rounded_size(total: f32, width: f32) -> f32 {
        total * TICK_WEIGHT + width
    }
    /// By the sign: an error has none of its own.
    #[inline(always)]
    fn marked(error: f32) -> f32 {
        -error
    }
    #[inline(always)]
    fn unmarked(error: f32) -> f32 {
        error.abs()
    }
    #[inline(always)]
    fn is_one_bound([a, b]: [f32; 2]) -> bool {
        // Of the bits: an error of -0 is marked, too.
        (a.to_bits() | b.to_bits()) >> 31 != 0
    }
}

/// A float in whose own type bounds are computed.
macro_rules! own_bounds {
    () => {
        type Bound = Self;

        #[inline(always)]
        fn bound(self) -> Self {
            self
        }
        #[inline(always)]
        fn angle_bound(angle: Self) -> Self {
            angle
        }
        #[inline(always)]
        fn from_bound(bound: Self) -> Self {
            bound
        }
        #[inline(always)]
        fn roundoffs(count: u8, size: Self) -> Self {
            size * (Self::from(count) * Self::UNIT_ROUNDOFF)
        }
    };
}

impl Enclose for f64 {
    type Centre = Self;

    own_bounds!();

    #[inline(always)]
    fn conversion(_: Self) -> Self {
        0.0
    }
}

/// Part of the [roundoffs](Enclose::roundoff) of all terms that is counted where a centre has two words. They are at least twice what the
/// tick rounds, so that a 32nd of that is counted. Tests of the package `tests` say how much is rounded.
///
/// The centre takes less than a thousandth of it: a sum 3 u^2 of 2 u / 64, a function 40 u^2 of 8 u / 64.
const TICK_WEIGHT: f32 = 1.0 / 64.0;

impl Enclose for f32 {
    type Centre = TwoWord;

    /// The true motion is one cubic, from either end.
    const COARSEST: u32 = 0;
    const IS_ROUGH_FIRST: bool = true;

    own_bounds!();

    #[inline(always)]
    fn conversion(_: Self) -> Self {
        0.0
    }

    /// Rounding of a tick has taken up to 15 times its allowance, mostly some 1e-5 of the limit.
    #[inline(always)]
    fn of_result(limit: Self) -> Self {
        limit + limit * (1.0 / 1024.0)
    }

    #[inline(always)]
    fn coefficient(size: Self) -> Self {
        size * (2.0 * TICK_WEIGHT * Self::UNIT_ROUNDOFF)
    }
}

impl Enclose for Coarse {
    /// With accurate functions: bounds are those of the true motion.
    type Bound = f32;
    type Centre = f32;

    const COARSEST: u32 = f32::COARSEST;

    #[inline(always)]
    fn bound(self) -> f32 {
        self.0
    }
    #[inline(always)]
    fn conversion(_: f32) -> f32 {
        0.0
    }
    #[inline(always)]
    fn angle_bound(angle: Self) -> f32 {
        angle.0
    }
    #[inline(always)]
    fn from_bound(bound: f32) -> Self {
        Self(bound)
    }
    #[inline(always)]
    fn roundoffs(count: u8, size: f32) -> f32 {
        f32::roundoffs(count, size)
    }
}

impl Enclose for Fixed {
    /// A format this narrow has no room for bounds.
    type Bound = f32;
    type Centre = f32;

    fn bound(self) -> f32 {
        if self.is_finite() {
            self.0 as f32 * Self::UNIT as f32
        } else {
            f32::INFINITY
        }
    }

    fn conversion(size: f32) -> f32 {
        Self::roundoff(size)
    }

    fn angle_bound(angle: Self::Angle) -> f32 {
        const TURN: f32 = (core::f64::consts::TAU / 4_294_967_296.0) as f32;
        angle.0 as f32 * TURN
    }

    /// As [`from_f64`](Arithmetic::from_f64), by steps that are exact in binary32.
    fn from_bound(bound: f32) -> Self {
        if bound.is_nan() {
            return Self(i32::MIN);
        }
        let scaled = bound * Self::ONE.0 as f32;
        // The conversion saturates.
        let whole = scaled as i32;
        let rest = scaled - whole as f32;
        let away = i32::from(rest >= 0.5) - i32::from(rest <= -0.5);
        Self(whole.saturating_add(away))
    }

    /// The unit and the float's own.
    #[inline(always)]
    fn roundoffs(count: u8, size: f32) -> f32 {
        let count = f32::from(count);
        size * (count * f32::UNIT_ROUNDOFF) + count * Self::UNIT as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In binary64 every binary32 number times 2^29 and a half is exact: what is nearest is plain there.
    #[test]
    fn bounds_become_the_nearest_number() {
        for step in 0..(1u32 << 20) {
            let bound = f32::from_bits(step.wrapping_mul(4099));
            let scaled = f64::from(bound) * 536_870_912.0;
            let expected = if bound.is_nan() {
                i32::MIN
            } else {
                // Halves away from zero; the conversion saturates.
                (scaled.abs() + 0.5).floor().copysign(scaled) as i32
            };
            assert_eq!(Fixed::from_bound(bound).0, expected, "{bound:e}");
            assert_eq!(Fixed::from_f64(bound.into()).0, expected, "{bound:e}");
        }
        for (halves, expected) in [(1, 1), (-1, -1), (3, 2), (-5, -3), (0, 0)] {
            let bound = halves as f32 / 1_073_741_824.0;
            assert_eq!(Fixed::from_bound(bound).0, expected, "{halves}");
        }
    }
}
