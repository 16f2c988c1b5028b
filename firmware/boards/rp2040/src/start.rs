//! Cause of the board's start.

use rp2040_hal::pac::{VREG_AND_CHIP_RESET, WATCHDOG};
use trirrr_app::cause;
use trirrr_protocol::message::Start;

/// Combines the cause that the run before has kept with the chip's own record of the reset.
pub(super) fn cause(watchdog: &WATCHDOG, chip: &VREG_AND_CHIP_RESET) -> Start {
    let reason = watchdog.reason().read();
    let kept = cause::take();
    // A restart by the watchdog, ordered or not, leaves the record of the last power-on as it was.
    let restarted = reason.timer().bit_is_set() || reason.force().bit_is_set();
    // After power-on the RAM is noise, whatever it seems to hold.
    if !restarted && chip.chip_reset().read().had_por().bit_is_set() {
        return Start::Power;
    }
    match (kept, reason.timer().bit_is_set()) {
        (Some(start), _) => start,
        (None, true) => Start::Watchdog,
        (None, false) => Start::Reset,
    }
}
