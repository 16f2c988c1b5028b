//! USB as the line: a serial port of the class CDC ACM, which every host has a driver for.
//!
//! The interrupt of the controller does the work, below the tick and above the background. Between it and the background are two queues, as
//! at a UART. While no program has the port open, frames are dropped: a cable that is pulled looks like that of a UART.
#![allow(unsafe_code)]

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Write};
use heapless::spsc::{Consumer, Producer, Queue};
use usb_device::bus::{UsbBus, UsbBusAllocator};
use usb_device::device::{
    StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid,
};
use usb_device::prelude::BuilderError;
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// Vendor and product that pid.codes keeps for tests of open projects.
const IDENTITY: UsbVidPid = UsbVidPid(0x1209, 0x0001);

/// Largest packet at full speed, bytes.
const PACKET: u16 = 64;

/// Bytes that are sent in a packet at most. One less than the largest: a shorter packet ends a transfer, and the host hands its bytes on.
const SENT: usize = PACKET as usize - 1;

/// Places of a queue; one stays empty. A queue that has no room for a packet makes the host wait.
const BYTES: usize = 512;

/// Digits of a chip's number.
const DIGITS: usize = 24;

/// Memory of the line: both queues, the chip's number as text, and the controller.
pub struct UsbMemory<B: UsbBus + 'static> {
    received: Queue<u8, BYTES>,
    to_send: Queue<u8, BYTES>,
    number: [u8; DIGITS],
    bus: Option<UsbBusAllocator<B>>,
}

impl<B: UsbBus> UsbMemory<B> {
    /// Empty.
    #[expect(clippy::new_without_default, reason = "a constant of a static")]
    pub const fn new() -> Self {
        Self {
            received: Queue::new(),
            to_send: Queue::new(),
            number: [0; DIGITS],
            bus: None,
        }
    }

    /// Starts the device: the host sees it from here on. `number` is that of the chip, by which a host tells its
    /// boards apart; `interrupt` is that of the controller.
    ///
    /// # Errors
    /// Texts or packets that the device does not take.
    pub fn start<I: InterruptNumber>(
        &'static mut self,
        bus: UsbBusAllocator<B>,
        number: Option<[u32; 3]>,
        interrupt: I,
    ) -> Result<UsbParts<B, I>, BuilderError> {
        let bus = &*self.bus.insert(bus);
        let digits = &mut self.number;
        let number = number.and_then(|words| in_digits(words, digits));
        let port = CdcAcmClass::new(bus, PACKET);
        let mut texts = StringDescriptors::default()
            .manufacturer("trirrr")
            .product("trirrr");
        if let Some(number) = number {
            texts = texts.serial_number(number);
        }
        let device = UsbDeviceBuilder::new(bus, IDENTITY)
            .strings(&[texts])?
            // A packet for each part of the enumeration: fewer runs of the interrupt.
            .max_packet_size_0(PACKET as u8)?
            .device_class(USB_CLASS_CDC)
            // Motors have a supply of their own, and so may the board.
            .self_powered(true)
            .build();
        let (received, bytes) = self.received.split();
        let (frames, to_send) = self.to_send.split();
        let line = UsbLine {
            device,
            port,
            received,
            to_send,
            packet: [0; SENT],
            length: 0,
            interrupt,
        };
        let transmitter = UsbTransmitter {
            frames,
            uncalled: 0,
            interrupt,
        };
        Ok(UsbParts {
            line,
            bytes,
            transmitter,
        })
    }
}

/// Parts of a line over USB.
pub struct UsbParts<B: UsbBus + 'static, I> {
    /// That of the interrupt.
    pub line: UsbLine<B, I>,
    /// Received bytes, for the background.
    pub bytes: Consumer<'static, u8>,
    /// Transmitter, for the background.
    pub transmitter: UsbTransmitter<I>,
}

