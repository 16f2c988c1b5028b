//! Why the board started.

use rp2040_hal::pac::{VREG_AND_CHIP_RESET, WATCHDOG};
use trirrr_protocol::message::Start;
use trirrr_station::cause;

/// From what the run before has kept and what the chip knows of the reset.
pub(super) fn cause(watchdog: &WATCHDOG, chip: &VREG_AND_CHIP_RESET) -> Start {
    let reason = watchdog.reason().read();
    let kept = cause::take();
    // A restart by the watchdog, ordered or not, leaves the chip's own reset where it was.
    let restarted = reason.timer().bit_is_set() || reason.force().bit_is_set();
    // Switched on, the RAM is noise, however well it looks.
    if !restarted && chip.chip_reset().read().had_por().bit_is_set() {
        return Start::Power;
    }
    match (kept, reason.timer().bit_is_set()) {
        (Some(start), _) => start,
        (None, true) => Start::Watchdog,
        (None, false) => Start::Reset,
    }
}
