//! Registers that are written from anywhere, because the program is at its end, and what the boot ROM
//! starts.
#![allow(unsafe_code)]

use core::ops::Range;
use rp2040_hal::pac::{PSM, RESETS, WATCHDOG};

/// The RAM of `memory.x`.
pub(crate) const RAM: Range<usize> = 0x2000_0000..0x2004_0000;

/// The second stage: flash with the commands of a W25Q, which most boards have.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// Resets the ports: every pin is an input, pulled down, as in a reset, and what is wired to them has
/// to take that for off (`docs/board.md`).
pub(crate) fn outputs_off() {
    // SAFETY: only called when nothing else runs any more, right before the reset.
    let resets = unsafe { RESETS::steal() };
    resets
        .reset()
        .modify(|_, w| w.io_bank0().set_bit().pads_bank0().set_bit());
}

/// Starts the board anew, by way of the watchdog: the processor's own reset would leave clocks and
/// peripherals as they are.
pub(crate) fn reset() -> ! {
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

/// A Cortex-M0+ says nothing of a fault.
pub(crate) fn fault_status() -> (u32, u32) {
    (0, 0)
}
