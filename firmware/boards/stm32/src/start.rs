//! Start of the chip: its cause, and the clocks.

use crate::{chip, clock};
use stm32_metapac::RCC;
use trirrr_app::cause;
use trirrr_protocol::message::{Clock, Start};

/// Starts the clocks. Returns the cause of the start, and the clocks' source and rates.
pub(crate) fn start() -> (Start, Clock, clock::Clocks) {
    let start = cause_of_start();
    chip::switch_on();
    let (clock, clocks) = chip::protected(|| clock::start(&start));
    (start, clock, clocks)
}

/// Flags of a reset in RCC_CSR, at the same places in both chips: power-on, of the STM32G474 brown-out, which comes with it; the watchdog; all.
const POWER: u32 = 1 << 27;
const WATCHDOG: u32 = 1 << 29;
const ANY: u32 = 0xFF << 24;

/// Combines the cause that the run before has kept with the flags of the reset, and clears both.
fn cause_of_start() -> Start {
    let flags = RCC.csr().read().0;
    RCC.csr().modify(|w| w.set_rmvf(true));
    let kept = cause::take();
    // After power-on the RAM is noise, whatever it seems to hold. An emulator sets no flag.
    match (flags & POWER != 0, kept, flags & WATCHDOG != 0) {
        (true, _, _) => Start::Power,
        (_, Some(start), _) => start,
        (_, _, true) => Start::Watchdog,
        _ if chip::BROWN_OUT.is_some_and(|flag| flags & flag != 0) => Start::LowSupply,
        _ if flags & ANY == 0 => Start::Power,
        _ => Start::Reset,
    }
}
