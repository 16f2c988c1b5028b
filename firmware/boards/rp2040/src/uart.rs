//! The line at a serial port.

pub(crate) use self::{
    NoPackets as PacketReceiver, UartMemory as LineMemory, UartReceiver as ByteReceiver,
    UartTransmitter as LineTransmitter,
};
use crate::board::{LinePins, LinePort, LineReceive, LineTransmit};
use crate::clock::PortRates;
use embedded_hal_nb::serial::Read;
use heapless::spsc::{Consumer, Producer, Queue};
use rp2040_hal::fugit::RateExtU32;
use rp2040_hal::gpio::{AnyPin, FunctionUart, Pin, PullNone, PullUp};
use rp2040_hal::pac::RESETS;
use rp2040_hal::uart::{
    DataBits, FifoWatermark, Reader, StopBits, UartConfig, UartPeripheral, Writer,
};
use trirrr_app::{BAUD, IN_FLIGHT, IS_FIXED};
use trirrr_boards::BoardPin;

/// Capacity of the receiver, bytes.
const FIFO: usize = 32;

/// Pin of a transmitter.
pub(crate) type Transmit<P> = Pin<<<P as BoardPin>::Plain as AnyPin>::Id, FunctionUart, PullNone>;
type PortPins = (
    Transmit<LineTransmit>,
    Pin<<<LineReceive as BoardPin>::Plain as AnyPin>::Id, FunctionUart, PullUp>,
);

/// Places for bytes on their way to the background; one stays empty. At 921,600 baud they last for 22 ms. A power of two: the queue divides by it at
/// each byte, and the core has no division.
const RECEIVED: usize = 2048;

// In fixed point a slice of admission lasts for 6.8 ms. Floats are software here, and nobody has measured theirs.
const _: () = assert!(
    IN_FLIGHT < RECEIVED || IS_FIXED,
    "the queue has room for all requests that a host sends before it has an answer"
);

/// Bytes on their way to the background.
pub(crate) type UartMemory = Queue<u8, RECEIVED>;

/// Transmitter of the line.
pub(crate) type UartTransmitter = Writer<LinePort, PortPins>;

/// Receiver, in its interrupt.
pub(crate) struct UartReceiver {
    port: Reader<LinePort, PortPins>,
    received: Producer<'static, u8>,
}

/// Part of the line in the interrupt of USB: none.
pub(crate) type NoPackets = ();

/// Starts the port of the line at its pins.
pub(crate) fn start(
    memory: &'static mut UartMemory,
    (port, pins): (LinePort, LinePins),
    resets: &mut RESETS,
    clocks: PortRates,
) -> (
    (UartReceiver, NoPackets),
    Consumer<'static, u8>,
    UartTransmitter,
) {
    let pins = (
        pins.line_transmit.plain().reconfigure(),
        pins.line_receive.plain().reconfigure(),
    );
    let settings = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
    let Ok(mut line) = UartPeripheral::new(port, pins, resets).enable(settings, clocks.peripheral)
    else {
        panic!("the clock does not divide into the baud rate of the line");
    };
    line.set_rx_watermark(FifoWatermark::Bytes4);
    let (mut port, transmitter) = line.split();
    port.enable_rx_interrupt();
    let (received, bytes) = memory.split();
    ((UartReceiver { port, received }, ()), bytes, transmitter)
}

impl UartReceiver {
    /// Moves bytes from the line into their queue.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        // Bounded: bytes beyond the receiver's capacity come later.
        for _ in 0..FIFO {
            match self.port.read() {
                // A damaged byte, or one without room, damages its frame, which the host repeats.
                Ok(byte) => {
                    let _ = self.received.enqueue(byte);
                }
                Err(nb::Error::WouldBlock) => return,
                Err(nb::Error::Other(_)) => {}
            }
        }
    }
}

/// Waits for nothing: a queue that is full drops bytes.
pub(crate) fn resume(_: bool) {}
