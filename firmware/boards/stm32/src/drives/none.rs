//! No drive: nothing but telemetry leaves the board.

use super::DriveParts;
pub(crate) use super::no_bus::{Inbox, no_frames, report};
use trirrr_app::outputs::NoOutputs;
pub(crate) use trirrr_app::outputs::{NoDriveTimer as DriveTimer, NoOutputs as Drives};

/// Takes no part.
pub(crate) fn build(_: DriveParts) -> (Drives, DriveTimer) {
    (NoOutputs, ())
}
