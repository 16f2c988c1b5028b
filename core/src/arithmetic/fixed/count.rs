//! Fractions of a count of ticks.

use super::product::unsigned;
use crate::to_source;

/// A count of ticks and its reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// 2^(31 + n) / ticks rounded down, n the number of its binary digits.
    inverse: u32,
    /// n + 2.
    shift: u32,
}

to_source!([] Count [] in trirrr_core::number::fixed { inverse: u32, shift: u32 });

impl Count {
    /// Of zero ticks every fraction is 1.
    pub(super) fn new(ticks: u32) -> Self {
        let digits = 32 - ticks.leading_zeros();
        if digits == 0 {
            return Self {
                inverse: 0,
                shift: 2,
            };
        }
        // Long division, bit by bit: it runs once per move, and brings no 64-bit division in.
        let (mut left, mut inverse) = (1u64 << (digits - 1), 0u64);
        for _ in 0..33 {
            inverse <<= 1;
            if left >= u64::from(ticks) {
                left -= u64::from(ticks);
                inverse |= 1;
            }
            left <<= 1;
        }
        Self {
            // A power of two has one more.
            inverse: u32::try_from(inverse).unwrap_or(u32::MAX),
            shift: digits + 2,
        }
    }

    /// `numerator` / ticks in 2^-29, exact at both ends. The inverse is too small by less than one
    /// unit, which is 1/4 of a unit of the result at most: the error is below 3/4.
    #[inline(always)]
    pub(super) fn fraction(&self, numerator: u32) -> i32 {
        let half = 1u64 << (self.shift - 1);
        let wide = unsigned(numerator, self.inverse).saturating_add(half);
        (wide >> self.shift) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against division of integers: every fraction of small counts, and fractions all over the
    /// large ones.
    #[test]
    fn is_within_three_quarters_of_a_unit_and_exact_at_the_ends() {
        let mut worst = 0u128;
        let mut check = |numerator: u32, ticks: u32| {
            let found = Count::new(ticks).fraction(numerator) as u128;
            // In 2^-16 of a unit.
            let exact = (u128::from(numerator) << 45) / u128::from(ticks);
            worst = worst.max((found << 16).abs_diff(exact));
        };
        for ticks in 1..700 {
            for numerator in 0..=ticks {
                check(numerator, ticks);
            }
        }
        for bits in 9..=32 {
            for near in -3..=3i64 {
                let ticks = u32::try_from(((1i64 << bits) + near).min(i64::from(u32::MAX)));
                let ticks = ticks.expect("a count");
                for part in 0..=1000u64 {
                    check((u64::from(ticks) * part / 1000) as u32, ticks);
                }
                assert_eq!(Count::new(ticks).fraction(0), 0);
                assert_eq!(Count::new(ticks).fraction(ticks), 1 << 29);
            }
        }
        let worst = worst as f64 / 65536.0;
        std::println!("fraction: {worst} units");
        assert!((0.6..=0.75001).contains(&worst), "{worst}");
    }
}
