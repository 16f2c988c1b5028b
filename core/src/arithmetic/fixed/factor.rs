//! Multipliers of any size.

use super::product::{leading_zeros, normalised, opaque, rounded, signed};
use super::reciprocal::reciprocal;
use crate::to_source;
use core::ops::{Mul, Neg};

/// `significand` 2^-30 2^(28 - `shift`), the significand of a size in [2^30, 2^31), or zero. Rounded
/// to 31 bits wherever it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Factor {
    /// 0, or in size from 2^30 up to and without 2^31.
    pub(crate) significand: i32,
    /// Right shift of a sum in 2^-58 before it is multiplied.
    pub(crate) shift: i32,
}

to_source!([] Factor [] in trirrr_core::number::fixed { significand: i32, shift: i32 });

impl Factor {
    /// Shifted so far that whatever it is multiplied with is gone, and does not saturate before.
    const ZERO: Self = Self {
        significand: 0,
        shift: 63,
    };

    /// 1 / (`raw` 2^-29). Of zero, a factor that takes everything but zero out of range.
    #[inline(always)]
    pub(super) fn reciprocal_of(raw: i32) -> Self {
        let size = raw.unsigned_abs();
        // Of zero that of the least bit there could be: it takes all but the smallest out of range.
        let zeros = leading_zeros(size | 1) & 31;
        let significand = reciprocal((size << zeros) | 1 << 31);
        Self {
            significand: if raw < 0 { -significand } else { significand },
            shift: 31 - zeros as i32,
        }
    }

    /// The count `n`, rounded to 31 bits.
    pub(super) fn of_count(n: u32) -> Self {
        if n == 0 {
            return Self::ZERO;
        }
        let zeros = n.leading_zeros();
        let significand = (n << zeros) >> 1;
        Self {
            significand: significand as i32,
            shift: zeros as i32 - 3,
        }
    }

    /// 1 / self.
    pub(super) fn inverse(self) -> Self {
        let size = self.significand.unsigned_abs();
        let (significand, shift) = if size == 0 {
            (i32::MAX, -63)
        } else if size == 1 << 30 {
            (1 << 30, 56 - self.shift)
        } else {
            (reciprocal(size << 1), 57 - self.shift)
        };
        Self {
            significand: if self.significand < 0 {
                -significand
            } else {
                significand
            },
            shift,
        }
    }

    /// The factor nearest to `x`.
    pub(super) fn from_f64(x: f64) -> Self {
        let bits = x.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32 - 1023;
        if exponent < -900 {
            return Self::ZERO;
        }
        if exponent > 900 {
            return Self {
                significand: i32::MAX,
                shift: -63,
            };
        }
        let fraction = (bits & ((1 << 52) - 1)) | (1 << 52);
        // 53 bits to 31.
        let rounded = (fraction + (1 << 21)) >> 22;
        let (significand, exponent) = match rounded >> 31 {
            0 => (rounded as i32, exponent),
            _ => (1 << 30, exponent + 1),
        };
        Self {
            significand: if x < 0.0 { -significand } else { significand },
            shift: 28 - exponent,
        }
    }

    /// The value, exactly.
    pub(super) fn to_f64(self) -> f64 {
        f64::from(self.significand) * power_of_two(-2 - self.shift)
    }

    /// `sum` in 2^-58, times self, in 2^-29; saturates.
    ///
    /// The sum is brought to 2^-30 of what the result is without the significand; where the result
    /// is below 2 that has 32 bits. Above, the result may be a rail already.
    #[inline(always)]
    pub(super) fn times(self, sum: i64) -> i32 {
        let shift = self.shift as u32;
        if shift > 31 {
            return self.times_far(sum);
        }
        let (shifted, lost) = shifted(sum, shift);
        if lost != 0 {
            return i32::MAX ^ (((sum >> 32) as i32 ^ self.significand) >> 31);
        }
        self.times_shifted(shifted)
    }

    /// A sum that is [shifted](low_quotient) already, times self: below 2 in 2^-30 and below 2, so it fits.
    #[inline(always)]
    pub(crate) fn times_shifted(self, shifted: i32) -> i32 {
        rounded::<31>(signed(shifted, self.significand))
    }

    /// [`times`](Self::times) of both.
    #[inline(always)]
    pub(super) fn times_pair(self, sums: [i64; 2]) -> [i32; 2] {
        let shift = self.shift as u32;
        let [first, second] = sums;
        if shift <= 31 {
            let (first, lost) = shifted(first, shift);
            let (second, lost_too) = shifted(second, shift);
            if lost | lost_too == 0 {
                return [self.times_shifted(first), self.times_shifted(second)];
            }
        }
        self.times_pair_far(first, second)
    }

    /// [`times_pair`](Self::times_pair) where one of them may be a rail.
    #[cold]
    #[inline(never)]
    pub(crate) fn times_pair_far(self, first: i64, second: i64) -> [i32; 2] {
        [self.times(first), self.times(second)]
    }

    /// [`times`](Self::times) for factors far from 1.
    #[cold]
    #[inline(never)]
    fn times_far(self, sum: i64) -> i32 {
        let shifted = match self.shift {
            32.. => sum >> self.shift.min(63),
            shift => sum.saturating_mul(1i64 << shift.unsigned_abs().min(62)),
        };
        match i32::try_from(shifted) {
            Ok(shifted) => rounded::<31>(signed(shifted, self.significand)),
            Err(_) if (shifted < 0) == (self.significand < 0) => i32::MAX,
            Err(_) => i32::MIN,
        }
    }
}

impl Mul for Factor {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = signed(self.significand, other.significand);
        if product == 0 {
            return Self::ZERO;
        }
        let (size, zeros) = normalised(product.unsigned_abs());
        // Both in [2^30, 2^31): the product has 2 or 3 leading zeros, or 2 and is exact.
        let size = (size >> 1) + (size & 1);
        let (size, carry) = match size >> 31 {
            0 => (size as i32, 0),
            _ => (1 << 30, 1),
        };
        Self {
            significand: if product < 0 { -size } else { size },
            shift: self.shift + other.shift - 31 + zeros as i32 - carry,
        }
    }
}

impl Neg for Factor {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            significand: -self.significand,
            ..self
        }
    }
}

/// The low word of `sum` / 2^`shift`, `shift` below 32.
#[inline(always)]
pub(crate) fn low_quotient(sum: i64, shift: u32) -> i32 {
    // A product is a shift and, with the sum, one instruction. For 0 nothing is left of it.
    let high = ((sum >> 32) as i32).wrapping_mul(opaque(2 << (shift ^ 31)));
    ((sum as u32 >> shift) as i32).wrapping_add(high)
}

/// [`low_quotient`], and 0 if it is the whole quotient.
#[inline(always)]
fn shifted(sum: i64, shift: u32) -> (i32, i32) {
    let shifted = low_quotient(sum, shift);
    // What went out at the top has to be the sign.
    (shifted, ((sum >> 32) as i32 >> shift) ^ (shifted >> 31))
}

/// 2^exponent, for exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent.clamp(-1022, 1023) + 1023) as u64) << 52)
}
