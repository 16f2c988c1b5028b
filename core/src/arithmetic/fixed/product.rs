//! Products of 32 by 32 bits with 64 bits of result, and how they become 32 bits again.
//!
//! | core | one product |
//! |---|---|
//! | with a long multiplication (Cortex-M3 and up, RISC-V with M) | `smull`, `umull`; `mulh` and `mul` |
//! | Cortex-M0 | four products of 16 by 16 bits |

/// a b.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub(crate) fn signed(a: i32, b: i32) -> i64 {
    i64::from(a) * i64::from(b)
}

/// a b.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub(crate) fn unsigned(a: u32, b: u32) -> u64 {
    u64::from(a) * u64::from(b)
}

/// a `short`, which is below 2^16.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub(super) fn signed_by_short(a: i32, short: u32) -> i64 {
    signed(a, opaque(short as i32))
}

/// a `short`, which is below 2^16.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub(super) fn unsigned_by_short(a: u32, short: u32) -> u64 {
    unsigned(a, short)
}

#[cfg(all(target_arch = "arm", not(target_has_atomic = "32")))]
pub(crate) use halves::{leading_zeros, signed, signed_by_short, unsigned, unsigned_by_short};

/// The square of a / 2^16, rounded down before and after.
#[inline(always)]
pub(super) fn square_of_high(a: i32) -> i32 {
    (a >> 16) * (a >> 16)
}

/// Products from those of 16 by 16 bits, for cores whose multiplication gives 32 bits.
#[cfg(any(test, all(target_arch = "arm", not(target_has_atomic = "32"))))]
mod halves {
    /// a b.
    #[inline(never)]
    pub(crate) fn signed(a: i32, b: i32) -> i64 {
        let (a_high, a_low) = (a >> 16, a & 0xffff);
        let (b_high, b_low) = (b >> 16, b & 0xffff);
        let outer = words(a_high * b_high, (a_low as u32).wrapping_mul(b_low as u32));
        // A product of a signed and an unsigned half fits.
        let middle = |half: i32| words(half >> 16, (half as u32) << 16);
        let first = outer.wrapping_add(middle(a_high * b_low));
        first.wrapping_add(middle(super::opaque(b_high) * a_low))
    }

    /// a b.
    #[inline(never)]
    pub(crate) fn unsigned(a: u32, b: u32) -> u64 {
        let (a_high, a_low) = (a >> 16, a & 0xffff);
        let (b_high, b_low) = (b >> 16, b & 0xffff);
        let outer = words((a_high * b_high) as i32, a_low * b_low);
        let middle = |half: u32| words((half >> 16) as i32, half << 16);
        let wide = outer
            .wrapping_add(middle(a_high * b_low))
            .wrapping_add(middle(b_high * a_low));
        wide as u64
    }

    /// a `short`, which is below 2^16.
    #[inline(always)]
    pub(crate) fn signed_by_short(a: i32, short: u32) -> i64 {
        let high = (a >> 16).wrapping_mul(short as i32);
        words(high >> 16, (high as u32) << 16)
            .wrapping_add(i64::from((a as u32 & 0xffff).wrapping_mul(short)))
    }

    /// a `short`, which is below 2^16.
    #[inline(always)]
    pub(crate) fn unsigned_by_short(a: u32, short: u32) -> u64 {
        let high = (a >> 16).wrapping_mul(short);
        (u64::from(high) << 16).wrapping_add(u64::from((a & 0xffff).wrapping_mul(short)))
    }

    /// Zeros in front of `value`, which is not zero; the core has no instruction for it.
    #[inline(never)]
    pub(crate) fn leading_zeros(value: u32) -> u32 {
        static OF_HALF_BYTE: [u8; 16] = [4, 3, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0];
        // Written out: in a loop the steps themselves would be a table.
        let (value, zeros) = if value >> 16 == 0 {
            (value << 16, 16)
        } else {
            (value, 0)
        };
        let (value, zeros) = if value >> 24 == 0 {
            (value << 8, zeros + 8)
        } else {
            (value, zeros)
        };
        let (value, zeros) = if value >> 28 == 0 {
            (value << 4, zeros + 4)
        } else {
            (value, zeros)
        };
        zeros + u32::from(OF_HALF_BYTE[(value >> 28) as usize])
    }

    #[inline(always)]
    fn words(high: i32, low: u32) -> i64 {
        (i64::from(high) << 32) | i64::from(low)
    }

    #[cfg(test)]
    #[test]
    fn parts_give_the_whole() {
        let mut state = 1u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let any = (state >> 32) as u32;
            // Corners as often as anything else.
            match any & 15 {
                0 => 0x8000_0000,
                1 => 0xffff_ffff,
                2 => 0x7fff_ffff,
                3 => 0x8000_ffff,
                4 => 0xffff,
                5 => 0xffff_0000,
                _ => any,
            }
        };
        for _ in 0..1_000_000 {
            let (a, b) = (next(), next());
            assert_eq!(unsigned(a, b), u64::from(a) * u64::from(b));
            let short = b & 0xffff;
            assert_eq!(unsigned_by_short(a, short), u64::from(a) * u64::from(short));
            assert_eq!(
                signed_by_short(a as i32, short),
                i64::from(a as i32) * i64::from(short)
            );
            let some = a >> (b & 31) | 1;
            assert_eq!(leading_zeros(some), some.leading_zeros());
            let (a, b) = (a as i32, b as i32);
            assert_eq!(signed(a, b), i64::from(a) * i64::from(b), "{a} {b}");
        }
    }
}

