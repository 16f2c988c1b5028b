//! Drives of the scene on the pins of the board file; `docs/board.md` has the table.
//!
//! | drive | peripherals |
//! |---|---|
//! | stepper | PWM slice 7: a slot |
//!
//! An image holds the drive that its scene names, or none.

#[cfg(drive = "none")]
pub(crate) mod none;
#[cfg(drive = "stepper")]
pub(crate) mod stepper;

pub(crate) use crate::board::drive::{DriveTimer, Drives, build};

#[cfg(drive = "bldc")]
compile_error!("drive.kind = \"bldc\": the firmware for the RP2040 drives steppers or nothing");

#[cfg(bus)]
compile_error!("drive.kind = \"can\": the RP2040 has no CAN controller");

use crate::board::DrivePins;
use rp2040_hal::pwm::{FreeRunning, Pwm7, Slice};
use trirrr_app::inputs::Angle;

/// Parts of the board for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(crate) struct DriveParts {
    /// Pins of the kind of drive.
    pub(crate) pins: DrivePins,
    pub(crate) slots: Slice<Pwm7, FreeRunning>,
    /// Joint angles at the start.
    pub(crate) angles: [Angle; 3],
}
