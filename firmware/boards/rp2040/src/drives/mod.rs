//! Drives of the scene on the pins of the board file; `docs/board.md` has the table.
//!
//! | drive | peripherals |
//! |---|---|
//! | stepper | PWM slice 7: a slot |
//!
//! An image holds the drive that its scene names, or none.

#[cfg(drive = "none")]
mod none;
#[cfg(drive = "stepper")]
mod stepper;

#[cfg(drive = "stepper")]
pub(super) use stepper::{SlotTimer as DriveTimer, StepperDrives as Drives, build};
#[cfg(not(drive = "stepper"))]
pub(super) use trirrr_app::outputs::NoDriveTimer as DriveTimer;
#[cfg(drive = "none")]
pub(super) use {none::build, trirrr_app::outputs::NoOutputs as Drives};

#[cfg(drive = "bldc")]
compile_error!("drive.kind = \"bldc\": the firmware for the RP2040 drives steppers or nothing");

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
compile_error!("drive.kind = \"can\": the RP2040 has no CAN controller");

use crate::board::DrivePins;
use rp2040_hal::pwm::{FreeRunning, Pwm7, Slice};
use trirrr_app::inputs::Angle;

/// Parts of the board for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(super) struct DriveParts {
    /// Pins of the kind of drive.
    pub(super) pins: DrivePins,
    pub(super) slots: Slice<Pwm7, FreeRunning>,
    /// Joint angles at the start.
    pub(super) angles: [Angle; 3],
}
