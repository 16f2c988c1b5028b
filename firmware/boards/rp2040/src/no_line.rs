//! No line and no log: the image plays its job without a host, and leaves the pins of both alone.

pub(crate) use self::{
    NoMemory as LineMemory, NoPort as ByteReceiver, NoPort as LineTransmitter,
    NoPort as LogTransmitter, NoPort as PacketReceiver,
};
use crate::board::{LinePins, LinePort, LogPort, LogTransmit};
use crate::clock::PortRates;
use rp2040_hal::pac::RESETS;

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
pub(crate) fn start(
    _: &mut NoMemory,
    _: (LinePort, LinePins),
    _: &mut RESETS,
    _: PortRates,
) -> (((), ()), (), ()) {
    (((), ()), (), ())
}

/// Starts nothing.
pub(crate) fn start_log(_: LogTransmit, _: LogPort, _: &mut RESETS, _: &PortRates) {}

/// Does nothing.
pub(crate) fn resume(_: bool) {}
