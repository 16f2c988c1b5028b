//! Line and log, by the registers of USARTs with a status of their own for each direction (all but the oldest STM32s).

#[cfg(not(usb))]
use crate::board::{LinePort, LineReceive, LineTransmit};
use crate::board::{LogPort, LogTransmit};
use crate::clock::Clocks;
use crate::parts::Rcc;
#[cfg(not(usb))]
use embedded_hal_nb::serial::Read;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Write};
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::Brr;
#[cfg(not(usb))]
use trirrr_app::BAUD;
use trirrr_app::LOG_BAUD;

/// Alternate function of every such pin.
const FUNCTION: u8 = 7;

/// Receiver of the line.
#[cfg(not(usb))]
pub(crate) struct LineReceiver(Usart);
/// Transmitter of a port.
pub(crate) struct Transmitter(Usart);

#[cfg(not(usb))]
pub(crate) type LineTransmitter = Transmitter;
pub(crate) type LogTransmitter = Transmitter;

/// Starts the port of the log at its pin, where the line is USB.
#[cfg(usb)]
pub(crate) fn start_log(
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    _: &mut Rcc,
) -> LogTransmitter {
    let _ = log.1.into_alternate::<FUNCTION>();
    configure(log.0, LOG_BAUD, false, clocks);
    Transmitter(log.0)
}

/// Sets a port up. It has the clock of its bus.
fn configure(port: Usart, baud: u32, receives: bool, clocks: &Clocks) {
    port.brr().write_value(Brr((clocks.apb1 + baud / 2) / baud));
    port.cr1().write(|w| {
        w.set_te(true);
        w.set_re(receives);
        w.set_rxneie(receives);
        w.set_ue(true);
    });
}

/// Starts the ports of the line and of the log at their pins.
#[cfg(not(usb))]
pub(crate) fn start(
    line: (LinePort, LineTransmit, LineReceive),
    log: (LogPort, LogTransmit),
    clocks: &Clocks,
    _: &mut Rcc,
) -> (LineTransmitter, LineReceiver, LogTransmitter) {
    // At rest the line is high: without an adapter at the pin noise would be bytes, and each of them an interrupt above the tick.
    let _ = (
        line.1.into_alternate::<FUNCTION>(),
        line.2.into_alternate::<FUNCTION>().internal_pull_up(true),
        log.1.into_alternate::<FUNCTION>(),
    );
    configure(line.0, BAUD, true, clocks);
    configure(log.0, LOG_BAUD, false, clocks);
    (
        Transmitter(line.0),
        LineReceiver(line.0),
        Transmitter(log.0),
    )
}

#[cfg(not(usb))]
impl ErrorType for LineReceiver {
    type Error = ErrorKind;
}

#[cfg(not(usb))]
impl Read<u8> for LineReceiver {
    #[inline(always)]
    fn read(&mut self) -> nb::Result<u8, ErrorKind> {
        let status = self.0.isr().read();
        if status.ore() || status.fe() || status.ne() {
            // An error would call the interrupt again and again.
            self.0.icr().write(|w| {
                w.set_ore(true);
                w.set_fe(true);
                w.set_ne(true);
            });
            let _ = self.0.rdr().read();
            return Err(nb::Error::Other(ErrorKind::Other));
        }
        match status.rxne() {
            true => Ok(self.0.rdr().read().dr() as u8),
            false => Err(nb::Error::WouldBlock),
        }
    }
}

impl ErrorType for Transmitter {
    type Error = ErrorKind;
}

impl Write<u8> for Transmitter {
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
