//! Controllers of USB by their registers, as devices at full speed, and the clock of 48 MHz that they take.

mod device;
mod endpoint;
mod oscillator;
mod otg;

pub(super) use device::UsbFs;
pub(super) use oscillator::Hsi48;
pub(super) use otg::OtgFs;

use super::map::Place;
use super::{Chip, Kind, Mode};

/// Part of 12 Mbit/s by which a device at full speed may be off (USB 2.0, 7.1.11).
const RATE_ERROR: f64 = 0.0025;

/// D- and D+: pins of port A, and their alternate function in an STM32F405.
const PINS: [u8; 2] = [11, 12];
const FUNCTION: u8 = 10;

/// Registers that switch the controllers on and reset them, with their bits: of the STM32F405, of the STM32G474.
const CLOCKS: [(u32, u32); 2] = [(0x4002_3834, 1 << 7), (0x4002_1058, 1 << 23)];
const RESETS: [(u32, u32); 2] = [(0x4002_3814, 1 << 7), (0x4002_1038, 1 << 23)];

/// Numbers of both chips, three words.
const NUMBERS: [u32; 2] = [0x1FFF_7A10, 0x1FFF_7590];

/// CCIPR of the STM32G474: bits 26 and 27 choose the clock of 48 MHz.
const CLOCK_SOURCES: u32 = 0x4002_1088;

/// Number of the clocks' register with the oscillator of 48 MHz, behind those of the CRS.
const CRRCR: u32 = 0x4002_1098;

/// Signal of the bus, which is no packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BusSignal {
    ResetBegins,
    ResetEnds,
    /// A bus at rest for 3 ms.
    Suspend,
    Resume,
    /// Begin of a frame, with its number.
    Frame(u16),
}

/// Packet with its toggle: DATA1 is odd.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct UsbPacket {
    pub(crate) bytes: Vec<u8>,
    pub(crate) odd: bool,
}

/// Answer of a device to a token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// None: the token was for another one, or was not understood.
    Silence,
    NotNow,
    Stall,
    Taken,
    Packet(UsbPacket),
}

/// Controller as the bus and the chip see it.
pub(crate) trait UsbController {
    /// Number of its interrupt.
    fn interrupt(&self) -> u16;

    /// Returns true while that interrupt is asked for.
    fn interrupts(&self) -> bool;

    /// Reads a register.
    fn read(&mut self, offset: u32) -> Option<u32>;

    /// Writes a register.
    fn write(&mut self, offset: u32, value: u32) -> bool;

    /// Reads a word of the packet memory, if there is one.
    fn read_packets(&self, _: u32) -> Option<u32> {
        None
    }

    /// Writes to the packet memory so many bytes.
    fn write_packets(&mut self, _: u32, _: usize, _: u32) -> bool {
        false
    }

    /// Returns true while the device pulls D+ up.
    fn pulls_up(&self) -> bool;

    /// Takes a signal.
    fn signal(&mut self, signal: BusSignal);

    /// Takes the packet of a control transfer that begins.
    fn set_up(&mut self, address: u8, packet: [u8; 8]) -> Answer;

    /// Takes a packet.
    fn take(&mut self, address: u8, endpoint: u8, packet: &UsbPacket) -> Answer;

    /// Gives a packet.
    fn give(&mut self, address: u8, endpoint: u8) -> Answer;

    /// The host has acknowledged the packet that was given.
    fn acknowledge(&mut self, endpoint: u8);

    /// Takes out what the program has done against the manual.
    fn misuses(&mut self) -> Vec<String> {
        Vec::new()
    }
}

/// Returns the controller of a chip as in a reset.
pub(super) fn controller(kind: Kind) -> Box<dyn UsbController> {
    match kind {
        Kind::Stm32f405 => Box::new(OtgFs::new()),
        Kind::Stm32g474 => Box::new(UsbFs::new()),
    }
}

/// Returns the place of an address that belongs to USB, or to the number by which a host tells boards apart.
pub(super) fn place(kind: Kind, address: u32) -> Option<Place> {
    let within = |start: u32, bytes: u32| {
        (start..start + bytes)
            .contains(&address)
            .then(|| address - start)
    };
    if let Some(offset) = within(NUMBERS[kind as usize], 12) {
        return Some(Place::Number(offset / 4));
    }
    match kind {
        Kind::Stm32f405 => within(0x5000_0000, 0x2_0000).map(Place::Usb),
        Kind::Stm32g474 => within(0x4000_5C00, 0x5C)
            .map(Place::Usb)
            .or(within(0x4000_6000, 0x400).map(Place::Packets))
            .or(within(0x4000_2000, 0x10).map(Place::Trimming))
            .or(within(CRRCR, 4).map(|_| Place::Trimming(oscillator::CRRCR))),
    }
}

impl Chip {
    /// Returns true if the controller has its clock of registers.
    pub(super) fn has_usb(&self) -> bool {
        let (address, bit) = CLOCKS[self.kind as usize];
        self.held.get(&address).copied().unwrap_or(0) & bit != 0
    }

    /// Returns true if a write of `value` resets the controller.
    pub(super) fn resets_usb(&self, address: u32, value: u32) -> bool {
        let (of, bit) = RESETS[self.kind as usize];
        address == of && value & bit != 0
    }

    /// Returns true if the pins belong to the controller. In an STM32G474 the controller takes them by itself.
    fn has_usb_pins(&self) -> bool {
        self.kind == Kind::Stm32g474
            || PINS
                .iter()
                .all(|pin| self.ports[0].mode(*pin) == Mode::Alternate(FUNCTION))
    }

    /// Returns true if the bit rate of the device is exact enough for a host.
    fn has_usb_rate(&self) -> bool {
        let by_pll = self.clock.usb_error(self.now);
        let error = match self.kind {
            Kind::Stm32f405 => by_pll,
            Kind::Stm32g474 => {
                match self.held.get(&CLOCK_SOURCES).copied().unwrap_or(0) >> 26 & 3 {
                    0 => self.oscillator.error(self.now),
                    _ => None,
                }
            }
        };
        error.is_some_and(|error| error.abs() <= RATE_ERROR)
    }

    /// Lets the bus of USB go on to the present time.
    pub(super) fn advance_usb(&mut self) {
        while let Some(host) = &self.plug
            && host.next() <= self.now
        {
            let is_on = self.has_usb() && self.has_usb_pins() && self.usb.pulls_up();
            let hears = is_on && self.has_usb_rate();
            if let Some(host) = &mut self.plug {
                let begins_frame = host.step(&mut *self.usb, is_on, hears);
                if begins_frame && is_on {
                    self.oscillator.follow();
                }
            }
        }
        self.unknown.extend(self.usb.misuses());
    }
}
