//! Line and log.

#[cfg(not(usb))]
use crate::board::{LinePort, LineReceive, LineTransmit};
use crate::board::{LogPort, LogTransmit};
use crate::clock::Clocks;
#[cfg(not(usb))]
use crate::dividers::set_bauds;
#[cfg(usb)]
use crate::dividers::set_log_baud;
#[cfg(not(usb))]
use crate::line::{self, LineReceiver, LineTransmitter};
use core::convert::Infallible;
use embedded_hal_nb::serial::{ErrorType, Write};
use stm32f4xx_hal::gpio::PushPull;
use stm32f4xx_hal::gpio::alt::SerialAsync;
use stm32f4xx_hal::pac::usart1;
use stm32f4xx_hal::rcc::{Enable, Rcc};
#[cfg(not(usb))]
use trirrr_app::BAUD;
use trirrr_app::LOG_BAUD;

/// Transmitter of the log.
pub(crate) struct LogTransmitter(LogPort);

/// Starts the port of the log at its pin, where the line is USB.
#[cfg(usb)]
pub(crate) fn start_log(
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    rcc: &mut Rcc,
) -> LogTransmitter {
    LogPort::enable(rcc);
    let _: <LogPort as SerialAsync>::Tx<PushPull> = log.1.into();
    set_log_baud(clocks, LOG_BAUD);
    transmit(&log.0);
    LogTransmitter(log.0)
}

/// Switches a port and its transmitter on.
fn transmit(port: &usart1::RegisterBlock) {
    port.cr1().write(|w| {
        w.te().enabled();
        w.ue().enabled()
    });
}

/// Starts the ports of the line and of the log at their pins.
#[cfg(not(usb))]
pub(crate) fn start(
    line: (LinePort, LineTransmit, LineReceive),
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    rcc: &mut Rcc,
) -> (LineTransmitter, LineReceiver, LogTransmitter) {
    LinePort::enable(rcc);
    LogPort::enable(rcc);
    // At rest the line is high: without an adapter at the pin noise would be bytes.
    let _: <LinePort as SerialAsync>::Rx<PushPull> = line.2.into_pull_up_input().into();
    let _: <LinePort as SerialAsync>::Tx<PushPull> = line.1.into();
    let _: <LogPort as SerialAsync>::Tx<PushPull> = log.1.into();
    // The first byte finds the DMA waiting.
    let data = line.0.dr().as_ptr() as u32;
    let (transmitter, receiver) = line::start([data, data], rcc);
    line.0.cr3().write(|w| {
        w.dmar().enabled();
        w.dmat().enabled()
    });
    set_bauds(clocks, BAUD, LOG_BAUD);
    line.0.cr1().write(|w| {
        w.re().enabled();
        w.te().enabled();
        w.ue().enabled()
    });
    transmit(&log.0);
    (transmitter, receiver, LogTransmitter(log.0))
}

impl ErrorType for LogTransmitter {
    type Error = Infallible;
}

impl Write<u8> for LogTransmitter {
    fn write(&mut self, byte: u8) -> nb::Result<(), Infallible> {
        if self.0.sr().read().txe().bit_is_clear() {
            return Err(nb::Error::WouldBlock);
        }
        self.0.dr().write(|w| w.dr().set(byte.into()));
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), Infallible> {
        match self.0.sr().read().tc().bit_is_set() {
            true => Ok(()),
            false => Err(nb::Error::WouldBlock),
        }
    }
}
