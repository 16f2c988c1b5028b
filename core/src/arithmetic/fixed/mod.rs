//! Fixed point: for microcontrollers without a floating-point unit.
//!
//! # Format
//! A [`Fixed`] is a whole number of 2^-29 and reaches from -4 to 4. It holds a quantity in units that
//! are powers of two, chosen for the machine and its job so that every quantity of the tick is below
//! 2. The sum of two such values still fits; larger results saturate at the rails.
//!
//! | type | holds | in |
//! |---|---|---|
//! | [`Fixed`] | quantities | `i32`, 2^-29 |
//! | [`Sum`] | sums of products, not rounded | `i64`, 2^-58 |
//! | [`Factor`] | multipliers: reciprocals, rates of ticks | 31 bits and an exponent |
//! | [`Turns`] | angles | `i64`, 2^-32 of a turn |
//! | [`Count`] | ticks of a move, for fractions of it | a 32-bit reciprocal and a shift |
//!
//! # Operations
//! One unit is 2^-29. Every operation is integer arithmetic without division, with the same bits on
//! every machine. "Saturates" means that a result beyond the range becomes one of the rails, which
//! are not finite.
//!
//! | operation | error | beyond the range |
//! |---|---|---|
//! | `a + b`, `a - b`, `-a`, `abs` | exact | saturates |
//! | `a * b`, `ab_plus_cd`, `ab_minus_cd`, [`round`](WideArithmetic::round) | 0.5 unit, one rounding | saturates |
//! | `sum_ab_plus_cd`, `widen`, sums of sums | exact | the caller adds up to four products of values in range |
//! | `scaled`, `round_scaled` | 0.5 unit + 2^-30 of the value | saturates |
//! | `reciprocal`, products and quotients of factors | 2^-30 of the value | - |
//! | `div` | 0.5 unit + 2^-30 of the value | saturates; by zero, too |
//! | `sqrt` | 0.5 unit, correctly rounded | of a negative number a rail |
//! | `sin_cos` | 0.9 unit | - |
//! | `direction`, `atan2` | 1.1 units of an angle, 2^-32 of a turn | - |
//! | `fraction` | 0.75 unit, exact at both ends | - |
//! | `angle`, `radians` | 0.5 unit of the result + 2^-30 of the value | `radians` saturates |

mod count;
mod direction;
pub(crate) mod factor;
pub(crate) mod product;
pub(crate) mod reciprocal;
pub(crate) mod root;
mod sin_cos;
mod turns;

pub use count::Count;
pub use direction::Inverse;
pub use factor::Factor;
pub use turns::Turns;

use super::{Arithmetic, WideArithmetic};
use crate::to_source;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use postcard_schema::Schema;
use product::{normalised, saturated, signed};
use serde::{Deserialize, Serialize};

/// A number in 2^-29, from -4 to 4.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema,
)]
#[repr(transparent)]
pub struct Fixed(pub i32);

/// A sum of products of [`Fixed`], in 2^-58.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Sum(pub i64);

/// The known length of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Length {
    /// The length.
    value: Fixed,
    /// Left shift that takes the length into (2^29, 2^30].
    shift: u32,
    /// Of that.
    inverse: Inverse,
}

to_source!([] Length [] in trirrr_core::number::fixed { value: Fixed, shift: u32, inverse: Inverse });
to_source!(pub Fixed in trirrr_core::number; 0);
to_source!(pub Sum in trirrr_core::number::fixed; 0);

/// Bits behind the point.
pub(crate) const FRACTION: u32 = 29;

/// 2 pi / 8 in 2^-30, from 2^-32 of a turn to 2^-29 rad; and its reciprocal.
const RADIANS: i64 = 843_314_857;
const TURNS: i32 = 1_367_130_551;

impl Fixed {
    /// The largest value in range: the tick's products and sums of such values do not saturate.
    pub const RANGE: f64 = 2.0;
    /// One unit.
    pub const UNIT: f64 = 1.0 / (1u32 << FRACTION) as f64;
    /// A value this close to a rail counts as saturated: saturation leaves the lowest bits as they are.
    const MARGIN: i32 = 8;
}

