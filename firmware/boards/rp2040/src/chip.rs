//! Registers that are written after a failure, from wherever the program has come to its end, and the second
//! stage of the start.
#![allow(unsafe_code)]

use core::ops::Range;
use rp2040_hal::pac::{PSM, RESETS, WATCHDOG};
use trirrr_app::failure::Chip;

trirrr_app::failure_handlers!(Rp2040);

/// Second stage, which the boot ROM starts: flash with the commands of a W25Q, as on most boards.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

// What runs from flash beside cortex-m-rt's Reset. Before the copy to RAM there is nothing to do; cortex-m-rt's own function for that lies
// where the copy goes to. The branch of Reset to `main` does not reach from flash to RAM: `rp2040.x` and the linker's --wrap lead it here.
core::arch::global_asm!(
    ".section .Reset, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init: bx lr",
    ".size __pre_init, . - __pre_init",
    ".global __wrap_main",
    ".type __wrap_main, %function",
    ".thumb_func",
    "__wrap_main: ldr r0, =__real_main",
    "bx r0",
    ".pool",
    ".size __wrap_main, . - __wrap_main",
);

/// The microcontroller.
struct Rp2040;

impl Chip for Rp2040 {
    /// As in `rp2040.x`.
    const RAM: Range<usize> = 0x2000_0000..0x2004_0000;

    /// Resets the ports. Every pin becomes an input, pulled down, as in a reset; the wiring has to take that for
    /// off (`docs/board.md`).
    fn outputs_off() {
        // SAFETY: only called when nothing else runs any more, right before the reset.
        let resets = unsafe { RESETS::steal() };
        resets
            .reset()
            .modify(|_, w| w.io_bank0().set_bit().pads_bank0().set_bit());
    }

    /// Starts the board anew by the watchdog: the processor's own reset would leave clocks and peripherals as
    /// they are.
    fn reset() -> ! {
        // SAFETY: only called when nothing else runs any more.
        let (psm, watchdog) = unsafe { (PSM::steal(), WATCHDOG::steal()) };
        psm.wdsel().write(|w| {
            // SAFETY: every bit is a part of the chip that may be reset; the oscillators run on.
            unsafe { w.bits(0x0001_ffff) };
            w.rosc().clear_bit().xosc().clear_bit()
        });
        watchdog.ctrl().write(|w| w.trigger().set_bit());
        loop {
            cortex_m::asm::nop();
        }
    }

    /// Nothing: a Cortex-M0+ has no fault status.
    fn fault_status() -> (u32, u32) {
        (0, 0)
    }
}
