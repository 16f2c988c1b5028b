//! Flash of an STM32F405: one bank, which stands while a sector of it is erased.

use cortex_m::peripheral::{SCB, SYST};
pub(super) use trirrr_boot::stm32f405::ChipFlash;
use trirrr_boot::{Flash, FlashError, Layout, watchdog};

pub(crate) const LAYOUT: Layout = Layout::STM32F405;

/// Takes up to 2 s (DS8626, table 40). The watchdog has a longer period for this time, and no tick counts as late: the drives
/// are off.
pub(super) fn erase(flash: &mut ChipFlash, sector: u8) -> Result<(), FlashError> {
    cortex_m::interrupt::free(|_| {
        let period = watchdog::set(watchdog::Period::LONGEST);
        let result = flash.erase(sector);
        watchdog::set(period);
        // SAFETY: a register that the tick's handler only reads, and no handler runs now. The count starts anew: the next tick is
        // due in a whole period.
        unsafe { (*SYST::PTR).cvr.write(0) };
        SCB::clear_pendst();
        result
    })
}

/// No: this flash tells nothing of lost content.
pub fn is_lost_expected() -> bool {
    false
}