/// The nearest whole number, halves away from zero: for conversions, of values below 2^63.
fn nearest(x: f64) -> f64 {
    let half = if x < 0.0 { -0.5 } else { 0.5 };
    // Beyond 2^52 every value is whole.
    if x.abs() < 4_503_599_627_370_496.0 {
        ((x + half) as i64) as f64
    } else {
        x
    }
}

impl Add for Fixed {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Fixed {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Mul for Fixed {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(saturated::<FRACTION>(signed(self.0, other.0)))
    }
}

impl Neg for Fixed {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // The lower rail has no opposite; it stays a rail.
        Self(self.0.wrapping_neg())
    }
}

impl AddAssign for Fixed {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Fixed {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Fixed {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Add for Sum {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl Sub for Sum {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl Neg for Sum {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

impl Arithmetic for Fixed {
    type Angle = Turns;
    const PROPAGATES_NON_FINITE: bool = false;
    const ZERO: Self = Self(0);
    const ONE: Self = Self(1 << FRACTION);
    const HALF: Self = Self(1 << (FRACTION - 1));
    // An operation rounds by half a unit.
    const UNIT_ROUNDOFF: Self = Self(1);

    /// A rail for values beyond the range and for values that are not numbers.
    fn from_f64(x: f64) -> Self {
        if x.is_nan() {
            return Self(i32::MIN);
        }
        // The conversion saturates.
        Self(nearest(x * f64::from(1u32 << FRACTION)) as i32)
    }

    fn to_f64(self) -> f64 {
        f64::from(self.0) * Self::UNIT
    }

    fn angle_from_f64(radians: f64) -> Turns {
        Turns::from_radians(radians)
    }

    fn angle_to_f64(angle: Turns) -> f64 {
        angle.to_radians()
    }

    #[inline(always)]
    fn half_turn() -> Turns {
        Turns(1 << 31)
    }

    #[inline(always)]
    fn angle(radians: Self) -> Turns {
        let wide = signed(radians.0, TURNS);
        Turns(wide.wrapping_add(1 << 29) >> 30)
    }

    #[inline(always)]
    fn radians(angle: Turns) -> Self {
        // Beyond a turn it saturates in any case.
        let turns = angle.0.clamp(-(1 << 32), 1 << 32);
        let raw = (turns * RADIANS + (1 << 29)) >> 30;
        Self(raw.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
    }

    /// Every angle is one: radians would saturate at 4.
    #[inline(always)]
    fn angle_is_finite(_: Turns) -> bool {
        true
    }

    #[inline(always)]
    fn without_turns(angle: Turns, of: Turns) -> Turns {
        // To the nearest turn, so that what is within half a turn stays as it is.
        let whole = of.0.wrapping_add(1 << 31) & !0xffff_ffff;
        Turns(angle.0.saturating_sub(whole))
    }

    fn ratio(numerator: u32, denominator: u32) -> Self {
        Self::ONE.scaled(Self::quotient(numerator, denominator))
    }

    #[inline(always)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::round(Self::sum_ab_plus_cd(a, b, c, d))
    }

    #[inline(always)]
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::round(Self::sum_ab_minus_cd(a, b, c, d))
    }

    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        if divisor.0 == 0 {
            return Self(i32::MAX);
        }
        self.scaled(divisor.reciprocal())
    }

    fn sqrt(self) -> Self {
        match u64::try_from(self.0) {
            Ok(raw) => Self(root::integer_root(raw << FRACTION) as i32),
            Err(_) => Self(i32::MIN),
        }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.wrapping_abs())
    }

    #[inline(always)]
    fn sin_cos(angle: Turns) -> (Self, Self) {
        let (sin, cos) = sin_cos::sin_cos(angle.0 as u32);
        (Self(sin), Self(cos))
    }

    fn atan2(y: Self, x: Self) -> Turns {
        let square = |raw: i32| u64::from(raw.unsigned_abs()) * u64::from(raw.unsigned_abs());
        let length_sq = square(x.0) + square(y.0);
        if length_sq == 0 {
            return Turns(0);
        }
        // The length shifted to [2^29, 2^30): its square then has 4 or 5 leading zeros.
        let (z, zeros) = normalised(length_sq);
        let (z, zeros) = (z >> (zeros & 1), zeros & !1);
        let inverse = root::inverse_root(z);
        let place = |raw: i32| match zeros >> 1 {
            0 => raw >> 2,
            1 => raw >> 1,
            up => raw << (up - 2),
        };
        let inverse = Inverse::new(inverse);
        Turns(direction::direction(place(x.0), place(y.0), inverse))
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0 > i32::MIN + Self::MARGIN && self.0 < i32::MAX - Self::MARGIN
    }

