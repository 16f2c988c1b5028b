//! Start of a boot loader, the same on all chips.
#![allow(unsafe_code)]

use crate::{Flash, FlashError, Layout, Started, boot, is_blank, watchdog};
use cortex_m::peripheral::SCB;

/// Flash that feeds the watchdog in each operation: all of an update together may take longer than its longest period.
struct Watched<F>(F);

impl<F: Flash> Flash for Watched<F> {
    type Unit = F::Unit;

    fn unit(&self, address: u32) -> Option<F::Unit> {
        self.0.unit(address)
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        watchdog::feed();
        self.0.erase(sector)
    }

    fn program(&mut self, address: u32, unit: F::Unit) -> Result<(), FlashError> {
        watchdog::feed();
        self.0.program(address, unit)
    }
}

/// Carries out what is left of an update, and starts the program, if there is one that is whole.
///
/// # Safety
/// No interrupt is on, and the processor is as after a reset. `layout` is that of the chip with this `flash`.
pub unsafe fn start<F: Flash>(flash: F, layout: &Layout) -> ! {
    // An option byte may have started it with the reset: half a second, in which no sector of an STM32F405 is erased. And nothing here, nor in
    // the start of a program, hangs for good.
    watchdog::start(watchdog::Period::LONGEST);
    let mut flash = Watched(flash);
    let started = boot(&mut flash, layout);
    match started {
        // Flashed alone, or damaged: the probe puts a program here. All pins float.
        _ if is_blank(&flash, &layout.program) => stand(),
        Ok(Started::Nothing) => stand(),
        Ok(Started::Known) => {}
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

/// Waits for a probe.
fn stand() -> ! {
    loop {
        watchdog::feed();
    }
}
