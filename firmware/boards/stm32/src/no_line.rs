//! No line and no log: the image plays its job without a host, and leaves the pins of both alone.

pub(crate) use self::{
    NoMemory as LineMemory, NoPort as LineReceiver, NoPort as LineTransmitter,
    NoPort as LogTransmitter, NoPort as PacketReceiver,
};
use crate::board::{LinePins, LogTransmit};
use crate::clock::Clocks;

/// No part of a line.
pub(crate) type NoPort = ();

/// No memory.
pub(crate) struct NoMemory;

impl NoMemory {
    pub(crate) const fn new() -> Self {
        Self
    }
}

/// Starts nothing.
pub(crate) fn start(_: &mut NoMemory, _: LinePins, _: &Clocks) -> ((), (), ()) {
    ((), (), ())
}

/// Starts nothing.
pub(crate) fn start_log(_: LogTransmit, _: &Clocks) {}

/// Does nothing.
pub(crate) fn resume() {}
