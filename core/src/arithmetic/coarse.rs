//! [`Arithmetic`] for binary32 with the coarse functions of the micromath crate, to measure their
//! cost and error.
//!
//! Sums and products are those of `f32`. The square root is an affine map of the bits, up to 6.1 %
//! too large; sine and cosine are parabolas, within 1.1e-3; the arctangent is a rational function,
//! within 2.9e-3 rad. No scene uses it by default.
//!
//! Quotients are true divisions: micromath's reciprocal is off by 1e-5 and takes more instructions
//! than a division on every core that is counted here, with an FPU or without.
//!
//! The functions are called by micromath's own type, not by its extension trait: where the
//! standard library is linked, `f32` has methods of the same names, and those win.

use super::{Arithmetic, RoundsEachStep};
use crate::to_source;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use micromath::F32;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A binary32 number whose functions are coarse. As an angle, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize, Schema)]
#[repr(transparent)]
pub struct Coarse(pub f32);

to_source!(pub Coarse in trirrr_core::number; 0);

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt, $assign_trait:ident, $assign:ident) => {
        impl $trait for Coarse {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
        impl $assign_trait for Coarse {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    };
}

operator!(Add, add, +, AddAssign, add_assign);
operator!(Sub, sub, -, SubAssign, sub_assign);
operator!(Mul, mul, *, MulAssign, mul_assign);

impl Neg for Coarse {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Arithmetic for Coarse {
    type Angle = Self;

    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const HALF: Self = Self(0.5);
    const UNIT_ROUNDOFF: Self = Self(f32::EPSILON / 2.0);

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self(x as f32)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.0.into()
    }
    #[inline(always)]
    fn angle_from_f64(radians: f64) -> Self {
        Self(radians as f32)
    }
    #[inline(always)]
    fn angle_to_f64(angle: Self) -> f64 {
        angle.0.into()
    }
    #[inline(always)]
    fn half_turn() -> Self {
        Self(core::f32::consts::PI)
    }
    #[inline(always)]
    fn angle(radians: Self) -> Self {
        radians
    }
    #[inline(always)]
    fn radians(angle: Self) -> Self {
        angle
    }
    // A true division: a move has to end where it is told to.
    #[inline(always)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        Self(f32::ratio(numerator, denominator))
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        Self(self.0 / divisor.0)
    }
    /// At most 6.1 % too large, never too small by more than a rounding.
    #[inline(always)]
    fn sqrt(self) -> Self {
        // The map of the bits takes 0 to 1e-19, -0 and infinity to 1e19.
        if self.0 > 0.0 && self.0 < f32::INFINITY {
            Self(F32(self.0).sqrt().0)
        } else if self.0 < 0.0 {
            Self(f32::NAN)
        } else {
            self
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    /// Within 1.1e-3 for small angles; the reduction of an angle x adds u |x|, and beyond 1e10 rad
    /// the two are not even below 1.
    #[inline(always)]
    fn sin_cos(angle: Self) -> (Self, Self) {
        let (sin, cos) = F32(angle.0).sin_cos();
        (Self(sin.0), Self(cos.0))
    }
    /// Within 2.9e-3 rad for vectors whose squares are in range.
    #[inline(always)]
    fn atan2(y: Self, x: Self) -> Self {
        // micromath divides 0 by 0 there.
        if y.0 == 0.0 && x.0 == 0.0 {
            return Self::ZERO;
        }
        Self(F32(y.0).atan2(F32(x.0)).0)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

impl RoundsEachStep for Coarse {
    /// As [`atan2`](Arithmetic::atan2), which has no use for the length. The vector must not be zero.
    #[inline(always)]
    fn directions_at_lengths<const COUNT: usize>(
        x: [Self; COUNT],
        y: [Self; COUNT],
        _inverse: [Self; COUNT],
    ) -> [Self; COUNT] {
        core::array::from_fn(|i| Self(F32(y[i].0).atan2(F32(x[i].0)).0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::WideArithmetic;
    use core::f64::consts::{PI, TAU};

    /// The worst of `errors` lies in `bracket`: beyond it the documentation is wrong, below it so.
    fn worst(what: &str, errors: impl Iterator<Item = f64>, bracket: core::ops::Range<f64>) {
        let worst = errors.fold(0.0, |worst: f64, error| {
            // What is not a number must not pass for small.
            if error.abs() <= worst {
                worst
            } else {
                error.abs()
            }
        });
        std::println!("{what}: {worst:e}");
        assert!(bracket.contains(&worst), "{what}: {worst:e}");
    }

    /// Every significand, in a binade with an even exponent and in one with an odd one: the map is
    /// the same in all others. 1.5 stands for the square root of 2, the worst there is.
    #[test]
    fn square_roots_are_up_to_6_percent_too_large() {
        let errors = || {
            (1f32.to_bits()..4f32.to_bits()).step_by(7).map(|bits| {
                let x = f32::from_bits(bits);
                let root = std::primitive::f64::sqrt(x.into());
                Coarse(x).sqrt().to_f64() / root - 1.0
            })
        };
        worst("square root", errors(), 0.0606..0.0607);
        assert!(errors().all(|error| error > -1e-7));
    }

    #[test]
    fn sines_and_cosines_are_within_a_thousandth() {
        let angles = || (-1_000_000..=1_000_000).map(|k| f64::from(k) * (TAU / 1e6));
        let errors = angles().flat_map(|angle| {
            let angle = angle as f32;
            let (sin, cos) = Coarse::sin_cos(Coarse(angle));
            let truth = std::primitive::f64::sin_cos(angle.into());
            [sin.to_f64() - truth.0, cos.to_f64() - truth.1]
        });
        worst("sine and cosine", errors, 1.0e-3..1.1e-3);
    }

    #[test]
    fn directions_are_within_3_milliradians() {
        for length in [1e-6, 0.2, 1e6] {
            let errors = (0..1_000_000).map(|k| {
                let truth = f64::from(k) * (TAU / 1e6) - PI;
                let (sin, cos) = std::primitive::f64::sin_cos(truth);
                let (y, x) = (Coarse((length * sin) as f32), Coarse((length * cos) as f32));
                let found = Coarse::atan2(y, x);
                assert_eq!(found, Coarse::direction(x, y, &Coarse(length as f32)));
                let error = found.to_f64() - truth;
                error - TAU * std::primitive::f64::round(error / TAU)
            });
            worst("direction", errors, 2.8e-3..2.9e-3);
        }
    }

    #[test]
    fn what_has_no_value_is_not_finite() {
        for zero in [0.0, -0.0] {
            assert!(!Coarse::ONE.div(Coarse(zero)).is_finite());
            assert_eq!(Coarse(zero).sqrt(), Coarse::ZERO);
        }
        assert!(!Coarse(f32::INFINITY).sqrt().is_finite());
        assert!(!Coarse(f32::NAN).sqrt().is_finite());
        assert!(Coarse(-1.0).sqrt().0.is_nan());
        // micromath's maps of the bits wrap in these; they must not panic either.
        for x in [f32::MAX, f32::INFINITY, f32::NAN, -f32::MAX] {
            let _ = Coarse::ONE.div(Coarse(x));
            let _ = Coarse::sin_cos(Coarse(x));
            let _ = Coarse::atan2(Coarse(x), Coarse(x));
        }
        assert_eq!(Coarse::atan2(Coarse::ZERO, Coarse::ZERO), Coarse::ZERO);
    }

    #[test]
    fn quotients_and_ratios_are_those_of_f32() {
        for (numerator, denominator) in [(0, 7), (7, 7), (1, 3), (99, 100)] {
            let ratio = Coarse::ratio(numerator, denominator);
            assert_eq!(ratio.0, f32::ratio(numerator, denominator));
            let quotient = Coarse(numerator as f32).div(Coarse(denominator as f32));
            assert_eq!(quotient, ratio);
        }
    }
}