    /// `true` if all are below 2 in size.
    #[inline(always)]
    fn in_range<const COUNT: usize>(values: [Self; COUNT]) -> bool {
        // A value is in range if its two highest bits are the same.
        let beyond = values
            .iter()
            .fold(0, |beyond, value| beyond | (value.0 ^ (value.0 << 1)));
        beyond >= 0
    }
}

impl WideArithmetic for Fixed {
    type Sum = Sum;
    type Factor = Factor;
    type Count = Count;
    type Length = Length;

    fn count(ticks: u32) -> Count {
        Count::new(ticks)
    }

    #[inline(always)]
    fn fraction(numerator: u32, count: &Count) -> Self {
        Self(count.fraction(numerator))
    }

    fn factor_from_f64(x: f64) -> Factor {
        Factor::from_f64(x)
    }

    fn factor_to_f64(factor: Factor) -> f64 {
        factor.to_f64()
    }

    fn quotient(numerator: u32, denominator: u32) -> Factor {
        Self::factor_over(Factor::of_count(numerator), Factor::of_count(denominator))
    }

    fn factor_over(f: Factor, g: Factor) -> Factor {
        f * g.inverse()
    }

    #[inline(always)]
    fn reciprocal(self) -> Factor {
        Factor::reciprocal_of(self.0)
    }

    #[inline(always)]
    fn scaled(self, f: Factor) -> Self {
        Self(f.times(self.widen().0))
    }

    #[inline(always)]
    fn scaled_twice(self, f: Factor, g: Factor) -> Self {
        self.scaled(f * g)
    }

    fn sum_from_f64(x: f64) -> Sum {
        // The conversion saturates.
        Sum(nearest(x * (f64::from(1u32 << FRACTION) * f64::from(1u32 << FRACTION))) as i64)
    }

    #[inline(always)]
    fn widen(self) -> Sum {
        Sum(i64::from(self.0) << FRACTION)
    }

    #[inline(always)]
    fn product(a: Self, b: Self) -> Sum {
        Sum(signed(a.0, b.0))
    }

    #[inline(always)]
    fn sum_ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Sum {
        Sum(signed(a.0, b.0).wrapping_add(signed(c.0, d.0)))
    }

    #[inline(always)]
    fn sum_ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Sum {
        Sum(signed(a.0, b.0).wrapping_sub(signed(c.0, d.0)))
    }

    #[inline(always)]
    fn round(sum: Sum) -> Self {
        Self(saturated::<FRACTION>(sum.0))
    }

    #[inline(always)]
    fn round_scaled(sum: Sum, f: Factor) -> Self {
        Self(f.times(sum.0))
    }

    #[inline(always)]
    fn round_scaled_pair(sums: [Sum; 2], f: Factor) -> [Self; 2] {
        f.times_pair(sums.map(|sum| sum.0)).map(Self)
    }

    fn length_from_f64(x: f64) -> Length {
        let value = Self::from_f64(x);
        // Scaled as a float, so that the reciprocal is one of the length and not of its rounding.
        let shift = value.0.unsigned_abs().leading_zeros().clamp(2, 31) - 2;
        let place = x * f64::from(1u32 << FRACTION) * f64::from(1u32 << shift);
        let inverse = Inverse::new(nearest((1u64 << 60) as f64 / place) as i32);
        Length {
            value,
            shift,
            inverse,
        }
    }

    #[inline(always)]
    fn length(length: &Length) -> Self {
        length.value
    }

    #[inline(always)]
    fn direction(x: Self, y: Self, length: &Length) -> Turns {
        let shift = length.shift & 31;
        Turns(direction::direction(
            x.0 << shift,
            y.0 << shift,
            length.inverse,
        ))
    }
}

#[cfg(test)]
mod tests;
