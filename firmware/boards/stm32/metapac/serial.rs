//! Line and log, by the registers of USARTs with a status of their own for each direction (all but the oldest STM32s).

use crate::board::{LinePort, LineReceive, LineTransmit, LogPort, LogTransmit};
use crate::clock::Clocks;
use crate::line::{self, LineReceiver, LineTransmitter};
use crate::parts::Rcc;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Write};
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::Brr;
use trirrr_app::{BAUD, LOG_BAUD};

/// Alternate function of every such pin.
const FUNCTION: u8 = 7;

/// Transmitter of the log.
pub(crate) struct LogTransmitter(Usart);

/// Starts the ports of the line and of the log at their pins. Both have the clock of their bus.
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
    for (port, baud, is_line) in [(line.0, BAUD, true), (log.0, LOG_BAUD, false)] {
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
