//! Transmitter of the log at a serial port.

pub(crate) use self::LogWriter as LogTransmitter;
use crate::board::{LogPort, LogTransmit};
use crate::clock::PortRates;
use rp2040_hal::fugit::RateExtU32;
use rp2040_hal::gpio::{AnyPin, FunctionUart, Pin, PullNone};
use rp2040_hal::pac::RESETS;
use rp2040_hal::typelevel::{OptionTNone, OptionTSome};
use rp2040_hal::uart::{self, DataBits, StopBits, UartConfig, UartPeripheral, Writer};
use trirrr_app::LOG_BAUD;
use trirrr_boards::BoardPin;

type LogPin = Pin<<<LogTransmit as BoardPin>::Plain as AnyPin>::Id, FunctionUart, PullNone>;
type LogPins = uart::Pins<OptionTSome<LogPin>, OptionTNone, OptionTNone, OptionTNone>;

/// Transmitter of the log.
pub(crate) type LogWriter = Writer<LogPort, LogPins>;

/// Starts the port of the log at its pin.
pub(crate) fn start_log(
    pin: LogTransmit,
    port: LogPort,
    resets: &mut RESETS,
    clocks: &PortRates,
) -> LogWriter {
    let settings = UartConfig::new(LOG_BAUD.Hz(), DataBits::Eight, None, StopBits::One);
    let pins = uart::Pins::default().tx(pin.plain().reconfigure());
    let log = UartPeripheral::new(port, pins, resets).enable(settings, clocks.peripheral);
    let Ok(log) = log else {
        panic!("the clock does not divide into the baud rate of the log");
    };
    log.split().1
}
