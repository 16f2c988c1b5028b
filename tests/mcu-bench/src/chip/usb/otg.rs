//! OTG controller at full speed of the STM32F405, as a device (RM0090, chapter 34): FIFOs that the program reads and writes.

use super::endpoint::{
    ACTIVE, COMPLETE, EMPTY, HalfEndpoint, NO_DATA, ON, REFUSES, SET_UP_DONE, STALLS,
};
use super::{Answer, BusSignal, UsbController, UsbPacket};
use std::collections::VecDeque;

const ENDPOINTS: usize = 4;

/// Words of the FIFOs together.
const WORDS: u32 = 320;

/// Flags of the core interrupt.
const FRAME: u32 = 1 << 3;
const RECEIVED: u32 = 1 << 4;
const SUSPEND: u32 = 1 << 11;
const RESET: u32 = 1 << 12;
const ENUMERATED: u32 = 1 << 13;
const OF_INS: u32 = 1 << 18;
const OF_OUTS: u32 = 1 << 19;
const WAKE_UP: u32 = 1 << 31;

/// Kinds of entries in the FIFO of the receiver.
const DATA: u32 = 2;
const DATA_DONE: u32 = 3;
const SET_UP_IS_DONE: u32 = 4;
const SET_UP: u32 = 6;

/// Words that are kept free for packets that begin control transfers, if nothing else is there.
const KEPT: u32 = 10;

/// Revision of the core in an STM32F405.
const REVISION: u32 = 0x1200;

/// Interrupt `OTG_FS`.
const INTERRUPT: u16 = 67;

/// Entry of the receiver's FIFO.
#[derive(Clone, Debug)]
struct ReceiverEntry {
    status: u32,
    words: VecDeque<u32>,
}

/// The controller.
pub(crate) struct OtgFs {
    bus: u32,
    settings: u32,
    status: u32,
    mask: u32,
    /// Words of the receiver's FIFO, and place and words of those to the host.
    receiver_words: u32,
    places: [u32; ENDPOINTS],
    power: u32,
    device: u32,
    control: u32,
    in_mask: u32,
    out_mask: u32,
    endpoints_mask: u32,
    empty_mask: u32,
    gates: u32,
    session: u32,
    received: VecDeque<ReceiverEntry>,
    /// Words of the packet that was taken out last.
    words: VecDeque<u32>,
    ins: [HalfEndpoint; ENDPOINTS],
    outs: [HalfEndpoint; ENDPOINTS],
    /// Address that counts until the end of the transfer that sets another.
    address: u8,
    in_transfer: bool,
    /// The first packet of a control transfer is there, and its second has not begun.
    is_setting_up: bool,
    suspended: bool,
    frame: u16,
    misuses: Vec<String>,
}

impl OtgFs {
    pub(crate) fn new() -> Self {
        let mut otg = Self {
            bus: 0,
            settings: 0xA00,
            status: 0,
            mask: 0,
            receiver_words: 0x200,
            places: [0x200_0200; ENDPOINTS],
            power: 0,
            device: 0x220_0000,
            control: 0,
            in_mask: 0,
            out_mask: 0,
            endpoints_mask: 0,
            empty_mask: 0,
            gates: 0,
            session: 0,
            received: VecDeque::new(),
            words: VecDeque::new(),
            ins: Default::default(),
            outs: Default::default(),
            address: 0,
            in_transfer: false,
            is_setting_up: false,
            suspended: false,
            frame: 0,
            misuses: Vec::new(),
        };
        otg.ins[0].control = ACTIVE;
        otg.outs[0].control = ACTIVE;
        otg
    }

    /// The core's own reset. It leaves the transceiver and the mode as they are.
    fn restart(&mut self) {
        *self = Self {
            settings: self.settings,
            power: self.power,
            device: self.device & 3,
            gates: self.gates,
            misuses: std::mem::take(&mut self.misuses),
            ..Self::new()
        };
    }

