//! Arithmetic of the number types: [`Arithmetic`] for single values, [`WideArithmetic`] for sums of
//! products and other operands that are not rounded to the type.

mod atan2;
mod coarse;
mod direction;
mod fingerprint;
pub mod fixed;
mod float;
mod polynomial;
mod reduction;
#[cfg(test)]
mod reference;
mod sin_cos;
mod sqrt;
mod vector;
mod wide;

pub use coarse::Coarse;
#[doc(hidden)]
pub use fingerprint::fingerprint;
pub use fixed::Fixed;
pub use vector::{cross, dot, perpendicular, sum_cross, sum_dot};
pub use wide::{RoundsEachStep, WideArithmetic};

use crate::source::ToSource;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::Vector2;

/// Constants, conversions and functions of single values.
///
/// Comparisons with a value that is not a number are false, as for floats. The tick writes its
/// guards so that a false comparison refuses.
pub trait Arithmetic:
    Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + ToSource
{
    /// An angle. It is not wrapped into one turn; floats hold radians.
    type Angle: Copy
        + Debug
        + PartialEq
        + Send
        + Sync
        + 'static
        + Add<Output = Self::Angle>
        + Sub<Output = Self::Angle>
        + Neg<Output = Self::Angle>
        + ToSource;

    /// `true` where results of values that are not [finite](Self::is_finite) are not finite either,
    /// as with the infinities of floats. Otherwise the stages ask [`in_range`](Self::in_range).
    const PROPAGATES_NON_FINITE: bool = true;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// Relative rounding error of one operation (half a unit in the last place of 1).
    const UNIT_ROUNDOFF: Self;

    /// The nearest value to `x`. For building coefficients, not for the tick.
    fn from_f64(x: f64) -> Self;
    /// The value as a binary64 number, exactly.
    fn to_f64(self) -> f64;
    /// The angle nearest to `radians`. For building coefficients, not for the tick.
    fn angle_from_f64(radians: f64) -> Self::Angle;
    /// The angle in radians.
    fn angle_to_f64(angle: Self::Angle) -> f64;

    /// pi.
    fn half_turn() -> Self::Angle;
    /// The angle of `radians`, as precise as `Self` is.
    fn angle(radians: Self) -> Self::Angle;
    /// An angle, or a difference of angles, in radians.
    fn radians(angle: Self::Angle) -> Self;

    /// `numerator / denominator`, correctly rounded. For building coefficients, not for the tick.
    fn ratio(numerator: u32, denominator: u32) -> Self;

    /// a b + c d.
    #[inline(always)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        a * b + c * d
    }
    /// a b - c d.
    #[inline(always)]
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        a * b - c * d
    }
    /// a . b.
    #[inline(always)]
    fn dot_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        Self::ab_plus_cd(a.x, b.x, a.y, b.y)
    }
    /// a x b.
    #[inline(always)]
    fn cross_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        Self::ab_minus_cd(a.x, b.y, a.y, b.x)
    }
    /// self / divisor. A zero divisor gives a value that is not [finite](Self::is_finite).
    fn div(self, divisor: Self) -> Self;
    /// The square root, correctly rounded; of a negative number, not a number.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Sine and cosine, each within one unit in the last place, for any finite angle.
    fn sin_cos(angle: Self::Angle) -> (Self, Self);
    /// Angle of the vector (x, y), in [-pi, pi], within two units in the last place.
    /// `(0, 0)` gives 0.
    fn atan2(y: Self, x: Self) -> Self::Angle;
    /// `false` for infinities and for values that are not numbers.
    fn is_finite(self) -> bool;
    /// `false` for angles that are infinite or not numbers.
    #[inline(always)]
    fn angle_is_finite(angle: Self::Angle) -> bool {
        Self::radians(angle).is_finite()
    }
    /// `angle` less the whole turns of `of`, where both are exact; `angle` itself where turns are rounded, as with
    /// floats.
    #[inline(always)]
    fn without_turns(angle: Self::Angle, _of: Self::Angle) -> Self::Angle {
        angle
    }
    /// `true` if the next stage's products and sums of `values` stay in range. Always `true` where
    /// a value out of range [propagates](Self::PROPAGATES_NON_FINITE).
    #[inline(always)]
    fn in_range<const COUNT: usize>(_values: [Self; COUNT]) -> bool {
        true
    }
}
