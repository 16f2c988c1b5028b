//! No drive: nothing but telemetry leaves the board.

use super::DriveParts;
use stm32f4xx_hal::rcc::Rcc;
use trirrr_app::outputs::NoOutputs;

/// Takes no part.
pub(crate) fn build(_: DriveParts, _: &mut Rcc) -> (NoOutputs, ()) {
    (NoOutputs, ())
}
