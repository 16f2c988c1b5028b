//! Numbers of about 44 bits from two binary32 words, for machines whose floats have one.
//!
//! u = 2^-24 is the unit roundoff of binary32. Every bound is relative to the result, to first order
//! in u^2. Underflow and overflow are left out; what overflows is not finite. Nothing but binary32
//! operations and bit masks is used, so the bits are the same on every machine.
//!
//! Sources: Dekker 1971; Knuth, TAOCP 2, 4.2.2; Joldes, Muller, Popescu, "Tight and rigorous error bounds
//! for basic building blocks of double-word arithmetic", ACM TOMS 44 (2), 2017.

use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use trirrr_core::number::{Arithmetic, RoundsEachStep};
use trirrr_core::to_source;

/// high + low, where high is the binary32 number nearest to the sum.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[repr(C)]
pub struct TwoWord {
    high: f32,
    low: f32,
}

to_source!([] TwoWord [] in trirrr_service::admission { high: f32, low: f32 });

/// a + b exactly, in 6 operations (Knuth).
#[inline(always)]
fn two_sum(a: f32, b: f32) -> TwoWord {
    let high = a + b;
    let b_part = high - a;
    TwoWord {
        high,
        low: (a - (high - b_part)) + (b - b_part),
    }
}

/// a + b exactly where a is 0 or its exponent is not below that of b (Dekker).
#[inline(always)]
fn fast_two_sum(a: f32, b: f32) -> TwoWord {
    let high = a + b;
    TwoWord {
        high,
        low: b - (high - a),
    }
}

/// `x` in two parts of at most 12 bits, of one sign.
#[inline(always)]
fn split(x: f32) -> [f32; 2] {
    let high = f32::from_bits(x.to_bits() & 0xffff_f000);
    [high, x - high]
}

/// a b exactly, after Dekker. Stable Rust has no fused multiply-add without the standard library.
///
/// Let a and b be integers of 24 bits, so that the high parts are multiples of 2^12, the low parts
/// below 2^12, and the product is rounded by at most 2^23. The first difference is a multiple of
/// 2^23 below 2^38. The second is a multiple of 2^12 below
/// (2^24 - 2^12) (2^12 - 1) + (2^12 - 1)^2 + 2^23 < 2^36, the third one below 2^25, the last an
/// integer of at most 2^23. Each has at most 24 bits: nothing is rounded.
#[inline(always)]
fn two_product(a: f32, b: f32) -> TwoWord {
    let high = a * b;
    let ([a_high, a_low], [b_high, b_low]) = (split(a), split(b));
    let rest = ((high - a_high * b_high) - a_low * b_high) - a_high * b_low;
    TwoWord {
        high,
        low: a_low * b_low - rest,
    }
}

impl TwoWord {
    /// `high`, exactly.
    pub(super) const fn new(high: f32) -> Self {
        Self { high, low: 0.0 }
    }

    /// The second word.
    #[inline(always)]
    pub(super) fn low(self) -> f32 {
        self.low
    }

    /// The nearest binary32 number.
    #[inline(always)]
    pub(super) fn nearest(self) -> f32 {
        self.high
    }

    /// Sine within 32 u^2, for an angle that is off by at most 10 u^2 of itself: up to pi/2 by nothing. Angles of
    /// 2^16 half turns and more have no sine here.
    ///
    /// The series is 1 - x / (2 3) (1 - x / (4 5) (1 - ...)) for the square x of the rest r, with products of
    /// integers that are exact. A quotient within 16 u^2, a product within 5 u^2 and a sum within 3 u^2, of an x
    /// within 5 u^2, make the error in u^2 at most 3 + (26 + that of the last step) x / (k (k - 1)): 17 for k = 3,
    /// of a sum of at least 2 / pi. What is left out is below 2^-58.
    #[inline(never)]
    fn sin(self) -> Self {
        const PI: TwoWord = TwoWord {
            high: core::f32::consts::PI,
            low: -8.742_278e-8,
        };
        // Added to a number below 2^22, rounds it to an integer, which then stands in the low bits.
        const ROUND: f32 = 12_582_912.0;
        let half_turns = self.high * core::f32::consts::FRAC_1_PI;
        let rounded = half_turns + ROUND;
        // pi is within u^2 / 8, the product within 5 u^2, and the difference within 3 u^2 of itself.
        let mut rest = self - PI * Self::new(rounded - ROUND);
        if !(half_turns.abs() < 65_536.0) {
            rest.high = f32::NAN;
        }
        let square = rest * rest;
        let mut sum = Self::ONE;
        let mut k = 21.0;
        while k > 1.0 {
            sum = Self::ONE - square.div(Self::new(k * (k - 1.0))) * sum;
            k -= 2.0;
        }
        let sin = rest * sum;
        if rounded.to_bits() & 1 == 0 {
            sin
        } else {
            -sin
        }
    }
}