/// a b / 2^32, rounded down.
#[inline(always)]
pub(crate) fn signed_high(a: i32, b: i32) -> i32 {
    (signed(a, b) >> 32) as i32
}

/// `wide` / 2^`BITS`, rounded to nearest, for values that are known to fit; `BITS` is 1 to 31.
#[inline(always)]
pub(crate) fn rounded<const BITS: u32>(wide: i64) -> i32 {
    carried::<BITS>((wide >> 32) as i32, wide as u32)
}

/// `wide` / 2^`BITS`, rounded to nearest and kept within the format; `BITS` is 3 to 31. Beyond
/// its range the result is one that is not finite.
#[inline(always)]
pub(super) fn saturated<const BITS: u32>(wide: i64) -> i32 {
    // The high word alone tells whether it fits, and saturating it is one instruction where there
    // is one, but not of what the compiler knows to be positive. The low bits go on below, so that
    // the result is a rail but for its last few units.
    let limit = 1 << (BITS - 1);
    let high = opaque((wide >> 32) as i32).clamp(-limit, limit - 1);
    carried::<BITS>(high, wide as u32)
}

/// (high, low) / 2^`BITS`, rounded by the bit that is shifted out last.
#[cfg(not(all(target_arch = "arm", target_has_atomic = "32")))]
#[inline(always)]
fn carried<const BITS: u32>(high: i32, low: u32) -> i32 {
    let carry = (low >> (BITS - 1)) & 1;
    ((high << (32 - BITS)) | (low >> BITS) as i32).wrapping_add(carry as i32)
}

/// The same in two instructions, for the cores that have them: ARMv7-M and up, which atomics tell
/// from ARMv6-M. A shift leaves in the carry what it shifts out last.
#[cfg(all(target_arch = "arm", target_has_atomic = "32"))]
#[allow(unsafe_code)]
#[inline(always)]
fn carried<const BITS: u32>(high: i32, low: u32) -> i32 {
    let mut low = low;
    // SAFETY: reads and writes the named registers and the flags only.
    unsafe {
        core::arch::asm!(
            "lsrs {low}, {low}, #{bits}",
            "adc {low}, {low}, {high}, lsl #{rest}",
            low = inout(reg) low,
            high = in(reg) high,
            bits = const BITS,
            rest = const 32 - BITS,
            options(pure, nomem, nostack),
        );
    }
    low as i32
}

/// `value`, of which the compiler forgets what it knows. A factor that it knows to be positive it
/// takes for unsigned, and a product of a signed and an unsigned one costs three multiplications.
#[inline(always)]
#[allow(unsafe_code)]
pub(crate) fn opaque(value: i32) -> i32 {
    #[cfg(target_arch = "arm")]
    {
        let mut value = value;
        // SAFETY: does nothing.
        unsafe {
            core::arch::asm!("/* {0} */", inout(reg) value, options(pure, nomem, nostack, preserves_flags))
        };
        value
    }
    #[cfg(not(target_arch = "arm"))]
    value
}

/// `value`, at most 2^31 as an unsigned number, for which the sign bit has no room: that one becomes
/// 2^31 - 1.
#[inline(always)]
pub(super) fn within_sign(value: i32) -> i32 {
    value.wrapping_sub((value as u32 >> 31) as i32)
}

/// Zeros in front of `value`, which is not zero.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub(super) fn leading_zeros(value: u32) -> u32 {
    value.leading_zeros()
}

/// The top 32 bits of `wide`, which is not zero, shifted left until its highest bit is set; and
/// the shift.
#[inline(always)]
pub(crate) fn normalised(wide: u64) -> (u32, u32) {
    let low = wide as u32;
    if wide >> 32 != 0 {
        normalised_high(wide)
    } else {
        let shift = leading_zeros(low);
        (low.wrapping_shl(shift), 32 + shift)
    }
}

/// [`normalised`] for a high word that is not zero.
#[inline(always)]
pub(crate) fn normalised_high(wide: u64) -> (u32, u32) {
    let (high, low) = ((wide >> 32) as u32, wide as u32);
    let shift = leading_zeros(high) & 31;
    (joined(high, low, shift), shift)
}

/// The high word of (high, low) shifted left by `shift`, 0 to 31.
#[inline(always)]
pub(crate) fn joined(high: u32, low: u32, shift: u32) -> u32 {
    let shift = shift & 31;
    (high << shift) | (low >> 1 >> (shift ^ 31))
}
