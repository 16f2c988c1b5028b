//! No drive: nothing but telemetry leaves the board.

use super::DriveParts;
use crate::parts::Rcc;
use trirrr_app::outputs::NoOutputs;

/// Takes no part.
pub(crate) fn build(_: DriveParts, _: &mut Rcc) -> (NoOutputs, ()) {
    (NoOutputs, ())
}