impl Add for TwoWord {
    type Output = Self;

    /// Within 3 u^2 whatever the signs (`AccurateDWPlusDW`).
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let carried = fast_two_sum(high.high, high.low + low.high);
        fast_two_sum(carried.high, carried.low + low.low)
    }
}

impl Neg for TwoWord {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for TwoWord {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for TwoWord {
    type Output = Self;

    /// Within 5 u^2 (`DWTimesDW1`); with one-word factors, exact.
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        fast_two_sum(product.high, product.low + cross)
    }
}

impl AddAssign for TwoWord {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for TwoWord {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for TwoWord {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl RoundsEachStep for TwoWord {}

impl Arithmetic for TwoWord {
    type Angle = Self;

    const ZERO: Self = Self::new(0.0);
    const ONE: Self = Self::new(1.0);
    const HALF: Self = Self::new(0.5);
    /// Of a product; a bound of all but quotients, sines and cosines.
    const UNIT_ROUNDOFF: Self = Self::new(5.0 * f32::UNIT_ROUNDOFF * f32::UNIT_ROUNDOFF);

    /// Within u^2.
    fn from_f64(x: f64) -> Self {
        let high = x as f32;
        Self {
            high,
            low: (x - f64::from(high)) as f32,
        }
    }

    fn to_f64(self) -> f64 {
        f64::from(self.high) + f64::from(self.low)
    }

    fn angle_from_f64(radians: f64) -> Self {
        Self::from_f64(radians)
    }

    fn angle_to_f64(angle: Self) -> f64 {
        angle.to_f64()
    }

    fn half_turn() -> Self {
        Self::from_f64(core::f64::consts::PI)
    }

    #[inline(always)]
    fn angle(radians: Self) -> Self {
        radians
    }

    #[inline(always)]
    fn radians(angle: Self) -> Self {
        angle
    }

    /// Within 16 u^2 for counts below 2^32 - 2^7. Those from there on are rounded to 2^32, which no count is:
    /// theirs are off by 1.
    #[inline(never)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        let count = |count: u32| {
            let high = count as f32;
            let low = count.wrapping_sub(high as u32) as i32 as f32;
            Self { high, low }
        };
        count(numerator).div(count(denominator))
    }

    /// Within 16 u^2: the first quotient is within 3 u, the product with the divisor within 5 u^2, the
    /// remainder that is left as exact as that product, and the second quotient within 3 u of at most
    /// 3 u.
    #[inline(never)]
    fn div(self, divisor: Self) -> Self {
        let first = self.high / divisor.high;
        let rest = self - divisor * Self::new(first);
        fast_two_sum(first, rest.high / divisor.high)
    }

    /// Within 5 u^2: the square of the one-word root s is exact and within 3 u of `self`, the rest over
    /// 2 s is within 2 u of at most 3/2 u, and what Newton's step leaves is (3 u)^2 / 8.
    #[inline(never)]
    fn sqrt(self) -> Self {
        let root = Arithmetic::sqrt(self.high);
        if root == 0.0 {
            return self;
        }
        let rest = self - two_product(root, root);
        fast_two_sum(root, rest.high * (0.5 / root))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// Within 40 u^2, for an angle that is off by at most 10 u^2 of itself, below 2^16 half turns. The sum that the
    /// cosine is the sine of is within 3 u^2: up to pi/4 that changes the cosine by at most 8 u^2 of itself.
    fn sin_cos(angle: Self) -> (Self, Self) {
        const HALF_PI: TwoWord = TwoWord {
            high: core::f32::consts::FRAC_PI_2,
            low: -4.371_139e-8,
        };
        (angle.sin(), (angle + HALF_PI).sin())
    }

    /// One Newton step from the one-word angle: the sine of what that one lacks, for at most 2 u, is as
    /// good as the rest itself.
    fn atan2(y: Self, x: Self) -> Self {
        let near = Self::new(<f32 as Arithmetic>::atan2(y.high, x.high));
        let (sin, cos) = Self::sin_cos(near);
        let across = Self::ab_minus_cd(y, cos, x, sin);
        let along = Self::ab_plus_cd(x, cos, y, sin);
        if along.high > 0.0 {
            near + across.div(along)
        } else {
            near
        }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.high.is_finite() && self.low.is_finite()
    }
}

#[cfg(test)]
mod tests;
