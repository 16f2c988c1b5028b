//! No drive: nothing but telemetry leaves the board.

use super::DriveParts;
use trirrr_app::outputs::NoOutputs;

/// Takes no part.
pub(crate) fn build(_: DriveParts) -> (NoOutputs, ()) {
    (NoOutputs, ())
}
