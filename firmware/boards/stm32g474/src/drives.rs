//! Drives of the scene on the pins of the board file; `docs/board.md` has the tables.
//!
//! | drive | peripherals |
//! |---|---|
//! | stepper | TIM7: a slot |
//! | can | FDCAN1: an interrupt for each frame |
//!
//! An image holds the drive that its scene names, or none.

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
#[path = "../../stm32/drives/can.rs"]
mod can;
#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
#[path = "../../stm32/metapac/fdcan.rs"]
mod controller;
#[cfg(drive = "none")]
#[path = "../../stm32/drives/none.rs"]
mod none;
#[path = "../../stm32/drives/parts.rs"]
mod parts;
#[cfg(drive = "stepper")]
#[path = "../../stm32/drives/stepper.rs"]
mod stepper;

#[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
pub(super) use can::{BusDrives as Drives, Inbox, build, report};
pub(super) use parts::DriveParts;
#[cfg(drive = "stepper")]
pub(super) use stepper::{CheckedSteppers as Drives, SlotTimer as DriveTimer, build};
#[cfg(not(drive = "stepper"))]
pub(super) use trirrr_app::outputs::NoDriveTimer as DriveTimer;
#[cfg(drive = "none")]
pub(super) use {none::build, trirrr_app::outputs::NoOutputs as Drives};

#[cfg(drive = "bldc")]
compile_error!(
    "drive.kind = \"bldc\": the firmware for the STM32G474 drives steppers, drives on CAN or nothing"
);
