//! No drive: telemetry is all that leaves the board.

use super::Parts;
use stm32f4xx_hal::rcc::Rcc;

pub(crate) use crate::outputs::NoOutputs as Drives;

/// Nothing to do between two ticks.
pub(crate) type Slot = ();

/// Nothing to build.
pub(crate) fn build(_: Parts, _: &mut Rcc) -> (Drives, Slot) {
    (Drives, ())
}
