//! Line and log.

#[cfg(not(usb))]
use crate::board::{LinePort, LineReceive, LineTransmit};
use crate::board::{LogPort, LogTransmit};
use crate::clock::Clocks;
#[cfg(not(usb))]
use crate::dividers::set_bauds;
#[cfg(usb)]
use crate::dividers::set_log_baud;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Tx};
#[cfg(not(usb))]
use stm32f4xx_hal::serial::{Rx, RxListen, Serial};
#[cfg(not(usb))]
use trirrr_app::BAUD;
use trirrr_app::LOG_BAUD;

#[cfg(not(usb))]
pub(crate) type LineReceiver = Rx<LinePort>;
#[cfg(not(usb))]
pub(crate) type LineTransmitter = Tx<LinePort>;
pub(crate) type LogTransmitter = Tx<LogPort>;

/// Starts the port of the log at its pin, where the line is USB.
#[cfg(usb)]
pub(crate) fn start_log(
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    rcc: &mut Rcc,
) -> LogTransmitter {
    let Ok(log) = log
        .0
        .tx(log.1, Config::default().baudrate(LOG_BAUD.bps()), rcc)
    else {
        panic!("the slowest clock does not divide into the baud rate of the log");
    };
    set_log_baud(clocks, LOG_BAUD);
    log
}

/// Starts the ports of the line and of the log at their pins.
#[cfg(not(usb))]
pub(crate) fn start(
    line: (LinePort, LineTransmit, LineReceive),
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    rcc: &mut Rcc,
) -> (LineTransmitter, LineReceiver, LogTransmitter) {
    let settings = |baud: u32| Config::default().baudrate(baud.bps());
    // At rest the line is high: without an adapter at the pin noise would be bytes, and each of them an interrupt above the tick.
    let pins = (line.1, line.2.into_pull_up_input());
    let line = Serial::new(line.0, pins, settings(BAUD), rcc);
    let log = log.0.tx(log.1, settings(LOG_BAUD), rcc);
    let (Ok(line), Ok(log)) = (line, log) else {
        panic!("the slowest clock does not divide into the baud rates");
    };
    set_bauds(clocks, BAUD, LOG_BAUD);
    let (line, mut receiver) = line.split();
    receiver.listen();
    (line, receiver, log)
}
