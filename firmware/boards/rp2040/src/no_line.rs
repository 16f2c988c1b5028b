//! No line and no log: the image plays its job without a host, and leaves the pins of both alone.

use crate::board::{LinePins, LinePort, LogPort, LogTransmit};
use crate::clock::PortRates;
use rp2040_hal::pac::RESETS;

/// No part of a line.
pub(crate) type ByteReceiver = ();
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
pub(crate) fn start(
    _: &mut LineMemory,
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
