//! Line and log, by the registers of USARTs with a status of their own for each direction (all but the oldest STM32s).

#[cfg(not(usb))]
use crate::board::{LinePort, LineReceive, LineTransmit};
use crate::board::{LogPort, LogTransmit};
use crate::clock::Clocks;
#[cfg(not(usb))]
use crate::line::{self, LineReceiver, LineTransmitter};
use crate::parts::Rcc;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Write};
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::Brr;
#[cfg(not(usb))]
use trirrr_app::BAUD;
use trirrr_app::LOG_BAUD;

/// Alternate function of every such pin.
const FUNCTION: u8 = 7;

/// Transmitter of the log.
pub(crate) struct LogTransmitter(Usart);

/// Starts the port of the log at its pin, where the line is USB.
#[cfg(usb)]
pub(crate) fn start_log(
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    _: &mut Rcc,
) -> LogTransmitter {
    let _ = log.1.into_alternate::<FUNCTION>();
    configure(log.0, LOG_BAUD, false, clocks);
    LogTransmitter(log.0)
}

/// Sets a port up, that of the line for its DMA. It has the clock of its bus.
fn configure(port: Usart, baud: u32, is_line: bool, clocks: &Clocks) {
    port.brr().write_value(Brr((clocks.apb1 + baud / 2) / baud));
    port.cr3().write(|w| {
        w.set_dmar(is_line);
        w.set_dmat(is_line);
    });
    port.cr1().write(|w| {
        w.set_te(true);
        w.set_re(is_line);
        w.set_ue(true);
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
    // At rest the line is high: without an adapter at the pin noise would be bytes.
    let _ = (
        line.1.into_alternate::<FUNCTION>(),
        line.2.into_alternate::<FUNCTION>().internal_pull_up(true),
        log.1.into_alternate::<FUNCTION>(),
    );
    // The first byte finds the DMA waiting.
    let data = [line.0.rdr().as_ptr() as u32, line.0.tdr().as_ptr() as u32];
    let (transmitter, receiver) = line::start(data, rcc);
    configure(line.0, BAUD, true, clocks);
    configure(log.0, LOG_BAUD, false, clocks);
    (transmitter, receiver, LogTransmitter(log.0))
}

impl ErrorType for LogTransmitter {
    type Error = ErrorKind;
}

impl Write<u8> for LogTransmitter {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        if !self.0.isr().read().txe() {
            return Err(nb::Error::WouldBlock);
        }
        self.0.tdr().write(|w| w.set_dr(byte.into()));
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        match self.0.isr().read().tc() {
            true => Ok(()),
            false => Err(nb::Error::WouldBlock),
        }
    }
}
