//! Square roots by the machine's own instruction, which IEEE 754 requires to be correctly
//! rounded. Machines without one get the software root under the same name.

#[cfg(target_arch = "x86_64")]
pub(in crate::arithmetic) use x86_64::{sqrt_f32, sqrt_f64};

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
pub(in crate::arithmetic) use {super::software::sqrt_f64, arm::sqrt_f32};

#[cfg(not(any(
    target_arch = "x86_64",
    all(target_arch = "arm", target_abi = "eabihf")
)))]
pub(in crate::arithmetic) use super::software::{sqrt_f32, sqrt_f64};

/// SSE2 is part of every x86-64.
#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use core::arch::x86_64::{
        _mm_cvtsd_f64, _mm_cvtss_f32, _mm_set_sd, _mm_set_ss, _mm_setzero_pd, _mm_sqrt_sd,
        _mm_sqrt_ss,
    };

    #[inline(always)]
    #[allow(unused_unsafe, unsafe_code)]
    pub(in crate::arithmetic) fn sqrt_f32(x: f32) -> f32 {
        // SAFETY: the instructions are in the baseline of the architecture.
        unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))) }
    }

    #[inline(always)]
    #[allow(unused_unsafe, unsafe_code)]
    pub(in crate::arithmetic) fn sqrt_f64(x: f64) -> f64 {
        // SAFETY: as above.
        unsafe { _mm_cvtsd_f64(_mm_sqrt_sd(_mm_setzero_pd(), _mm_set_sd(x))) }
    }
}

/// The hard-float ABI promises a single-precision FPU.
///
/// Stable Rust has no name for its square root on this target: `core` has no `sqrt`, and `asm!`
/// takes no FPU register as an operand, which costs four moves. So the root is defined here once
/// under its C name, which the code generator knows: where it sees this definition (within the
/// crate, and across crates with fat link-time optimisation) it replaces the call by the single
/// instruction `vsqrt.f32`; where it does not, it calls the function. The result is the same.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod arm {
    use core::arch::asm;

    #[inline(always)]
    pub(in crate::arithmetic) fn sqrt_f32(x: f32) -> f32 {
        sqrtf(x)
    }

    /// C's `sqrtf`, without `errno`.
    // SAFETY of the name: it is what C promises of `sqrtf`, so a caller that means C's own is
    // served as well; the one in compiler_builtins is weak and gives way.
    #[allow(unsafe_code)]
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn sqrtf(x: f32) -> f32 {
        let mut bits = x.to_bits();
        // SAFETY: reads and writes the named registers only. `pure` is what lets the code
        // generator treat the function as a square root and nothing else.
        unsafe {
            asm!(
                "vmov s15, {0}",
                "vsqrt.f32 s15, s15",
                "vmov {0}, s15",
                inout(reg) bits,
                out("s15") _,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        f32::from_bits(bits)
    }
}
