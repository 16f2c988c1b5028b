//! Code that the STM32s share. The package of a chip has the modules `chip`, `clock`, `dma`, `drives`, `gpio`, `parts`, `serial` and `timers`, and
//! brings these into its root.

pub(crate) mod board;
pub(crate) mod clocking;
#[path = "../common/mod.rs"]
mod common;
pub(crate) mod counts;
pub(crate) mod fault_status;
#[cfg(not(usb))]
pub(crate) mod line;
pub(crate) mod pins;
mod program;
#[cfg(not(tool = "none"))]
pub(crate) mod tool;

pub(crate) use common::*;

use crate::clock::Clocks;
use crate::parts::{DrivePeripherals, Ports, Rcc, StoppedWatchdog, ToolCounter};
use trirrr_protocol::message::{Clock, Start};

/// A chip after its start.
pub(crate) struct ChipParts {
    /// Cause of the start.
    pub(crate) start: Start,
    pub(crate) clock: Clock,
    pub(crate) clocks: Clocks,
    pub(crate) rcc: Rcc,
    pub(crate) ports: Ports,
    pub(crate) drives: DrivePeripherals,
    // An image without a tool leaves it alone.
    #[allow(dead_code)]
    pub(crate) tool: ToolCounter,
    pub(crate) watchdog: StoppedWatchdog,
}
