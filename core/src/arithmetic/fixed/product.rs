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

#[cfg(all(target_arch = "arm", not(target_has_atomic = "32")))]
pub(crate) use halves::{signed, unsigned};

/// Products from those of 16 by 16 bits, for cores whose multiplication gives 32 bits.
#[cfg(any(test, all(target_arch = "arm", not(target_has_atomic = "32"))))]
mod halves {
    /// a b.
    #[inline(never)]
    pub(crate) fn signed(a: i32, b: i32) -> i64 {
        let (a_high, a_low) = (a >> 16, a & 0xffff);
        let (b_high, b_low) = (b >> 16, b & 0xffff);
        let low = (a_low as u32).wrapping_mul(b_low as u32);
        // A product of a signed and an unsigned half is at least 65535 short of the largest
        // number: what is carried from below fits.
        let first = a_high * b_low + (low >> 16) as i32;
        let second = a_low * b_high + (first & 0xffff);
        let high = a_high * b_high + (first >> 16) + (second >> 16);
        let low = ((second as u32) << 16) | (low & 0xffff);
        (i64::from(high) << 32) | i64::from(low)
    }

    /// a b.
    #[inline(never)]
    pub(crate) fn unsigned(a: u32, b: u32) -> u64 {
        let (a_high, a_low) = (a >> 16, a & 0xffff);
        let (b_high, b_low) = (b >> 16, b & 0xffff);
        let low = a_low * b_low;
        let first = a_high * b_low + (low >> 16);
        let second = a_low * b_high + (first & 0xffff);
        let high = a_high * b_high + (first >> 16) + (second >> 16);
        let low = (second << 16) | (low & 0xffff);
        (u64::from(high) << 32) | u64::from(low)
    }

    #[cfg(test)]
    #[test]
    fn halves_give_the_whole() {
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
    // is one. The low bits go on below, so that the result is a rail but for its last few units.
    let limit = 1 << (BITS - 1);
    let high = ((wide >> 32) as i32).clamp(-limit, limit - 1);
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
    #[cfg(all(target_arch = "arm", target_has_atomic = "32"))]
    {
        let mut value = value;
        // SAFETY: does nothing.
        unsafe {
            core::arch::asm!("/* {0} */", inout(reg) value, options(pure, nomem, nostack, preserves_flags))
        };
        value
    }
    #[cfg(not(all(target_arch = "arm", target_has_atomic = "32")))]
    value
}

/// The top 32 bits of `wide`, which is not zero, shifted left until its highest bit is set; and
/// the shift.
#[inline(always)]
pub(crate) fn normalised(wide: u64) -> (u32, u32) {
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
pub(crate) fn joined(high: u32, low: u32, shift: u32) -> u32 {
    let shift = shift & 31;
    (high << shift) | (low >> 1 >> (shift ^ 31))
}
