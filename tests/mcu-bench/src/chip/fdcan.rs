//! FDCAN1 (RM0440, chapter 44): three buffers out in the order of their requests, filters by identifier and mask, FIFO 0, counters of
//! errors, bus-off, and the message RAM.

use crate::bus::{BusEvent, CanBus, WireFrame};
use crate::time::{SECOND, Time};
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use trirrr_drives::can::{Moteus, length_code, length_of};

/// Interrupt of line 0.
pub(super) const IT0: u16 = 21;

const INITIALISE: u32 = 1;
/// Settings may be changed.
const CHANGE: u32 = 1 << 1;
/// Frames of CAN FD, and with another rate in the data.
const FLEXIBLE: u32 = 0b11 << 8;
const COMPENSATES: u32 = 1 << 23;

const NEW: u32 = 1;
const FULL: u32 = 1 << 1;
const LOST: u32 = 1 << 2;

/// Places of FIFO 0, and buffers of frames that go out.
const PLACES: usize = 3;

/// Words of the message RAM, and where its parts begin.
const WORDS: usize = 212;
const LONG_FILTERS: usize = 28;
const FIFO: usize = 44;
const BUFFERS: usize = 158;
/// Words of a frame.
const FRAME: usize = 18;

/// Error counters at which the controller is passive, and off.
const PASSIVE: u32 = 128;
const OFF: u32 = 256;

/// Bits of silence after which the controller takes part, and after which one that is off is back: 128 times.
const SILENCE: Time = 11;

/// Parts of a bit rate by which the controller's may be off that of the drives.
const RATE_ERROR: f64 = 0.005;

#[derive(Clone, Debug)]
pub(crate) struct FdCan {
    control: u32,
    nominal: u32,
    data: u32,
    compensation: u32,
    flags: u32,
    enabled: u32,
    lines: u32,
    filter_control: u32,
    ram: [u32; WORDS],
    /// Frames in FIFO 0, and the place of the first.
    filled: usize,
    first: usize,
    /// Buffers with a request in the order of the requests, and those that are to be cancelled.
    requested: Vec<usize>,
    cancelled: u32,
    next_buffer: usize,
    transmit_errors: u32,
    /// Time from which on the controller takes part; none in initialisation and off the bus.
    on_since: Option<Time>,
    is_off: bool,
    /// Times that the controller has gone off the bus.
    pub(crate) offs: u32,
}

impl FdCan {
    pub(crate) fn new() -> Self {
        Self {
            control: INITIALISE,
            nominal: 0x0600_0A03,
            data: 0x0000_0A33,
            compensation: 0,
            flags: 0,
            enabled: 0,
            lines: 0,
            filter_control: 0,
            // A reset leaves the RAM as it is: noise.
            ram: [0xA5A5_A5A5; WORDS],
            filled: 0,
            first: 0,
            requested: Vec::new(),
            cancelled: 0,
            next_buffer: 0,
            transmit_errors: 0,
            on_since: None,
            is_off: false,
            offs: 0,
        }
    }

    /// Returns the rates of bits outside and in the data for a clock of this period, Hz.
    fn bit_rates_hz(&self, clock: Time) -> [f64; 2] {
        let field =
            |word: u32, bit: u32, bits: u32| Time::from(word >> bit & ((1 << bits) - 1)) + 1;
        let (nominal, data) = (self.nominal, self.data);
        let quanta = 1 + field(nominal, 8, 8) + field(nominal, 0, 7);
        let quanta_of_data = 1 + field(data, 8, 5) + field(data, 4, 4);
        [
            SECOND as f64 / (clock * field(nominal, 16, 9) * quanta) as f64,
            SECOND as f64 / (clock * field(data, 16, 5) * quanta_of_data) as f64,
        ]
    }

    fn bit(&self, clock: Time) -> Time {
        let [nominal, _] = self.bit_rates_hz(clock);
        (SECOND as f64 / nominal) as Time
    }

