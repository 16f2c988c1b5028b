//! What is done below the tick, and the ports that it goes out by.

use embedded_hal_nb::serial::Write;
use trirrr_station::{self as station, log};

/// The half of the service that talks, the port of its line, and that of the log.
pub(crate) struct Background<W, L> {
    service: station::Background,
    transmitter: W,
    log: L,
}

impl<W: Write<u8>, L: Write<u8>> Background<W, L> {
    pub(crate) fn new(service: station::Background, transmitter: W, log: L) -> Self {
        Self {
            service,
            transmitter,
            log,
        }
    }

    /// A slice of the service, and what the ports take.
    pub(crate) fn step(&mut self) {
        self.service.send(&mut self.transmitter);
        self.service.step();
        log::drain(&mut self.log);
    }
}
