//! Serial ports, and the transmitter of the log at one.

use crate::board::{LOG_FUNCTION, LOG_PORT, LogTransmit};
use crate::chip;
use crate::clock::Clocks;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Write};
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::Brr;
use trirrr_app::LOG_BAUD;

/// First address of APB2.
const APB2: usize = 0x4001_0000;

/// Sets a port up, that of the line for its DMA. It has the clock of its bus, samples each bit 16 times, and counts sixteenths of a sample
/// (RM0090, 30.3.4).
pub(crate) fn configure(port: Usart, baud: u32, is_line: bool, clocks: &Clocks) {
    let bus_hz = match port.as_ptr() as usize >= APB2 {
        true => clocks.apb2,
        false => clocks.apb1,
    };
    port.brr().write_value(Brr((bus_hz + baud / 2) / baud));
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

/// Transmitter of the log.
pub(crate) struct LogTransmitter(());

/// Starts the port of the log at its pin.
pub(crate) fn start_log(pin: LogTransmit, clocks: &Clocks) -> LogTransmitter {
    let _ = pin.into_alternate::<LOG_FUNCTION>();
    configure(LOG_PORT, LOG_BAUD, false, clocks);
    LogTransmitter(())
}

impl ErrorType for LogTransmitter {
    type Error = ErrorKind;
}

impl Write<u8> for LogTransmitter {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        if !chip::status(LOG_PORT).read().txe() {
            return Err(nb::Error::WouldBlock);
        }
        chip::sent(LOG_PORT).write(|w| w.set_dr(byte.into()));
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        match chip::status(LOG_PORT).read().tc() {
            true => Ok(()),
            false => Err(nb::Error::WouldBlock),
        }
    }
}