    fn is_addressed(&self, address: u8) -> bool {
        !self.suspended && address == self.address
    }

    /// Words that wait in the receiver's FIFO.
    fn waiting(&self) -> u32 {
        let entries = self
            .received
            .iter()
            .map(|entry| 1 + entry.words.len() as u32);
        entries.sum::<u32>() + self.words.len() as u32
    }

    /// Returns true if a packet fits into the receiver's FIFO, with its status and that of its end.
    fn has_room(&self, bytes: usize) -> bool {
        let words = bytes.div_ceil(4) as u32 + 2;
        self.waiting() + words + KEPT <= self.receiver_words.min(WORDS)
    }

    fn enter(&mut self, endpoint: usize, kind: u32, odd: bool, bytes: &[u8]) {
        let toggle = if odd { 2 << 15 } else { 0 };
        let word = |bytes: &[u8]| {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            u32::from_le_bytes(word)
        };
        self.received.push_back(ReceiverEntry {
            status: endpoint as u32 | (bytes.len() as u32) << 4 | toggle | kind << 17,
            words: bytes.chunks(4).map(word).collect(),
        });
    }

    /// The second packet of a control transfer begins.
    fn end_set_up(&mut self, endpoint: usize) {
        if endpoint == 0 && std::mem::take(&mut self.is_setting_up) {
            self.enter(0, SET_UP_IS_DONE, false, &[]);
        }
    }

    /// Takes an entry out of the receiver's FIFO: its status.
    fn pop(&mut self) -> u32 {
        if !self.words.is_empty() {
            let left = self.words.len();
            self.misuses
                .push(format!("USB: {left} words of a packet were not read"));
        }
        let Some(ReceiverEntry { status, words }) = self.received.pop_front() else {
            // The core ignores that: the driver reads a FIFO which it has just emptied in a reset.
            return 0;
        };
        self.words = words;
        let out = &mut self.outs[(status & 3) as usize];
        match status >> 17 & 15 {
            DATA_DONE => {
                out.control &= !ON;
                out.flags |= COMPLETE;
            }
            SET_UP_IS_DONE => {
                out.control &= !ON;
                out.flags |= SET_UP_DONE;
            }
            _ => {}
        }
        status
    }

    fn room(&self, index: usize) -> u32 {
        (self.places[index] >> 16).saturating_sub(self.ins[index].fifo.len() as u32)
    }

    /// Flags of the endpoints that ask, those to the device from bit 16 on.
    fn asking(&self) -> u32 {
        let bits = |halves: &[HalfEndpoint; ENDPOINTS], mask: u32| {
            let asks = |half: &HalfEndpoint| half.flags & mask != 0;
            (0..ENDPOINTS).fold(0, |bits, index| {
                bits | u32::from(asks(&halves[index])) << index
            })
        };
        let empty = (0..ENDPOINTS).fold(0, |bits, index| {
            let is_empty = self.ins[index].fifo.is_empty();
            bits | u32::from(is_empty) << index
        });
        bits(&self.ins, self.in_mask)
            | empty & self.empty_mask
            | bits(&self.outs, self.out_mask) << 16
    }

    fn flags(&self) -> u32 {
        let asking = self.asking() & self.endpoints_mask;
        let flag = |is: bool, bit: u32| if is { bit } else { 0 };
        self.status
            | flag(!self.received.is_empty(), RECEIVED)
            | flag(asking & 0xFFFF != 0, OF_INS)
            | flag(asking >> 16 != 0, OF_OUTS)
    }

    fn read_endpoint(&self, offset: u32) -> Option<u32> {
        let (half, index) = match offset {
            0x900..0x980 => (&self.ins, (offset - 0x900) as usize / 0x20),
            0xB00..0xB80 => (&self.outs, (offset - 0xB00) as usize / 0x20),
            _ => return None,
        };
        let is_in = offset < 0xB00;
        let half = &half[index];
        Some(match offset % 0x20 {
            0x00 => half.read(),
            0x08 if is_in && half.fifo.is_empty() => half.flags | EMPTY,
            0x08 => half.flags,
            0x10 => half.size,
            0x18 if is_in => self.room(index),
            _ => return None,
        })
    }

