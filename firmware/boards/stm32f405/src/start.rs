//! Cause of the board's start.

use stm32f4xx_hal::pac::RCC;
use trirrr_app::cause;
use trirrr_protocol::message::Start;

/// Combines the cause that the run before has kept with the flags of the reset, and clears both.
pub(super) fn cause(rcc: &RCC) -> Start {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().clear());
    let kept = cause::take();
    // After power-on the RAM is noise, whatever it seems to hold.
    if flags.porrstf().bit_is_set() {
        return Start::Power;
    }
    if let Some(start) = kept {
        return start;
    }
    match (flags.wdgrstf().bit_is_set(), flags.bits() >> 24) {
        (true, _) => Start::Watchdog,
        // An emulator sets no flag.
        (_, 0) => Start::Power,
        _ => Start::Reset,
    }
}
