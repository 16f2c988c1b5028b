//! USB device at full speed of the STM32G474: registers of endpoints with bits that toggle, and the packet memory (RM0440, chapter 45).

use super::{Answer, BusSignal, UsbController, UsbPacket};

const ENDPOINTS: usize = 8;

/// Bytes of the packet memory.
const MEMORY: usize = 1024;

/// Control register: reset of the controller, transceiver off, forced suspend.
const FORCED_RESET: u32 = 1 << 0;
const POWER_DOWN: u32 = 1 << 1;
const FORCED_SUSPEND: u32 = 1 << 3;

/// Flags, in the interrupt status and in its masks.
const FRAME: u32 = 1 << 9;
const RESET: u32 = 1 << 10;
const SUSPEND: u32 = 1 << 11;
const WAKE_UP: u32 = 1 << 12;
const TRANSFER: u32 = 1 << 15;

/// Flags that a program clears by zeros.
const CLEARED: u32 = 0x7F80;

/// Register of an endpoint: what is written as it is, what toggles by ones, what zeros clear.
const PLAIN: u32 = 0x070F;
const TOGGLED: u32 = 0x7070;
const SENT: u32 = 1 << 7;
const RECEIVED: u32 = 1 << 15;
const SET_UP: u32 = 1 << 11;

/// Toggles of both directions.
const ODD_SENT: u32 = 1 << 6;
const ODD_RECEIVED: u32 = 1 << 14;

/// States of a direction.
const STALL: u32 = 1;
const NOT_NOW: u32 = 2;
const VALID: u32 = 3;

/// Interrupt `USB_LP`.
const INTERRUPT: u16 = 20;

/// The controller.
pub(crate) struct UsbFs {
    endpoints: [u32; ENDPOINTS],
    control: u32,
    status: u32,
    frame: u16,
    address: u32,
    table: u32,
    pull_up: u32,
    memory: [u8; MEMORY],
    misuses: Vec<String>,
}

/// Direction of a transfer, as the place of its state in the register of an endpoint.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    ToHost = 4,
    ToDevice = 12,
}

impl UsbFs {
    pub(crate) fn new() -> Self {
        Self {
            endpoints: [0; ENDPOINTS],
            control: FORCED_RESET | POWER_DOWN,
            status: 0,
            frame: 0,
            address: 0,
            table: 0,
            pull_up: 0,
            // Noise, as that of a RAM.
            memory: [0xA5; MEMORY],
            misuses: Vec::new(),
        }
    }

    fn state(&self, index: usize, way: Way) -> u32 {
        self.endpoints[index] >> way as u32 & 3
    }

    fn set_state(&mut self, index: usize, way: Way, state: u32) {
        self.endpoints[index] &= !(3 << way as u32);
        self.endpoints[index] |= state << way as u32;
    }

    /// Returns the register that answers to an endpoint of this device.
    fn index(&self, address: u8, endpoint: u8) -> Option<usize> {
        let is_on = self.control & (FORCED_RESET | POWER_DOWN | FORCED_SUSPEND) == 0;
        if !is_on || self.address != 1 << 7 | u32::from(address) {
            return None;
        }
        self.endpoints
            .iter()
            .position(|register| register & 15 == u32::from(endpoint) && register & 0x3030 != 0)
    }

    fn half_word(&self, at: u32) -> u32 {
        let at = at as usize;
        match self.memory.get(at..at + 2) {
            Some(bytes) => u32::from(bytes[0]) | u32::from(bytes[1]) << 8,
            None => 0,
        }
    }

    /// Place of a half-word in the table of an endpoint's buffers.
    fn entry(&self, index: usize, word: u32) -> u32 {
        self.table + index as u32 * 8 + 2 * word
    }

    /// Puts a packet into the buffer of an endpoint. Returns false if it has no room.
    fn store(&mut self, index: usize, bytes: &[u8]) -> bool {
        let start = self.half_word(self.entry(index, 2)) as usize;
        let count_at = self.entry(index, 3);
        let count = self.half_word(count_at);
        let blocks = (count >> 10 & 0x1F) as usize;
        let room = match count >> 15 & 1 {
            0 => 2 * blocks,
            _ => 32 * (blocks + 1),
        };
        let place = self.memory.get_mut(start..start + bytes.len());
        let Some(place) = place.filter(|_| bytes.len() <= room) else {
            self.misuses.push(format!(
                "USB: a buffer of {room} bytes gets {}",
                bytes.len()
            ));
            return false;
        };
        place.copy_from_slice(bytes);
        let count = count & !0x3FF | bytes.len() as u32;
        self.write_packets(count_at, 2, count)
    }

