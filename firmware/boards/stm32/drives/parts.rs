//! Parts of a board for drives.

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
use super::Inbox;
use crate::board::DrivePins;
use crate::clock::Clocks;
use crate::parts::DrivePeripherals;
use trirrr_app::inputs::Angle;
#[cfg(feedback)]
use trirrr_protocol::message::Clock;

/// Parts of the board for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(crate) struct DriveParts {
    /// Pins of the kind of drive.
    pub(crate) pins: DrivePins,
    pub(crate) peripherals: DrivePeripherals,
    /// Rates of the clocks.
    pub(crate) clocks: Clocks,
    /// Source of the clocks.
    #[cfg(feedback)]
    pub(crate) clock: Clock,
    /// Queue of the frames that came in.
    #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
    pub(crate) inbox: &'static mut Inbox,
    /// Joint angles at the start.
    pub(crate) angles: [Angle; 3],
}
