//! Flash of an STM32G474: the program is in another bank than all that it writes, and runs on.

pub(super) use trirrr_boot::stm32g474::ChipFlash;
use trirrr_boot::{Flash, FlashError, Layout};

pub(crate) const LAYOUT: Layout = Layout::STM32G474;

/// Takes up to 25 ms (DS12288, characteristics of the flash), in which ticks go on and the background waits: less than the period of the
/// watchdog.
pub(super) fn erase(flash: &mut ChipFlash, sector: u8) -> Result<(), FlashError> {
    flash.erase(sector)
}

/// To be called by the handler of the non-maskable interrupt. Returns `false` where the program itself has lost content.
pub fn is_lost_expected() -> bool {
    trirrr_boot::stm32g474::is_expected()
}