/// Writes a number as hexadecimal digits, the first word first.
fn in_digits(words: [u32; 3], digits: &mut [u8; DIGITS]) -> Option<&str> {
    let nibbles = words
        .into_iter()
        .flat_map(|word| (0..8).rev().map(move |place| word >> (4 * place) & 0xf));
    for (digit, nibble) in digits.iter_mut().zip(nibbles) {
        *digit = b"0123456789ABCDEF"[nibble as usize];
    }
    core::str::from_utf8(digits).ok()
}

/// Goes on after a queue that had no room: for the background.
pub fn resume(interrupt: impl InterruptNumber) {
    if !NVIC::is_enabled(interrupt) {
        // SAFETY: the interrupt shares both queues with the background, and no more; nobody masks it to be alone.
        unsafe { NVIC::unmask(interrupt) };
        NVIC::pend(interrupt);
    }
}

/// Part of the line in the controller's interrupt.
pub struct UsbLine<B: UsbBus + 'static, I> {
    device: UsbDevice<'static, B>,
    port: CdcAcmClass<'static, B>,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
    /// Bytes for the next packet, and how many.
    packet: [u8; SENT],
    length: usize,
    interrupt: I,
}

impl<B: UsbBus, I: InterruptNumber> UsbLine<B, I> {
    /// Handles an event of the controller: at most one packet in each direction.
    pub fn run(&mut self) {
        self.device.poll(&mut [&mut self.port]);
        match self.is_open() {
            true => self.send(),
            false => self.drop_frames(),
        }
        if !self.receive() {
            // The controller repeats its interrupt until the packet is taken, and would leave no time to the background.
            NVIC::mask(self.interrupt);
        }
    }

    /// Returns true while a host has chosen the configuration, and has not let the bus rest, as without a cable.
    pub fn is_configured(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured
    }

    /// Returns true while a program has the port open, and the bus does not rest.
    fn is_open(&self) -> bool {
        self.is_configured() && self.port.dtr()
    }

    fn drop_frames(&mut self) {
        self.length = 0;
        while self.to_send.dequeue().is_some() {}
    }

    fn send(&mut self) {
        while let Some(place) = self.packet.get_mut(self.length)
            && let Some(byte) = self.to_send.dequeue()
        {
            *place = byte;
            self.length += 1;
        }
        let packet = self.packet.get(..self.length).unwrap_or_default();
        // Without success the packet before is under way, and its end calls this again.
        if !packet.is_empty() && self.port.write_packet(packet).is_ok() {
            self.length = 0;
        }
    }

    /// Takes a packet. Returns `false` if the queue has no room for one: the host waits.
    fn receive(&mut self) -> bool {
        let mut packet = [0; PACKET as usize];
        let room = |queue: &Producer<u8>| queue.capacity() - queue.len() >= packet.len();
        if !room(&self.received) {
            return false;
        }
        let length = self.port.read_packet(&mut packet).unwrap_or(0);
        for byte in packet.iter().take(length) {
            // There is room.
            let _ = self.received.enqueue(*byte);
        }
        true
    }
}

/// Transmitter of the line, for the background.
pub struct UsbTransmitter<I> {
    frames: Producer<'static, u8>,
    /// Bytes since the interrupt was called.
    uncalled: usize,
    interrupt: I,
}

impl<I> ErrorType for UsbTransmitter<I> {
    type Error = ErrorKind;
}

impl<I: InterruptNumber> Write<u8> for UsbTransmitter<I> {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        self.frames
            .enqueue(byte)
            .map_err(|_| nb::Error::WouldBlock)?;
        self.uncalled += 1;
        // The end of a frame, or a packet that is full: a call for each byte would be a packet for each byte.
        if byte == 0 || self.uncalled == SENT {
            self.uncalled = 0;
            NVIC::pend(self.interrupt);
        }
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        match self.frames.len() {
            0 => Ok(()),
            _ => Err(nb::Error::WouldBlock),
        }
    }
}
