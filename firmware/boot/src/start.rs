//! Start of a boot loader, the same on all chips.
#![allow(unsafe_code)]

use crate::{Flash, Layout, Started, boot, is_blank, watchdog};
use cortex_m::peripheral::SCB;

/// Carries out what is left of an update, and starts the program.
///
/// # Safety
/// No interrupt is on, and the processor is as after a reset. `layout` is that of the chip with this `flash`.
pub unsafe fn start<F: Flash>(mut flash: F, layout: &Layout) -> ! {
    let started = boot(&mut flash, layout);
    if is_blank(&flash, &layout.program) {
        // Flashed alone: the probe puts a program here.
        loop {
            cortex_m::asm::nop();
        }
    }
    match started {
        Ok(Started::Known) => {}
        // A program that hangs before it starts the watchdog itself would never end.
        Ok(Started::OnTrial) => watchdog::start(watchdog::Period::TRIAL),
        Err(_) => SCB::sys_reset(),
    }
    let vectors = layout.program.start as *const u32;
    // SAFETY: the slot begins with the vectors of a program; the rest is the caller's.
    unsafe {
        (*SCB::PTR).vtor.write(layout.program.start);
        cortex_m::asm::bootload(vectors)
    }
}
