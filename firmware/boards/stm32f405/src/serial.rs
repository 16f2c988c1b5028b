//! Line and log.

use crate::board::{LinePort, LineReceive, LineTransmit, LogPort, LogTransmit};
use crate::clock::Clocks;
use crate::dividers::set_bauds;
use crate::line::{self, LineReceiver, LineTransmitter};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::DmaConfig;
use stm32f4xx_hal::serial::{Config, Serial, Tx};
use trirrr_app::{BAUD, LOG_BAUD};

pub(crate) type LogTransmitter = Tx<LogPort>;

/// Starts the ports of the line and of the log at their pins.
pub(crate) fn start(
    line: (LinePort, LineTransmit, LineReceive),
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    rcc: &mut Rcc,
) -> (LineTransmitter, LineReceiver, LogTransmitter) {
    let settings = |baud: u32| Config::default().baudrate(baud.bps());
    // The first byte finds the DMA waiting.
    let data = line.0.dr().as_ptr() as u32;
    let (transmitter, receiver) = line::start([data, data], rcc);
    // At rest the line is high: without an adapter at the pin noise would be bytes.
    let pins = (line.1, line.2.into_pull_up_input());
    let line = Serial::<LinePort, u8>::new(line.0, pins, settings(BAUD).dma(DmaConfig::TxRx), rcc);
    let log = log.0.tx(log.1, settings(LOG_BAUD), rcc);
    let (Ok(_), Ok(log)) = (line, log) else {
        panic!("the slowest clock does not divide into the baud rates");
    };
    set_bauds(clocks, BAUD, LOG_BAUD);
    (transmitter, receiver, log)
}
