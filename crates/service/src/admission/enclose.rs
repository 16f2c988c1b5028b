//! [`Enclose`]: bounds of what a number type rounds.

use trirrr_core::number::{Arithmetic, Coarse, Fixed, Number};

/// A number type of the tick whose moves can be admitted: bounds of its values and of its rounding
/// errors are computed in a float.
pub trait Enclose: Number {
    /// The float in which bounds are computed before a move is played: the type itself where its
    /// functions are as accurate as its numbers.
    type Bound: Number;

    /// The value as a bound, to one [conversion](Self::conversion).
    fn bound(self) -> Self::Bound;
    /// A bound of the distance between a value of this size in [`Bound`](Self::Bound) and the same
    /// value, or coefficient, in this type; 0 where the two types are one.
    fn conversion(size: Self::Bound) -> Self::Bound;
    /// The angle as a bound, to two conversions.
    fn angle_bound(angle: Self::Angle) -> <Self::Bound as Arithmetic>::Angle;
    /// The nearest value to `bound`.
    fn from_bound(bound: Self::Bound) -> Self;
    /// A bound of the rounding error of one operation whose result is of this size, not negative,
    /// in this type as well as in [`Bound`](Self::Bound). Underflow is left out.
    fn roundoff(size: Self::Bound) -> Self::Bound;
}

macro_rules! float {
    ($float:ident) => {
        impl Enclose for $float {
            type Bound = Self;

            #[inline(always)]
            fn bound(self) -> Self {
                self
            }
            #[inline(always)]
            fn conversion(_: Self) -> Self {
                0.0
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
            fn roundoff(size: Self) -> Self {
                size * Self::UNIT_ROUNDOFF
            }
        }
    };
}

float!(f32);
float!(f64);

impl Enclose for Coarse {
    /// With accurate functions: bounds are those of the true motion.
    type Bound = f32;

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
    fn roundoff(size: f32) -> f32 {
        f32::roundoff(size)
    }
}

impl Enclose for Fixed {
    /// A format this narrow has no room for bounds.
    type Bound = f32;

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
    fn roundoff(size: f32) -> f32 {
        size * f32::UNIT_ROUNDOFF + Self::UNIT as f32
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