    fn write_endpoint(&mut self, offset: u32, value: u32) -> bool {
        let (half, index) = match offset {
            0x900..0x980 => (&mut self.ins, (offset - 0x900) as usize / 0x20),
            0xB00..0xB80 => (&mut self.outs, (offset - 0xB00) as usize / 0x20),
            _ => return false,
        };
        let half = &mut half[index];
        match offset % 0x20 {
            0x00 => half.write(index, value),
            0x08 => half.flags &= !value,
            0x10 => half.size = value & 0x1FFF_FFFF,
            _ => return false,
        }
        true
    }

    /// Puts a word into the FIFO of an endpoint.
    fn push(&mut self, index: usize, word: u32) -> bool {
        if index >= ENDPOINTS {
            return false;
        }
        if self.room(index) == 0 {
            self.misuses
                .push(format!("USB: the FIFO of endpoint {index} has no room"));
        }
        self.ins[index].fifo.push_back(word);
        true
    }

    fn flush(&mut self, value: u32) {
        if value & 1 << 4 != 0 {
            self.received.clear();
            self.words.clear();
        }
        if value & 1 << 5 != 0 {
            let number = value >> 6 & 31;
            for (index, half) in self.ins.iter_mut().enumerate() {
                if number == 16 || number as usize == index {
                    half.fifo.clear();
                }
            }
        }
    }
}

impl UsbController for OtgFs {
    fn interrupt(&self) -> u16 {
        INTERRUPT
    }

    fn interrupts(&self) -> bool {
        self.bus & 1 != 0 && self.flags() & self.mask != 0
    }

    fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x000 => self.session,
            0x008 => self.bus,
            0x00C => self.settings,
            // The bus is idle, and resets and flushes are over at once.
            0x010 => 1 << 31,
            0x014 => self.flags(),
            0x018 => self.mask,
            0x01C => self.received.front().map_or(0, |entry| entry.status),
            0x020 => self.pop(),
            0x024 => self.receiver_words,
            0x028 => self.places[0],
            0x038 => self.power,
            0x03C => REVISION,
            0x104 | 0x108 | 0x10C => self.places[(offset as usize - 0x100) / 4],
            0x800 => self.device,
            0x804 => self.control,
            // Full speed.
            0x808 => u32::from(self.suspended) | 3 << 1 | u32::from(self.frame) << 8,
            0x810 => self.in_mask,
            0x814 => self.out_mask,
            0x818 => self.asking(),
            0x81C => self.endpoints_mask,
            0x834 => self.empty_mask,
            0xE00 => self.gates,
            0x1000..0x2_0000 => match self.words.pop_front() {
                Some(word) => word,
                None => {
                    self.misuses
                        .push("USB: a read beyond the end of a packet".into());
                    0
                }
            },
            _ => return self.read_endpoint(offset),
        })
    }

    fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x000 => self.session = value,
            0x008 => self.bus = value,
            0x00C => self.settings = value,
            0x010 if value & 1 != 0 => self.restart(),
            0x010 => self.flush(value),
            0x014 => self.status &= !value,
            0x018 => self.mask = value,
            0x024 => self.receiver_words = value & 0xFFFF,
            0x028 => self.places[0] = value,
            0x038 => self.power = value,
            0x104 | 0x108 | 0x10C => self.places[(offset as usize - 0x100) / 4] = value,
            0x800 => {
                self.device = value;
                // In a transfer it counts from its end on.
                if !self.in_transfer {
                    self.address = (value >> 4 & 0x7F) as u8;
                }
            }
            0x804 => self.control = value & 0x7F,
            0x810 => self.in_mask = value,
            0x814 => self.out_mask = value,
            0x81C => self.endpoints_mask = value,
            0x834 => self.empty_mask = value,
            0xE00 => self.gates = value,
            0x1000..0x2_0000 => return self.push(offset as usize / 0x1000 - 1, value),
            _ => return self.write_endpoint(offset, value),
        }
        true
    }

    fn pulls_up(&self) -> bool {
        // Forced to be a device, transceiver on, the voltage of the cable not asked for, not disconnected.
        self.settings & 1 << 30 != 0
            && self.power & (1 << 16 | 1 << 21) == 1 << 16 | 1 << 21
            && self.control & 1 << 1 == 0
    }

    fn signal(&mut self, signal: BusSignal) {
        match signal {
            BusSignal::ResetBegins => {
                self.status |= RESET;
                self.suspended = false;
                self.in_transfer = false;
                self.is_setting_up = false;
                for half in self.ins[1..].iter_mut().chain(&mut self.outs[1..]) {
                    half.control &= !ACTIVE;
                }
            }
            BusSignal::ResetEnds => self.status |= ENUMERATED,
            BusSignal::Suspend => {
                self.suspended = true;
                self.status |= SUSPEND;
            }
            BusSignal::Resume => {
                self.suspended = false;
                self.status |= WAKE_UP;
            }
            BusSignal::Frame(number) => {
                self.frame = number;
                self.status |= FRAME;
            }
        }
    }

    fn set_up(&mut self, address: u8, packet: [u8; 8]) -> Answer {
        if !self.is_addressed(address) || self.waiting() + 4 > self.receiver_words.min(WORDS) {
            return Answer::Silence;
        }
        self.enter(0, SET_UP, false, &packet);
        self.is_setting_up = true;
        self.in_transfer = true;
        for half in [&mut self.ins[0], &mut self.outs[0]] {
            half.control = half.control & !STALLS | REFUSES;
            half.is_odd = true;
        }
        Answer::Taken
    }

    fn take(&mut self, address: u8, endpoint: u8, packet: &UsbPacket) -> Answer {
        let index = usize::from(endpoint);
        if !self.is_addressed(address) || index >= ENDPOINTS {
            return Answer::Silence;
        }
        self.end_set_up(index);
        if let Some(refusal) = self.outs[index].refusal() {
            return refusal;
        }
        if !self.has_room(packet.bytes.len()) {
            return Answer::NotNow;
        }
        // A repetition, whose acknowledgement was lost.
        if self.outs[index].is_odd != packet.odd {
            return Answer::Taken;
        }
        self.enter(index, DATA, packet.odd, &packet.bytes);
        let out = &mut self.outs[index];
        let bytes = packet.bytes.len() as u32;
        let is_short = bytes < out.most_bytes(index);
        if out.count(bytes) || is_short {
            out.control |= REFUSES;
            self.enter(index, DATA_DONE, packet.odd, &[]);
        }
        if index == 0 && bytes == 0 {
            self.in_transfer = false;
        }
        Answer::Taken
    }

    fn give(&mut self, address: u8, endpoint: u8) -> Answer {
        let index = usize::from(endpoint);
        if !self.is_addressed(address) || index >= ENDPOINTS {
            return Answer::Silence;
        }
        self.end_set_up(index);
        let half = &mut self.ins[index];
        if let Some(refusal) = half.refusal() {
            return refusal;
        }
        let bytes = half.bytes().min(half.most_bytes(index)) as usize;
        if half.fifo.len() < bytes.div_ceil(4) {
            half.flags |= NO_DATA;
            return Answer::NotNow;
        }
        let words = half.fifo.iter().flat_map(|word| word.to_le_bytes());
        Answer::Packet(UsbPacket {
            bytes: words.take(bytes).collect(),
            odd: half.is_odd,
        })
    }

    fn acknowledge(&mut self, endpoint: u8) {
        let index = usize::from(endpoint);
        let half = &mut self.ins[index];
        let bytes = half.bytes().min(half.most_bytes(index));
        half.fifo.drain(..bytes.div_ceil(4) as usize);
        if half.count(bytes) {
            half.control &= !ON;
            half.flags |= COMPLETE;
        }
        // An empty packet ends a transfer to the device: now its new address counts.
        if index == 0 && bytes == 0 && std::mem::take(&mut self.in_transfer) {
            self.address = (self.device >> 4 & 0x7F) as u8;
        }
    }

    fn misuses(&mut self) -> Vec<String> {
        std::mem::take(&mut self.misuses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::usb::endpoint::{CLEAR_REFUSAL, EVEN, SET_REFUSAL};

    /// With endpoint 1 on in both directions, and the address 0.
    fn started() -> OtgFs {
        let mut otg = OtgFs::new();
        for (offset, value) in [
            (0x024, 64),
            (0x104, 16 << 16 | 80),
            (0x810, COMPLETE),
            (0x81C, 0xFFFF),
            (0x018, RECEIVED | OF_INS),
            (0x008, 1),
            (0xB20, ON | CLEAR_REFUSAL | EVEN | ACTIVE | 64),
            (0x920, SET_REFUSAL | EVEN | ACTIVE | 64),
        ] {
            assert!(otg.write(offset, value), "{offset:#x}");
        }
        otg
    }

    #[test]
    fn a_packet_comes_as_status_words_and_end() {
        let mut otg = started();
        let packet = UsbPacket {
            bytes: vec![1, 2, 3, 4, 5],
            odd: false,
        };
        assert_eq!(otg.take(0, 1, &packet), Answer::Taken);
        // Before the program has taken the end out, the endpoint refuses.
        assert_eq!(otg.take(0, 1, &packet), Answer::NotNow);
        assert!(otg.interrupts());
        assert_eq!(otg.read(0x01C), Some(1 | 5 << 4 | DATA << 17));
        assert_eq!(otg.read(0x020), Some(1 | 5 << 4 | DATA << 17));
        assert_eq!(
            (otg.read(0x1000), otg.read(0x1000)),
            (Some(0x0403_0201), Some(5))
        );
        assert_eq!(otg.read(0x020), Some(1 | DATA_DONE << 17));
        assert!(!otg.interrupts() && otg.misuses().is_empty());
        otg.read(0x1000);
        assert_eq!(otg.misuses().len(), 1);
    }

    #[test]
    fn a_packet_to_the_host_needs_all_of_its_words() {
        let mut otg = started();
        otg.write(0x930, 1 << 19 | 5);
        otg.write(0x920, ON | CLEAR_REFUSAL | ACTIVE | 64);
        otg.write(0x2000, 0x0403_0201);
        assert_eq!(otg.give(0, 1), Answer::NotNow);
        otg.write(0x2000, 5);
        assert_eq!(otg.read(0x938), Some(14));
        let given = Answer::Packet(UsbPacket {
            bytes: vec![1, 2, 3, 4, 5],
            odd: false,
        });
        assert_eq!(otg.give(0, 1), given);
        otg.acknowledge(1);
        assert!(otg.interrupts());
        assert_eq!(
            otg.read(0x920).map(|word| word & (ON | 1 << 16)),
            Some(1 << 16)
        );
        assert_eq!(otg.give(0, 1), Answer::NotNow);
    }

    #[test]
    fn an_address_counts_from_the_end_of_its_transfer_on() {
        let mut otg = started();
        assert_eq!(otg.set_up(0, [0, 5, 7, 0, 0, 0, 0, 0]), Answer::Taken);
        otg.write(0x800, 7 << 4);
        otg.write(0x910, 1 << 19);
        otg.write(0x900, ON | CLEAR_REFUSAL);
        let empty = UsbPacket {
            bytes: Vec::new(),
            odd: true,
        };
        assert_eq!(otg.give(0, 0), Answer::Packet(empty));
        otg.acknowledge(0);
        assert_eq!(otg.give(0, 0), Answer::Silence);
        assert_eq!(otg.give(7, 0), Answer::NotNow);
    }
}