    /// Returns true if the controller reads the bits on the bus, and its own: at 5 Mbit/s a transceiver delays them by more than half
    /// of one.
    fn understands(&self, clock: Time, bus: &dyn CanBus) -> bool {
        let [nominal, data] = self.bit_rates_hz(clock);
        let off = |rate: f64, of: u32| (rate / f64::from(of) - 1.0).abs() > RATE_ERROR;
        if off(nominal, bus.bit_rate_hz()) {
            return false;
        }
        // In quanta of the clock: where the sample of the data is.
        let sample = ((self.data >> 16 & 31) + 1) * ((self.data >> 8 & 31) + 2);
        self.control & FLEXIBLE == 0
            || !off(data, Moteus::DATA_RATE_HZ)
                && self.data & COMPENSATES != 0
                && self.compensation >> 8 & 0x7F == sample
    }

    fn is_on(&self, now: Time) -> bool {
        self.on_since.is_some_and(|since| since <= now)
    }

    /// Returns the time of the next change.
    pub(crate) fn next(&self, bus: Option<&dyn CanBus>) -> Option<Time> {
        self.on_since.and_then(|_| bus.and_then(CanBus::next))
    }

    pub(crate) fn interrupts(&self) -> bool {
        self.lines & 1 != 0 && self.flags & self.enabled != 0
    }

