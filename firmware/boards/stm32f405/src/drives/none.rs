//! No drive: nothing but telemetry leaves the board.

use super::Parts;
use stm32f4xx_hal::rcc::Rcc;

pub(crate) use trirrr_app::outputs::NoOutputs as Drives;

/// No work between two ticks.
pub(crate) type Slot = ();

/// Takes no part.
pub(crate) fn build(_: Parts, _: &mut Rcc) -> (Drives, Slot) {
    (Drives, ())
}
