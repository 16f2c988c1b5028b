//! Why the board started.

use stm32f4xx_hal::pac::RCC;
use trirrr_protocol::message::Start;
use trirrr_station::cause;

/// From what the run before has kept and the flags of the reset, which are cleared.
pub(super) fn cause(rcc: &RCC) -> Start {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().clear());
    let kept = cause::take();
    // Switched on, the RAM is noise, however well it looks.
    if flags.porrstf().bit_is_set() {
        return Start::Power;
    }
    if let Some(start) = kept {
        return start;
    }
    match (flags.wdgrstf().bit_is_set(), flags.bits() >> 24) {
        (true, _) => Start::Watchdog,
        // No flag at all: an emulator.
        (_, 0) => Start::Power,
        _ => Start::Reset,
    }
}