    /// Brings the controller and its bus to the present time.
    pub(crate) fn advance(&mut self, now: Time, clock: Time, bus: Option<&mut (dyn CanBus + '_)>) {
        if self.is_off && self.is_on(now) {
            self.is_off = false;
            self.transmit_errors = 0;
        }
        let Some(bus) = bus else {
            return;
        };
        let understands = self.understands(clock, bus);
        loop {
            bus.set_listening(self.is_on(now) && understands);
            let offered = self.requested.first().filter(|_| self.is_on(now));
            bus.offer(offered.and_then(|buffer| self.frame(*buffer)));
            let Some((_, event)) = bus.step(now) else {
                return;
            };
            self.handle(event);
        }
    }

    /// Returns the frame in a buffer; none if it is one of CAN FD and the controller sends none of them.
    fn frame(&self, buffer: usize) -> Option<WireFrame> {
        let words = &self.ram[BUFFERS + FRAME * buffer..][..FRAME];
        let (head, kind) = (words[0], words[1]);
        let id: Id = match head & 1 << 30 != 0 {
            true => ExtendedId::new(head & 0x1FFF_FFFF)?.into(),
            false => StandardId::new((head >> 18 & 0x7FF) as u16)?.into(),
        };
        let length = length_of((kind >> 16) as u8);
        let is_flexible = kind >> 20 & 0b11 == 0b11;
        if self.control & FLEXIBLE != 0 && !is_flexible {
            return None;
        }
        if head & 1 << 29 != 0 {
            return WireFrame::new_remote(id, length.min(8));
        }
        let bytes: Vec<u8> = words[2..]
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect();
        let length = if is_flexible { length } else { length.min(8) };
        WireFrame::new(id, &bytes[..length])
    }

    fn handle(&mut self, event: BusEvent) {
        match event {
            BusEvent::Sent(_) => {
                self.transmit_errors = self.transmit_errors.saturating_sub(1);
                if !self.requested.is_empty() {
                    let sent = self.requested.remove(0);
                    self.cancelled &= !(1 << sent);
                }
            }
            BusEvent::NotAcknowledged => {
                // One that is passive counts no more frames without an acknowledgement: none else may be on the bus.
                if self.transmit_errors < PASSIVE {
                    self.transmit_errors += 8;
                }
                self.drop_cancelled();
            }
            BusEvent::BitError => {
                self.transmit_errors += 8;
                self.drop_cancelled();
                if self.transmit_errors >= OFF {
                    // The program has to leave the initialisation.
                    self.is_off = true;
                    self.offs += 1;
                    self.control |= INITIALISE;
                    self.on_since = None;
                }
            }
            BusEvent::Received(frame) => self.receive(&frame),
        }
    }

    fn drop_cancelled(&mut self) {
        let cancelled = std::mem::take(&mut self.cancelled);
        self.requested.retain(|buffer| cancelled >> buffer & 1 == 0);
    }

    /// Returns true if a filter puts frames with this identifier into FIFO 0.
    fn takes(&self, id: Id) -> bool {
        match id {
            Id::Standard(id) => {
                let (id, count) = (u32::from(id.as_raw()), self.filter_control >> 16 & 31);
                let filters = &self.ram[..(count as usize).min(LONG_FILTERS)];
                filters.iter().any(|filter| {
                    let takes = filter >> 27 == 0b10_001;
                    takes && (filter >> 16 & 0x7FF ^ id) & filter & 0x7FF == 0
                })
            }
            Id::Extended(id) => {
                let count = (self.filter_control >> 24 & 15) as usize;
                let filters = &self.ram[LONG_FILTERS..][..2 * count.min(8)];
                filters.chunks(2).any(|filter| {
                    let takes = filter[0] >> 29 == 1 && filter[1] >> 30 == 2;
                    takes && (filter[0] ^ id.as_raw()) & filter[1] & 0x1FFF_FFFF == 0
                })
            }
        }
    }

    fn receive(&mut self, frame: &WireFrame) {
        // All that no filter takes is rejected, if the global filter says so: 2 and 3 of its fields.
        let rejects = self.filter_control >> 2 & 0b1010 == 0b1010;
        if rejects && !self.takes(frame.id()) {
            return;
        }
        if self.filled == PLACES {
            self.flags |= LOST;
            return;
        }
        let place = FIFO + FRAME * ((self.first + self.filled) % PLACES);
        let head = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()) << 18,
            Id::Extended(id) => id.as_raw() | 1 << 30,
        };
        let flexible = if self.control & FLEXIBLE != 0 {
            0b11 << 20
        } else {
            0
        };
        let code = length_code(frame.dlc()).unwrap_or(0);
        let words = &mut self.ram[place..place + FRAME];
        words[0] = head | u32::from(frame.is_remote_frame()) << 29;
        words[1] = u32::from(code) << 16 | flexible;
        for (word, bytes) in words[2..].iter_mut().zip(frame.data().chunks(4)) {
            let mut whole = [0; 4];
            whole[..bytes.len()].copy_from_slice(bytes);
            *word = u32::from_le_bytes(whole);
        }
        self.filled += 1;
        self.flags |= NEW;
        if self.filled == PLACES {
            self.flags |= FULL;
        }
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        let flag = |is: bool, bit: u32| u32::from(is) << bit;
        let pending = self
            .requested
            .iter()
            .fold(0, |bits, buffer| bits | 1 << buffer);
        Some(match offset {
            0x0C => self.data,
            0x18 => self.control,
            0x1C => self.nominal,
            0x40 => self.transmit_errors.min(255),
            0x44 => {
                let errors = self.transmit_errors;
                flag(errors >= PASSIVE, 5) | flag(errors >= 96, 6) | flag(self.is_off, 7)
            }
            0x48 => self.compensation,
            0x50 => self.flags,
            0x54 => self.enabled,
            0x5C => self.lines,
            0x80 => self.filter_control,
            0x90 => {
                let (filled, first) = (self.filled as u32, self.first as u32);
                filled
                    | first << 8
                    | flag(self.filled == PLACES, 24)
                    | flag(self.flags & LOST != 0, 25)
            }
            0xC0 => 0,
            0xC4 => {
                let free = (PLACES - self.requested.len()) as u32;
                let get = self.requested.first().copied().unwrap_or(0) as u32;
                free | get << 8 | (self.next_buffer as u32) << 16 | flag(free == 0, 21)
            }
            0xC8 => pending,
            0xCC | 0xD0 => 0,
            _ => return None,
        })
    }

    /// The controller has to be [advanced](Self::advance) to `now` before, and after.
    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: Time,
        clock: Time,
        is_sending: bool,
    ) -> bool {
        let may_change = self.control & (INITIALISE | CHANGE) == INITIALISE | CHANGE;
        match offset {
            0x18 => {
                let was_on = self.control & INITIALISE == 0;
                let kept = if may_change { 0 } else { FLEXIBLE };
                self.control = value & !kept | self.control & kept;
                if value & INITIALISE != 0 {
                    self.on_since = None;
                } else {
                    self.control &= !CHANGE;
                    if !was_on {
                        let times = if self.is_off { 128 } else { 1 };
                        self.on_since = Some(now + times * SILENCE * self.bit(clock));
                    }
                }
            }
            0x0C if may_change => self.data = value,
            0x1C if may_change => self.nominal = value,
            0x48 if may_change => self.compensation = value,
            0x80 if may_change => self.filter_control = value,
            // A queue by identifiers is not modelled.
            0xC0 if may_change && value & 1 << 24 == 0 => {}
            0x50 => self.flags &= !value,
            0x54 => self.enabled = value,
            0x5C => self.lines = value,
            0x94 => {
                if self.filled > 0 && value as usize % 4 == self.first {
                    self.first = (self.first + 1) % PLACES;
                    self.filled -= 1;
                }
            }
            0xCC => {
                for buffer in 0..PLACES {
                    if value >> buffer & 1 != 0 && !self.requested.contains(&buffer) {
                        self.requested.push(buffer);
                        self.next_buffer = (buffer + 1) % PLACES;
                    }
                }
            }
            0xD0 => {
                // A frame under way goes to its end.
                let under_way = self.requested.first().copied().filter(|_| is_sending);
                self.cancelled |= value & 0b111;
                let kept = under_way.map_or(0, |buffer| 1 << buffer) & self.cancelled;
                self.cancelled &= !kept;
                self.drop_cancelled();
                self.cancelled = kept;
            }
            _ => return false,
        }
        true
    }

    pub(crate) fn read_ram(&self, offset: u32) -> Option<u32> {
        self.ram.get(offset as usize / 4).copied()
    }

    /// The RAM takes whole words alone.
    pub(crate) fn write_ram(&mut self, offset: u32, size: usize, value: u32) -> bool {
        match self.ram.get_mut(offset as usize / 4) {
            Some(word) if size == 4 => *word = value,
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extended(id: u32, data: &[u8]) -> WireFrame {
        WireFrame::new(ExtendedId::new(id).expect("an identifier"), data).expect("a frame")
    }

    /// A controller that takes frames of one identifier.
    fn filtered() -> FdCan {
        let mut can = FdCan::new();
        assert!(can.write(0x18, INITIALISE | CHANGE, 0, 6, false));
        assert!(can.write(0x18, INITIALISE | CHANGE | FLEXIBLE, 0, 6, false));
        assert!(can.write(0x80, 1 << 24 | 1 << 16 | 0b1010 << 2, 0, 6, false));
        assert!(can.write_ram(0, 4, 0));
        assert!(can.write_ram(4 * LONG_FILTERS as u32, 4, 1 << 29 | 0x900));
        assert!(can.write_ram(4 * LONG_FILTERS as u32 + 4, 4, 2 << 30 | 0x1FFF_FFFF));
        can
    }

    #[test]
    fn a_filter_lets_its_drive_in_and_no_other() {
        let mut can = filtered();
        for id in [0x800, 0x900, 0x901] {
            can.receive(&extended(id, &[id as u8; 24]));
        }
        assert_eq!(can.read(0x90), Some(1));
        assert_eq!(can.read_ram(4 * FIFO as u32), Some(1 << 30 | 0x900));
        assert_eq!(
            can.read_ram(4 * FIFO as u32 + 4),
            Some(12 << 16 | 0b11 << 20)
        );
        assert_eq!(can.flags, NEW);
        assert!(can.write(0x94, 0, 0, 6, false));
        assert_eq!(can.read(0x90), Some(1 << 8));
    }

    #[test]
    fn a_full_fifo_loses_the_new_frame() {
        let mut can = filtered();
        for _ in 0..4 {
            can.receive(&extended(0x900, &[1]));
        }
        assert_eq!(can.flags, NEW | FULL | LOST);
        assert_eq!(can.filled, PLACES);
    }

    #[test]
    fn settings_are_closed_outside_of_the_initialisation() {
        let mut can = FdCan::new();
        assert!(!can.write(0x1C, 1, 0, 6, false));
        assert!(can.write(0x18, INITIALISE | CHANGE, 0, 6, false));
        assert!(can.write(0x1C, 1, 0, 6, false));
        assert!(can.write(0x18, 0, 0, 6, false));
        assert!(!can.write(0x1C, 2, 0, 6, false));
        assert_eq!((can.read(0x1C), can.read(0x18)), (Some(1), Some(0)));
    }
}
