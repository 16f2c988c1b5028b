//! Operations whose operands or results are not rounded to the number type.
//!
//! A float gains nothing from them, since it rounds every step. Fixed point accumulates sums of
//! products in 64 bits and rounds once.

use super::Arithmetic;
use crate::source::ToSource;
use core::array;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};
use nalgebra::Vector2;

/// Sums of products, factors, fractions of a count, and directions of vectors of known length.
pub trait WideArithmetic: Arithmetic {
    /// A sum of products that is not yet rounded to `Self`. Floats round every step, so theirs is
    /// the float itself; fixed point holds 64 bits and rounds once, in [`round`](Self::round).
    type Sum: Copy
        + Debug
        + PartialOrd
        + Send
        + Sync
        + 'static
        + Add<Output = Self::Sum>
        + Sub<Output = Self::Sum>
        + Neg<Output = Self::Sum>
        + ToSource;

    /// A multiplier of any size: a reciprocal, a rate of ticks. For floats the float itself; fixed
    /// point holds a significand and an exponent.
    type Factor: Copy
        + Debug
        + PartialEq
        + Send
        + Sync
        + 'static
        + Mul<Output = Self::Factor>
        + Neg<Output = Self::Factor>
        + ToSource;

    /// A positive count of ticks, prepared so that a [fraction](Self::fraction) of it costs no wide
    /// division.
    type Count: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static;

    /// The known length of a vector, prepared for [`direction`](Self::direction).
    type Length: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static;

    /// Prepares the count that fractions are taken of.
    fn count(ticks: u32) -> Self::Count;
    /// `numerator / count` of ticks, the numerator below the count: within two units in the last place.
    fn fraction(numerator: u32, count: &Self::Count) -> Self;

    /// The factor nearest to `x`. For building coefficients, not for the tick.
    fn factor_from_f64(x: f64) -> Self::Factor;
    /// The factor as a binary64 number, exactly.
    fn factor_to_f64(factor: Self::Factor) -> f64;
    /// `numerator / denominator` as a factor.
    fn quotient(numerator: u32, denominator: u32) -> Self::Factor;
    /// f / g. For building coefficients, not for the tick.
    fn factor_over(f: Self::Factor, g: Self::Factor) -> Self::Factor;
    /// 1 / self, for multiplying by. Of zero, a factor whose products are not
    /// [finite](Arithmetic::is_finite).
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
    /// a . b, not rounded.
    #[inline(always)]
    fn sum_dot_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self::Sum {
        Self::sum_ab_plus_cd(a.x, b.x, a.y, b.y)
    }
    /// a x b, not rounded.
    #[inline(always)]
    fn sum_cross_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self::Sum {
        Self::sum_ab_minus_cd(a.x, b.y, a.y, b.x)
    }
    /// The sum, rounded.
    fn round(sum: Self::Sum) -> Self;
    /// sum f, rounded once.
    fn round_scaled(sum: Self::Sum, f: Self::Factor) -> Self;
    /// [`round_scaled`](Self::round_scaled) of two sums.
    #[inline(always)]
    fn round_scaled_pair(sums: [Self::Sum; 2], f: Self::Factor) -> [Self; 2] {
        let [first, second] = sums;
        [Self::round_scaled(first, f), Self::round_scaled(second, f)]
    }

    /// Prepares a positive length. For building coefficients, not for the tick.
    fn length_from_f64(x: f64) -> Self::Length;
    /// The length itself, within two roundings.
    fn length(length: &Self::Length) -> Self;
    /// Angle of the vector (x, y) whose length is known to be `length`, in (-pi, pi]: cheaper than
    /// [`atan2`](Arithmetic::atan2), and as accurate as the length is.
    fn direction(x: Self, y: Self, length: &Self::Length) -> Self::Angle;
    /// [`direction`](Self::direction) of several vectors, in less time than one by one.
    #[inline(always)]
    fn directions<const COUNT: usize>(
        vectors: [Vector2<Self>; COUNT],
        lengths: [&Self::Length; COUNT],
    ) -> [Self::Angle; COUNT] {
        let mut angles = [Self::half_turn(); COUNT];
        for (angle, (vector, length)) in angles.iter_mut().zip(vectors.iter().zip(lengths)) {
            *angle = Self::direction(vector.x, vector.y, length);
        }
        angles
    }
}

