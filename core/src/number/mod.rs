//! The number floor: one trait, [`Number`], that the whole pipeline is generic over.
//!
//! | type | for | angles are |
//! |---|---|---|
//! | `f64` | host, reference | radians in an `f64` |
//! | `f32` | microcontrollers with an FPU | radians in an `f32` |
//! | [`Coarse`] | seeing what the micromath crate's functions cost | radians in a `Coarse` |
//!
//! Every function here gives the same bits on every machine: nothing calls the platform's libm,
//! nothing is contracted into a fused multiply-add.
//!
//! Sums of products have operations of their own ([`Number::ab_plus_cd`] and relatives) although
//! a float gains nothing from them: fixed point accumulates them wide and rounds once.

mod atan2;
mod coarse;
mod direction;
mod fingerprint;
mod polynomial;
mod reduction;
#[cfg(test)]
mod reference;
mod sin_cos;
mod sqrt;
mod vector;

mod float;

pub use coarse::Coarse;
#[doc(hidden)]
pub use fingerprint::fingerprint;
pub use vector::{cross, dot, perpendicular};

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// What the pipeline needs of a number.
///
/// Comparisons with a value that is not a number are false, as for floats; the pipeline writes
/// its guards so that a false comparison means "refuse".
pub trait Number:
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
{
    /// An angle, unbounded: alpha and the link angles are not wrapped. Floats hold radians.
    type Angle: Copy
        + Debug
        + PartialEq
        + Send
        + Sync
        + 'static
        + Add<Output = Self::Angle>
        + Sub<Output = Self::Angle>
        + Neg<Output = Self::Angle>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// Relative rounding error of one operation (half a unit in the last place of 1).
    const UNIT_ROUNDOFF: Self;

    /// A bound of what one operation rounds whose result is of this size, which is not negative.
    /// Underflow is left out.
    #[inline(always)]
    fn roundoff(size: Self) -> Self {
        size * Self::UNIT_ROUNDOFF
    }

    /// The nearest value to `x`. For building coefficients, not for the tick.
    fn from_f64(x: f64) -> Self;
    /// The value as a binary64 number, exactly.
    fn to_f64(self) -> f64;
    /// The angle nearest to `radians`. For building coefficients, not for the tick.
    fn angle_from_f64(radians: f64) -> Self::Angle;
    /// The angle in radians.
    fn angle_to_f64(angle: Self::Angle) -> f64;

    /// The angle of `radians`, as precise as `Self` is.
    fn angle(radians: Self) -> Self::Angle;
    /// An angle, or a difference of angles, in radians.
    fn radians(angle: Self::Angle) -> Self;

    /// `numerator / denominator` of two tick counts, exact at 0 and 1, correctly rounded between.
    fn ratio(numerator: u32, denominator: u32) -> Self;

    /// a b + c d.
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self;
    /// a b - c d.
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self;
    /// self / divisor. A zero divisor gives a value that is not [finite](Number::is_finite).
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
    /// Angle of the vector (x, y) whose length is known to be `length`, in (-pi, pi]: cheaper than
    /// [`atan2`](Number::atan2), and as accurate as the length is.
    fn direction(x: Self, y: Self, length: Self) -> Self::Angle;
    /// False for infinities and for what is not a number.
    fn is_finite(self) -> bool;
}
