//! Drives of the scene on the pins of this board; `docs/board.md` has the table.
//!
//! | drive | pins | peripherals |
//! |---|---|---|
//! | stepper | step GP6 to GP8, direction GP9 to GP11, enable GP12 | PWM slice 7: a slot |
//!
//! Motors 1 to 3 have the pins in this order. An image holds the drive that its scene names, or none.

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

use rp2040_hal::gpio::bank0::{Gpio6, Gpio7, Gpio8, Gpio9, Gpio10, Gpio11, Gpio12};
use rp2040_hal::gpio::{FunctionNull, Pin, PullDown};
use rp2040_hal::pwm::{FreeRunning, Pwm7, Slice};
use trirrr_app::inputs::Angle;

pub(super) type Unused<P> = Pin<P, FunctionNull, PullDown>;

/// Parts of the board for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(super) struct DriveParts {
    pub(super) step: (Unused<Gpio6>, Unused<Gpio7>, Unused<Gpio8>),
    pub(super) direction: (Unused<Gpio9>, Unused<Gpio10>, Unused<Gpio11>),
    pub(super) enable: Unused<Gpio12>,
    pub(super) slots: Slice<Pwm7, FreeRunning>,
    /// Joint angles at the start.
    pub(super) angles: [Angle; 3],
}
