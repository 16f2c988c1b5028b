//! Drives of the scene on the pins of the board file; `docs/board.md` has the tables.
//!
//! | drive | peripherals |
//! |---|---|
//! | stepper | TIM7: a slot |
//! | bldc | TIM3: PWM; TIM1, TIM4, TIM5: counters; TIM7: a sample |
//! | can | CAN1: an interrupt for each frame |
//!
//! All timers but TIM1 are on APB1. An image holds the drive that its scene
//! names, or none.

#[cfg(drive = "bldc")]
mod bldc;
#[cfg(any(drive = "odrive", drive = "mit"))]
#[path = "../../../stm32/drives/can.rs"]
mod can;
#[cfg(any(drive = "odrive", drive = "mit"))]
mod controller;
#[cfg(drive = "none")]
#[path = "../../../stm32/drives/none.rs"]
mod none;
#[path = "../../../stm32/drives/parts.rs"]
mod parts;
#[cfg(drive = "stepper")]
#[path = "../../../stm32/drives/stepper.rs"]
mod stepper;

#[cfg(drive = "bldc")]
pub(super) use bldc::{BldcDrives as Drives, SampleTimer as DriveTimer, build};
#[cfg(any(drive = "odrive", drive = "mit"))]
pub(super) use can::{BusDrives as Drives, Inbox, build, report};
pub(super) use parts::DriveParts;
#[cfg(drive = "stepper")]
pub(super) use stepper::{CheckedSteppers as Drives, SlotTimer as DriveTimer, build};
#[cfg(not(any(drive = "stepper", drive = "bldc")))]
pub(super) use trirrr_app::outputs::NoDriveTimer as DriveTimer;
#[cfg(drive = "none")]
pub(super) use {none::build, trirrr_app::outputs::NoOutputs as Drives};

#[cfg(drive = "moteus")]
compile_error!(
    "drive.protocol = \"moteus\": its frames take CAN FD, and the controllers of the STM32F405 are \
     of classic CAN"
);
