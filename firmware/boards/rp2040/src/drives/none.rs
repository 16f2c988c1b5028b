//! No drive: nothing but telemetry leaves the board.

use super::DriveParts;
use trirrr_app::outputs::NoOutputs;
pub(crate) use trirrr_app::outputs::{NoDriveTimer as DriveTimer, NoOutputs as Drives};

/// Takes no part.
pub(crate) fn build(_: DriveParts) -> (Drives, DriveTimer) {
    (NoOutputs, ())
}