    /// Flags with that of transfers, its endpoint and direction.
    fn flags(&self) -> u32 {
        let done = |register: &u32| register & (SENT | RECEIVED) != 0;
        let transfer = self.endpoints.iter().position(done).map_or(0, |index| {
            let came = self.endpoints[index] & RECEIVED != 0;
            TRANSFER | index as u32 | u32::from(came) << 4
        });
        self.status | transfer
    }
}

impl UsbController for UsbFs {
    fn interrupt(&self) -> u16 {
        INTERRUPT
    }

    fn interrupts(&self) -> bool {
        self.flags() & self.control & 0xFF80 != 0
    }

    fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00..=0x1C => self.endpoints[offset as usize / 4],
            0x40 => self.control,
            0x44 => self.flags(),
            0x48 => self.frame.into(),
            0x4C => self.address,
            0x50 => self.table,
            0x58 => self.pull_up,
            _ => return None,
        })
    }

    fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00..=0x1C => {
                let register = &mut self.endpoints[offset as usize / 4];
                let toggled = *register & TOGGLED ^ value & TOGGLED;
                let flags = *register & value & (SENT | RECEIVED);
                *register = *register & SET_UP | value & PLAIN | toggled | flags;
            }
            0x40 => {
                self.control = value & 0xFFBF;
                if value & FORCED_RESET != 0 {
                    self.status = 0;
                }
            }
            0x44 => self.status &= value | !CLEARED,
            0x4C => self.address = value & 0xFF,
            0x50 => self.table = value & 0xFFF8,
            0x58 => self.pull_up = value & 1 << 15,
            _ => return false,
        }
        true
    }

    fn read_packets(&self, offset: u32) -> Option<u32> {
        Some(self.half_word(offset) | self.half_word(offset + 2) << 16)
    }

    fn write_packets(&mut self, offset: u32, size: usize, value: u32) -> bool {
        // The memory is 16 bits wide.
        let at = offset as usize;
        match self.memory.get_mut(at..at + 2) {
            Some(place) if size == 2 => {
                place.copy_from_slice(&(value as u16).to_le_bytes());
                true
            }
            _ => false,
        }
    }

    fn pulls_up(&self) -> bool {
        self.control & POWER_DOWN == 0 && self.pull_up != 0
    }

    fn signal(&mut self, signal: BusSignal) {
        if self.control & (FORCED_RESET | POWER_DOWN) != 0 {
            return;
        }
        // Whatever happens on the bus wakes a suspended device.
        if self.control & FORCED_SUSPEND != 0 && signal != BusSignal::Suspend {
            self.status |= WAKE_UP;
        }
        match signal {
            BusSignal::ResetBegins => {
                self.status |= RESET;
                self.address = 0;
                for register in &mut self.endpoints {
                    *register &= SENT | RECEIVED;
                }
            }
            BusSignal::ResetEnds | BusSignal::Resume => {}
            BusSignal::Suspend if self.control & FORCED_SUSPEND != 0 => {}
            BusSignal::Suspend => self.status |= SUSPEND,
            BusSignal::Frame(number) => {
                self.status |= FRAME;
                self.frame = number;
            }
        }
    }

    fn set_up(&mut self, address: u8, packet: [u8; 8]) -> Answer {
        // A packet before that was not taken: this one gets no answer.
        let Some(index) = self
            .index(address, 0)
            .filter(|index| self.endpoints[*index] & RECEIVED == 0)
        else {
            return Answer::Silence;
        };
        if !self.store(index, &packet) {
            return Answer::Silence;
        }
        for way in [Way::ToHost, Way::ToDevice] {
            self.set_state(index, way, NOT_NOW);
        }
        self.endpoints[index] |= RECEIVED | SET_UP | ODD_SENT | ODD_RECEIVED;
        Answer::Taken
    }

    fn take(&mut self, address: u8, endpoint: u8, packet: &UsbPacket) -> Answer {
        let Some(index) = self.index(address, endpoint) else {
            return Answer::Silence;
        };
        match self.state(index, Way::ToDevice) {
            VALID => {}
            NOT_NOW => return Answer::NotNow,
            STALL => return Answer::Stall,
            _ => return Answer::Silence,
        }
        // A repetition, whose acknowledgement was lost.
        if (self.endpoints[index] & ODD_RECEIVED != 0) != packet.odd {
            return Answer::Taken;
        }
        if !self.store(index, &packet.bytes) {
            return Answer::Silence;
        }
        self.set_state(index, Way::ToDevice, NOT_NOW);
        self.endpoints[index] ^= ODD_RECEIVED;
        self.endpoints[index] = self.endpoints[index] & !SET_UP | RECEIVED;
        Answer::Taken
    }

    fn give(&mut self, address: u8, endpoint: u8) -> Answer {
        let Some(index) = self.index(address, endpoint) else {
            return Answer::Silence;
        };
        match self.state(index, Way::ToHost) {
            VALID => {}
            NOT_NOW => return Answer::NotNow,
            STALL => return Answer::Stall,
            _ => return Answer::Silence,
        }
        let start = self.half_word(self.entry(index, 0)) as usize;
        let count = (self.half_word(self.entry(index, 1)) & 0x3FF) as usize;
        let bytes = self.memory.get(start..start + count).unwrap_or_default();
        Answer::Packet(UsbPacket {
            bytes: bytes.to_vec(),
            odd: self.endpoints[index] & ODD_SENT != 0,
        })
    }

    fn acknowledge(&mut self, endpoint: u8) {
        let of = |register: &u32| register & 15 == u32::from(endpoint) && register & 0x30 != 0;
        if let Some(index) = self.endpoints.iter().position(of) {
            self.set_state(index, Way::ToHost, NOT_NOW);
            self.endpoints[index] ^= ODD_SENT;
            self.endpoints[index] |= SENT;
        }
    }

    fn misuses(&mut self) -> Vec<String> {
        std::mem::take(&mut self.misuses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Endpoint 1, with buffers of 64 bytes for both directions, of a device with address 7.
    fn started() -> UsbFs {
        let mut usb = UsbFs::new();
        usb.write(0x40, 1 << 15);
        usb.write(0x4C, 1 << 7 | 7);
        for (word, value) in [0x40, 3, 0x80, 0x8000 | 1 << 10].into_iter().enumerate() {
            assert!(usb.write_packets(8 + 2 * word as u32, 2, value));
        }
        usb.write(0x04, 1);
        usb
    }

    #[test]
    fn ones_toggle_states_and_zeros_clear_flags() {
        let mut usb = started();
        // Valid both: from disabled by toggling.
        usb.write(0x04, 1 | VALID << 4 | VALID << 12);
        assert_eq!(usb.read(0x04), Some(1 | VALID << 4 | VALID << 12));
        // Valid to not now, to the host alone; ones leave the flags.
        usb.write(0x04, 1 | SENT | RECEIVED | 1 << 4);
        assert_eq!(usb.read(0x04), Some(1 | NOT_NOW << 4 | VALID << 12));
    }

    #[test]
    fn a_packet_is_taken_once_and_the_next_one_waits() {
        let mut usb = started();
        usb.write(0x04, 1 | VALID << 12);
        let packet = UsbPacket {
            bytes: vec![1, 2, 3],
            odd: false,
        };
        assert_eq!(usb.take(6, 1, &packet), Answer::Silence);
        assert_eq!(usb.take(7, 1, &packet), Answer::Taken);
        assert!(usb.interrupts());
        assert_eq!(
            usb.read_packets(0x80).map(|word| word & 0xFF_FFFF),
            Some(0x03_0201)
        );
        assert_eq!(usb.read_packets(12).map(|word| word >> 16 & 0x3FF), Some(3));
        assert_eq!(usb.take(7, 1, &packet), Answer::NotNow);
        // Taken out by the program: a repetition is acknowledged and dropped.
        usb.write(0x04, 1 | 1 << 12);
        assert!(!usb.interrupts());
        assert_eq!(usb.take(7, 1, &packet), Answer::Taken);
        assert!(!usb.interrupts());
    }

    #[test]
    fn a_packet_to_the_host_is_one_until_it_is_acknowledged() {
        let mut usb = started();
        usb.write_packets(0x40, 2, 0x0201);
        usb.write_packets(0x42, 2, 0x03);
        usb.write(0x04, 1 | VALID << 4);
        let given = Answer::Packet(UsbPacket {
            bytes: vec![1, 2, 3],
            odd: false,
        });
        assert_eq!((usb.give(7, 1), usb.give(7, 1)), (given.clone(), given));
        usb.acknowledge(1);
        assert_eq!(usb.give(7, 1), Answer::NotNow);
        assert_eq!(usb.read(0x04), Some(1 | NOT_NOW << 4 | SENT | ODD_SENT));
    }
}
