//! Drives of the scene on the pins of the board file: steppers, called by TIM7, drives on FDCAN1, or none.

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
#[path = "../drives/can.rs"]
mod can;
#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
#[path = "fdcan.rs"]
mod controller;
#[cfg(drive = "none")]
#[path = "../drives/none.rs"]
mod none;
#[path = "../drives/parts.rs"]
mod parts;
#[cfg(drive = "stepper")]
#[path = "../drives/stepper.rs"]
mod stepper;

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
pub(crate) use can::{BusDrives as Drives, Inbox, build, report};
pub(crate) use parts::DriveParts;
#[cfg(drive = "stepper")]
pub(crate) use stepper::{CheckedSteppers as Drives, SlotTimer as DriveTimer, build};
#[cfg(not(drive = "stepper"))]
pub(crate) use trirrr_app::outputs::NoDriveTimer as DriveTimer;
#[cfg(drive = "none")]
pub(crate) use {none::build, trirrr_app::outputs::NoOutputs as Drives};

#[cfg(drive = "bldc")]
compile_error!(
    "drive.kind = \"bldc\": the firmware for this board drives steppers, drives on CAN or nothing"
);
