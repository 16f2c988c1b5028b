//! Products of 32 by 32 bits with 64 bits of result, and how they become 32 bits again.
//!
//! | core | one product |
//! |---|---|
//! | with a long multiplication (Cortex-M3 and up, RISC-V with M) | `smull`, `umull`; `mulh` and `mul` |
//! | Cortex-M0 | four products of 16 by 16 bits |

/// a b.
#[inline(always)]
pub(super) fn signed(a: i32, b: i32) -> i64 {
    i64::from(a) * i64::from(b)
}

/// a b.
#[inline(always)]
pub(super) fn unsigned(a: u32, b: u32) -> u64 {
    u64::from(a) * u64::from(b)
}

/// a b / 2^32, rounded down.
#[inline(always)]
pub(super) fn signed_high(a: i32, b: i32) -> i32 {
    (signed(a, b) >> 32) as i32
}

/// `wide` / 2^`BITS`, rounded to nearest, for values that are known to fit; `BITS` is 1 to 31.
#[inline(always)]
pub(super) fn rounded<const BITS: u32>(wide: i64) -> i32 {
    (wide.wrapping_add(1 << (BITS - 1)) >> BITS) as i32
}

/// `wide` / 2^`BITS`, rounded to nearest and kept within the format; `BITS` is 3 to 31. Beyond
/// its range the result is one that is not finite.
#[inline(always)]
pub(super) fn saturated<const BITS: u32>(wide: i64) -> i32 {
    let wide = wide.wrapping_add(1 << (BITS - 1));
    // The high word alone tells whether it fits, and saturating it is one instruction where there
    // is one. The low bits go on below, so that the result is a rail but for its last few units.
    let limit = 1 << (BITS - 1);
    let high = ((wide >> 32) as i32).clamp(-limit, limit - 1);
    (high << (32 - BITS)) | ((wide as u32) >> BITS) as i32
}

/// The top 32 bits of `wide`, which is not zero, shifted left until its highest bit is set; and
/// the shift.
#[inline(always)]
pub(super) fn normalised(wide: u64) -> (u32, u32) {
    let (high, low) = ((wide >> 32) as u32, wide as u32);
    if high != 0 {
        let shift = high.leading_zeros() & 31;
        (joined(high, low, shift), shift)
    } else {
        let shift = low.leading_zeros();
        (low.wrapping_shl(shift), 32 + shift)
    }
}

/// The high word of (high, low) shifted left by `shift`, 0 to 31.
#[inline(always)]
pub(super) fn joined(high: u32, low: u32, shift: u32) -> u32 {
    let shift = shift & 31;
    (high << shift) | (low >> 1 >> (shift ^ 31))
}
