//! No line and no log: the image plays its job without a host, and leaves the pins of both alone.

use crate::board::{LinePins, LogTransmit};
use crate::clock::Clocks;

/// No part of a line.
pub(crate) type PacketReceiver = ();
pub(crate) type LineReceiver = ();
pub(crate) type LineTransmitter = ();
pub(crate) type LogTransmitter = ();

/// No memory.
pub(crate) struct LineMemory;

impl LineMemory {
    pub(crate) const fn new() -> Self {
        Self
    }
}

/// Starts nothing.
pub(crate) fn start(_: &mut LineMemory, _: LinePins, _: &Clocks) -> ((), (), ()) {
    ((), (), ())
}

/// Starts nothing.
pub(crate) fn start_log(_: LogTransmit, _: &Clocks) {}

/// Does nothing.
pub(crate) fn resume() {}
