//! A counter that the emulator advances with every instruction.
//!
//! | core | counter | unit |
//! |---|---|---|
//! | Cortex-M | SysTick at the core clock, under `-icount shift=8` (256 ns per instruction) | 256 ns times the core clock: 6.4 (25 MHz) or 4.096 (16 MHz) per instruction |
//! | RISC-V | `minstret` | instructions |

use core::fmt::Display;
use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use semihosting::{println, process};

#[cfg(target_arch = "arm")]
mod implementation {
    use cortex_m::peripheral::{SYST, syst::SystClkSource};

    /// SysTick counts down through 24 bits.
    const MODULUS: u32 = 1 << 24;

    /// Starts the counter.
    pub(crate) fn start() {
        let Some(peripherals) = cortex_m::Peripherals::take() else {
            panic!("the program starts once")
        };
        let mut systick = peripherals.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(MODULUS - 1);
        systick.clear_current();
        systick.enable_counter();
    }

    /// The counter's value.
    #[inline(always)]
    pub(crate) fn now() -> u32 {
        SYST::get_current()
    }

    /// From one value to a later one, less than 2^24 away.
    pub(crate) fn elapsed(before: u32, after: u32) -> u32 {
        before.wrapping_sub(after) % MODULUS
    }
}

#[cfg(target_arch = "riscv32")]
#[allow(unsafe_code)]
mod implementation {
    /// Nothing to do: it counts from reset on.
    pub(crate) fn start() {}

    /// The counter's low half.
    #[inline(always)]
    pub(crate) fn now() -> u32 {
        let count: u32;
        // SAFETY: reads a counter, touches neither memory nor stack.
        unsafe { core::arch::asm!("csrr {}, minstret", out(reg) count, options(nomem, nostack)) };
        count
    }

    /// From one value to a later one, less than 2^32 away.
    pub(crate) fn elapsed(before: u32, after: u32) -> u32 {
        after.wrapping_sub(before)
    }
}

pub(crate) use implementation::*;

/// Calls that were announced.
static CALLS: AtomicU32 = AtomicU32::new(0);

/// The next call that a debugger wants to follow. Without a debugger nothing changes it.
static NEXT: AtomicU32 = AtomicU32::new(0);

/// Announces a call, before it is counted: `cargo xtask cycles` follows some of them.
pub(crate) fn announce() {
    let call = CALLS.load(Relaxed);
    CALLS.store(call.wrapping_add(1), Relaxed);
    if call == NEXT.load(Relaxed) {
        stop(black_box(&NEXT));
    }
}

/// A debugger stops here, at the call that it wants, and writes to `next` which one it wants next.
#[inline(never)]
extern "C" fn stop(next: &AtomicU32) {
    black_box(next);
}

/// Ends the program with its error.
pub(crate) fn fail(error: impl Display) -> ! {
    println!("error: {error}");
    process::exit(1)
}
