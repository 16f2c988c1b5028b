//! The number floor: one trait, [`Number`], that the whole pipeline is generic over.
//!
//! | type | for | angles are |
//! |---|---|---|
//! | `f64` | host, reference | radians in an `f64` |
//! | `f32` | microcontrollers with an FPU | radians in an `f32` |
//! | [`Fixed`] | microcontrollers without one | 2^-32 of a turn in an `i64` |
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
pub mod fixed;
mod polynomial;
mod reduction;
#[cfg(test)]
mod reference;
#[doc(hidden)]
pub mod simple;
mod sin_cos;
mod sqrt;
#[doc(hidden)]
pub mod triangle;
mod vector;

mod float;

pub use coarse::Coarse;
#[doc(hidden)]
pub use fingerprint::fingerprint;
pub use fixed::Fixed;
pub use triangle::{Apex, OutOfReach, Triangle};
pub use vector::{cross, dot, perpendicular, sum_cross, sum_dot};

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::Vector2;

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

    /// A sum of products that is not yet rounded to `Self`. Floats round every step, so theirs is
    /// the float itself; fixed point holds 64 bits and rounds once, in [`round`](Number::round).
    type Sum: Copy
        + Debug
        + PartialOrd
        + Send
        + Sync
        + 'static
        + Add<Output = Self::Sum>
        + Sub<Output = Self::Sum>
        + Neg<Output = Self::Sum>;

    /// A number of any size that others are multiplied by: a reciprocal, a rate of ticks. For
    /// floats the float itself; fixed point holds a significand and an exponent.
    type Factor: Copy
        + Debug
        + PartialEq
        + Send
        + Sync
        + 'static
        + Mul<Output = Self::Factor>
        + Neg<Output = Self::Factor>;

    /// A positive count of ticks that [fractions](Number::fraction) are taken of, prepared so that
    /// a fraction costs no wide division.
    type Count: Copy + Debug + PartialEq + Send + Sync + 'static;

    /// The float in which bounds of quantities of this type are computed before a move is played: the
    /// type itself where its functions are as accurate as its numbers.
    type Bound: Number<Bound = Self::Bound>;

    /// A length that vectors are known to have, prepared for [`direction`](Number::direction).
    type Length: Copy + Debug + PartialEq + Send + Sync + 'static;

    /// Whether what is computed from a value that is not [finite](Number::is_finite) is not finite
    /// either, as infinities do; otherwise the stages look at what may have left the range.
    const SPREADS: bool;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// Relative rounding error of one operation (half a unit in the last place of 1).
    const UNIT_ROUNDOFF: Self;

    /// The value as a bound, to one [conversion](Number::conversion).
    fn bound(self) -> Self::Bound;
    /// A bound of how far a value of this size in [`Number::Bound`] may be from what this type makes
    /// of it, a coefficient as well; 0 where the two types are one.
    fn conversion(size: Self::Bound) -> Self::Bound;
    /// The angle as a bound, to two conversions.
    fn angle_bound(angle: Self::Angle) -> <Self::Bound as Number>::Angle;
    /// The nearest value to `bound`.
    fn from_bound(bound: Self::Bound) -> Self;
    /// A bound of what one operation rounds whose result is of this size, which is not negative, in
    /// this type as well as in [`Number::Bound`]. Underflow is left out.
    fn roundoff(size: Self::Bound) -> Self::Bound;

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

    /// `numerator / denominator`, correctly rounded; for building coefficients, not for the tick.
    fn ratio(numerator: u32, denominator: u32) -> Self;

    /// Prepares the count that fractions are taken of.
    fn count(ticks: u32) -> Self::Count;
    /// `numerator / count` of ticks, the numerator not above the count: exact at 0 and 1, within
    /// one unit in the last place between.
    fn fraction(numerator: u32, count: &Self::Count) -> Self;

    /// The factor nearest to `x`. For building coefficients, not for the tick.
    fn factor_from_f64(x: f64) -> Self::Factor;
    /// The factor as a binary64 number, exactly.
    fn factor_to_f64(factor: Self::Factor) -> f64;
    /// `numerator / denominator` as a factor.
    fn quotient(numerator: u32, denominator: u32) -> Self::Factor;
    /// f / g; for building coefficients, not for the tick.
    fn factor_over(f: Self::Factor, g: Self::Factor) -> Self::Factor;
    /// 1 / self, for multiplying by. Of zero, a factor whose products are not
    /// [finite](Number::is_finite).
    fn reciprocal(self) -> Self::Factor;
    /// self f.
    fn scaled(self, f: Self::Factor) -> Self;
    /// self f g.
    fn scaled_twice(self, f: Self::Factor, g: Self::Factor) -> Self;

    /// The sum nearest to `x`. For building coefficients, not for the tick.
    fn sum_from_f64(x: f64) -> Self::Sum;
    /// The value as a sum, exactly.
    fn widen(self) -> Self::Sum;
    /// a b, not rounded.
    fn product(a: Self, b: Self) -> Self::Sum;
    /// a b + c d, not rounded.
    fn sum_ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self::Sum;
    /// a b - c d, not rounded.
    fn sum_ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self::Sum;
    /// The sum, rounded.
    fn round(sum: Self::Sum) -> Self;
    /// sum f, rounded once.
    fn round_scaled(sum: Self::Sum, f: Self::Factor) -> Self;

    /// The third corner of a triangle over the side `base`.
    ///
    /// # Errors
    /// [`OutOfReach`].
    fn apex(triangle: &Triangle<Self>, base: Vector2<Self>) -> Result<Apex<Self>, OutOfReach>;

    /// a b + c d.
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self;
    /// a b - c d.
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self;
    /// (a - b) / 2 for squares of lengths, neither negative.
    #[inline(always)]
    fn half_difference(a: Self, b: Self) -> Self {
        Self::HALF * (a - b)
    }
    /// (place - base) + arm: the difference of two places first, which are exact inputs, so that a
    /// large common offset cancels before anything is rounded. The arm is at most 1/2 long where
    /// values have to [fit](Number::fit).
    #[inline(always)]
    fn span(place: Self, base: Self, arm: Self) -> Self {
        (place - base) + arm
    }
    /// Whether a place is so near that a [`span`](Number::span) from any other such place is right
    /// or longer than any leg.
    #[inline(always)]
    fn is_near(_place: Self) -> bool {
        true
    }
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
    /// Prepares a positive length. For building coefficients, not for the tick.
    fn length_from_f64(x: f64) -> Self::Length;
    /// The length itself.
    fn length(length: &Self::Length) -> Self;
    /// Angle of the vector (x, y) whose length is known to be `length`, in (-pi, pi]: cheaper than
    /// [`atan2`](Number::atan2), and as accurate as the length is.
    fn direction(x: Self, y: Self, length: &Self::Length) -> Self::Angle;
    /// False for infinities and for what is not a number.
    fn is_finite(self) -> bool;
    /// Whether all values are so small that what the next stage forms of them is within the
    /// range. Where a value out of range [spreads](Number::SPREADS) there is nothing to ask.
    #[inline(always)]
    fn fit<const COUNT: usize>(_values: [Self; COUNT]) -> bool {
        true
    }
}
