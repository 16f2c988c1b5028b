//! Drives of the scene on the pins of the board file; `docs/board.md` has the tables. An image holds the drive that its scene names, or none.
//!
//! | drive | peripherals |
//! |---|---|
//! | stepper | TIM7: a slot |
//! | bldc | TIM3: PWM; TIM1, TIM4, TIM5: counters; TIM7: a sample |
//! | can | CAN1 or FDCAN1: an interrupt for each frame |

#[cfg(drive = "bldc")]
pub(crate) mod bldc;
#[cfg(bus)]
pub(crate) mod bus;
#[cfg(bus)]
pub(crate) mod can;
mod no_bus;
#[cfg(drive = "none")]
pub(crate) mod none;
#[cfg(drive = "stepper")]
pub(crate) mod stepper;

pub(crate) use crate::board::drive::{DriveTimer, Drives, Inbox, build, no_frames, report};

use crate::board::DrivePins;
use crate::clock::Clocks;
use trirrr_app::inputs::Angle;
use trirrr_protocol::message::Clock;

/// Parts of the board for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(crate) struct DriveParts {
    /// Pins of the kind of drive.
    pub(crate) pins: DrivePins,
    /// Rates of the clocks, and their source.
    pub(crate) clocks: Clocks,
    pub(crate) clock: Clock,
    /// Queue of the frames that came in.
    pub(crate) inbox: &'static mut Inbox,
    /// Joint angles at the start.
    pub(crate) angles: [Angle; 3],
}