/// A type that rounds every operation: its own sum of products, its own factor.
///
/// Its [`WideArithmetic`] and its dyad kernel follow from its [`Arithmetic`].
pub trait RoundsEachStep: Arithmetic {
    /// [`WideArithmetic::directions`]; `inverse` is 1 over the lengths. Types that gain nothing from it leave
    /// the angles to [`atan2`](Arithmetic::atan2).
    #[inline(always)]
    fn directions_at_lengths<const COUNT: usize>(
        x: [Self; COUNT],
        y: [Self; COUNT],
        _inverse: [Self; COUNT],
    ) -> [Self::Angle; COUNT] {
        array::from_fn(|i| Self::atan2(y[i], x[i]))
    }
}

impl<T: RoundsEachStep> WideArithmetic for T {
    type Sum = Self;
    type Factor = Self;
    /// 1 over the count.
    type Count = Self;
    /// 1 over the length.
    type Length = Self;

    #[inline(always)]
    fn count(ticks: u32) -> Self {
        Self::ratio(1, ticks)
    }
    #[inline(always)]
    fn fraction(numerator: u32, inverse: &Self) -> Self {
        Self::ratio(numerator, 1) * *inverse
    }
    #[inline(always)]
    fn factor_from_f64(x: f64) -> Self {
        Self::from_f64(x)
    }
    #[inline(always)]
    fn factor_to_f64(factor: Self) -> f64 {
        factor.to_f64()
    }
    #[inline(always)]
    fn quotient(numerator: u32, denominator: u32) -> Self {
        Self::ratio(numerator, denominator)
    }
    #[inline(always)]
    fn factor_over(f: Self, g: Self) -> Self {
        f.div(g)
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::ONE.div(self)
    }
    #[inline(always)]
    fn scaled(self, f: Self) -> Self {
        self * f
    }
    #[inline(always)]
    fn scaled_twice(self, f: Self, g: Self) -> Self {
        self * f * g
    }
    #[inline(always)]
    fn sum_from_f64(x: f64) -> Self {
        Self::from_f64(x)
    }
    #[inline(always)]
    fn widen(self) -> Self {
        self
    }
    #[inline(always)]
    fn product(a: Self, b: Self) -> Self {
        a * b
    }
    #[inline(always)]
    fn sum_ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::ab_plus_cd(a, b, c, d)
    }
    #[inline(always)]
    fn sum_ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::ab_minus_cd(a, b, c, d)
    }
    #[inline(always)]
    fn sum_dot_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        Self::dot_of(a, b)
    }
    #[inline(always)]
    fn sum_cross_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        Self::cross_of(a, b)
    }
    #[inline(always)]
    fn round(sum: Self) -> Self {
        sum
    }
    #[inline(always)]
    fn round_scaled(sum: Self, f: Self) -> Self {
        sum * f
    }
    #[inline(always)]
    fn length_from_f64(x: f64) -> Self {
        Self::from_f64(1.0 / x)
    }
    #[inline(always)]
    fn length(inverse: &Self) -> Self {
        Self::ONE.div(*inverse)
    }
    #[inline(always)]
    fn direction(x: Self, y: Self, inverse: &Self) -> Self::Angle {
        let [angle] = Self::directions_at_lengths([x], [y], [*inverse]);
        angle
    }
    #[inline(always)]
    fn directions<const COUNT: usize>(
        vectors: [Vector2<Self>; COUNT],
        inverse: [&Self; COUNT],
    ) -> [Self::Angle; COUNT] {
        let (x, y) = (
            vectors.map(|vector| vector.x),
            vectors.map(|vector| vector.y),
        );
        Self::directions_at_lengths(x, y, inverse.map(|inverse| *inverse))
    }
}
