//! CAN1 (bxCAN, RM0090 chapter 32): three mailboxes, filters of 32 bits with a mask, FIFO 0, counters of errors, bus-off.

use crate::bus::{BusEvent, CanBus, WireFrame};
use crate::time::{SECOND, Time};
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use std::collections::VecDeque;

/// Interrupt of FIFO 0.
pub(super) const RX0: u16 = 20;

const INITIALISE: u32 = 1;
const SLEEP: u32 = 1 << 1;
/// Mailboxes in the order of their requests.
const IN_ORDER: u32 = 1 << 2;
/// Back on the bus by itself.
const RECOVERS: u32 = 1 << 6;

const REQUESTED: u32 = 1;

/// Places of FIFO 0.
const PLACES: usize = 3;

/// Error counters at which the controller is passive, and off.
const PASSIVE: u32 = 128;
const OFF: u32 = 256;

/// Bits of silence after which the controller takes part, and after which one that is off is back: 128 times.
const SILENCE: Time = 11;

/// Parts of the bit rate by which the controller's may be off that of the drives.
const RATE_ERROR: f64 = 0.005;

#[derive(Clone, Debug, Default)]
struct Mailbox {
    /// TIR, TDTR, TDLR, TDHR.
    words: [u32; 4],
    /// Number of the request, while there is one.
    order: Option<u64>,
    aborted: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct BxCan {
    control: u32,
    timing: u32,
    interrupts: u32,
    mailboxes: [Mailbox; 3],
    /// Result bits of the mailboxes in TSR: done, sent.
    results: u32,
    orders: u64,
    /// Mailbox whose frame takes part in the arbitration.
    offered: Option<usize>,
    fifo: VecDeque<[u32; 4]>,
    overrun: bool,
    filter_control: u32,
    filter_modes: [u32; 3],
    filters_on: u32,
    filters: [[u32; 2]; 28],
    transmit_errors: u32,
    last_error: u32,
    /// Time from which on the controller takes part; none in initialisation, asleep and off the bus.
    on_since: Option<Time>,
    /// Time at which a controller that is off the bus is back.
    back_at: Option<Time>,
    is_off: bool,
    /// Times that the controller went off the bus.
    pub(crate) offs: u32,
}

impl BxCan {
    pub(crate) fn new() -> Self {
        Self {
            control: 0x0001_0002,
            timing: 0x0123_0000,
            interrupts: 0,
            mailboxes: Default::default(),
            results: 0,
            orders: 0,
            offered: None,
            fifo: VecDeque::new(),
            overrun: false,
            filter_control: 0x2A1C_0E01,
            filter_modes: [0; 3],
            filters_on: 0,
            filters: [[0; 2]; 28],
            transmit_errors: 0,
            last_error: 0,
            on_since: None,
            back_at: None,
            is_off: false,
            offs: 0,
        }
    }

    /// Returns the bit rate for a clock of this period, Hz.
    fn bit_rate_hz(&self, clock: Time) -> f64 {
        let field = |bit: u32, bits: u32| Time::from(self.timing >> bit & ((1 << bits) - 1)) + 1;
        let quanta = 1 + field(16, 4) + field(20, 3);
        SECOND as f64 / (clock * field(0, 10) * quanta) as f64
    }

    fn bit(&self, clock: Time) -> Time {
        (SECOND as f64 / self.bit_rate_hz(clock)) as Time
    }

    /// Returns true from the time on at which the controller takes part.
    fn is_on(&self, now: Time) -> bool {
        self.on_since.is_some_and(|since| since <= now)
    }

    /// Returns the time of the next change.
    pub(crate) fn next(&self, bus: Option<&dyn CanBus>) -> Option<Time> {
        let on = self.on_since.and_then(|_| bus.and_then(CanBus::next));
        on.into_iter().chain(self.back_at).min()
    }

    pub(crate) fn interrupts(&self) -> bool {
        self.interrupts & 1 << 1 != 0 && !self.fifo.is_empty()
    }

    /// Brings the controller and its bus to the present time.
    pub(crate) fn advance(&mut self, now: Time, clock: Time, bus: Option<&mut (dyn CanBus + '_)>) {
        if self.back_at.is_some_and(|back| back <= now) {
            self.on_since = self.back_at.take();
            self.is_off = false;
            self.transmit_errors = 0;
        }
        let Some(bus) = bus else {
            return;
        };
        let off_by = self.bit_rate_hz(clock) / f64::from(bus.bit_rate_hz()) - 1.0;
        loop {
            bus.set_listening(self.is_on(now) && off_by.abs() <= RATE_ERROR);
            self.choose(now);
            let offered = self.offered.and_then(|index| self.frame(index));
            bus.offer(offered);
            let Some((time, event)) = bus.step(now) else {
                return;
            };
            self.handle(time, clock, event);
        }
    }

    /// Chooses the mailbox that takes part in the next arbitration.
    fn choose(&mut self, now: Time) {
        let requested = |index: &usize| self.mailboxes[*index].order.is_some();
        self.offered = match self.is_on(now) {
            false => None,
            true if self.control & IN_ORDER != 0 => (0..3)
                .filter(requested)
                .min_by_key(|index| self.mailboxes[*index].order),
            true => (0..3)
                .filter(requested)
                .min_by_key(|index| self.mailboxes[*index].words[0] & !1),
        };
    }

    /// Returns the frame in a mailbox.
    fn frame(&self, index: usize) -> Option<WireFrame> {
        let [id, length, low, high] = self.mailboxes[index].words;
        let remote = id & 1 << 1 != 0;
        let length = (length & 15).min(8) as usize;
        let id: Id = match id & 1 << 2 != 0 {
            true => ExtendedId::new(id >> 3)?.into(),
            false => StandardId::new((id >> 21) as u16)?.into(),
        };
        let data = (u64::from(low) | u64::from(high) << 32).to_le_bytes();
        match remote {
            true => WireFrame::new_remote(id, length),
            false => WireFrame::new(id, &data[..length]),
        }
    }

    fn handle(&mut self, time: Time, clock: Time, event: BusEvent) {
        match event {
            BusEvent::Sent(frame) => {
                self.transmit_errors = self.transmit_errors.saturating_sub(1);
                self.last_error = 0;
                let of = |index: &usize| self.frame(*index).as_ref() == Some(&frame);
                let sent = (0..3)
                    .filter(|index| self.mailboxes[*index].order.is_some())
                    .find(of);
                if let Some(index) = sent {
                    self.end(index, true);
                }
            }
            BusEvent::NotAcknowledged => {
                // One that is passive counts no more frames without an acknowledgement: none else may be on the bus.
                if self.transmit_errors < PASSIVE {
                    self.transmit_errors += 8;
                }
                self.last_error = 3;
                self.drop_aborted();
            }
            BusEvent::BitError => {
                self.transmit_errors += 8;
                // A dominant bit that was read as recessive.
                self.last_error = 5;
                self.drop_aborted();
                if self.transmit_errors >= OFF {
                    self.is_off = true;
                    self.offs += 1;
                    self.on_since = None;
                    let silence = 128 * SILENCE * self.bit(clock);
                    self.back_at = (self.control & RECOVERS != 0).then(|| time + silence);
                }
            }
            BusEvent::Received(frame) => self.receive(&frame),
        }
    }

    /// Ends a mailbox's request.
    fn end(&mut self, index: usize, sent: bool) {
        let mailbox = &mut self.mailboxes[index];
        (mailbox.order, mailbox.aborted) = (None, false);
        mailbox.words[0] &= !REQUESTED;
        self.results |= (1 | u32::from(sent) << 1) << (8 * index);
    }

    fn drop_aborted(&mut self) {
        for index in 0..3 {
            if self.mailboxes[index].aborted {
                self.end(index, false);
            }
        }
    }

    fn receive(&mut self, frame: &WireFrame) {
        let remote = u32::from(frame.is_remote_frame()) << 1;
        let id = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()) << 21 | remote,
            Id::Extended(id) => id.as_raw() << 3 | 1 << 2 | remote,
        };
        let filter = (0..28).find(|bank| {
            let on = self.filters_on & 1 << bank != 0;
            // Banks of 32 bits with a mask, into FIFO 0.
            let kind = [
                self.filter_modes[1],
                !self.filter_modes[0],
                !self.filter_modes[2],
            ];
            let [id_bits, mask] = self.filters[*bank];
            let fits = kind.iter().all(|bits| bits & 1 << bank != 0);
            on && fits && (id ^ id_bits) & mask == 0
        });
        let Some(bank) = filter.filter(|_| self.filter_control & 1 == 0) else {
            return;
        };
        let mut data = [0; 8];
        data[..frame.data().len().min(8)].copy_from_slice(frame.data());
        let data = u64::from_le_bytes(data);
        let place = [
            id,
            frame.dlc() as u32 | (bank as u32) << 8,
            data as u32,
            (data >> 32) as u32,
        ];
        if self.fifo.len() == PLACES {
            // The last one is lost.
            self.overrun = true;
            self.fifo.pop_back();
        }
        self.fifo.push_back(place);
    }

    /// TSR.
    fn transmit_status(&self) -> u32 {
        let empty = (0..3).filter(|index| self.mailboxes[*index].order.is_none());
        let first = empty.clone().next().unwrap_or(0) as u32;
        let aborts = (0..3).filter(|index| self.mailboxes[*index].aborted);
        self.results
            | first << 24
            | empty.fold(0, |bits, index| bits | 1 << (26 + index))
            | aborts.fold(0, |bits, index| bits | 1 << (7 + 8 * index))
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        let flag = |is: bool, bit: u32| u32::from(is) << bit;
        let bank = |offset: u32| ((offset - 0x240) / 8) as usize;
        Some(match offset {
            0x00 => self.control,
            // Initialisation and sleep are acknowledged at once.
            0x04 => {
                let asleep = self.control & SLEEP != 0;
                0xC00 | flag(asleep, 1) | flag(!asleep && self.control & INITIALISE != 0, 0)
            }
            0x08 => self.transmit_status(),
            0x0C => {
                let count = self.fifo.len();
                count as u32 | flag(count == PLACES, 3) | flag(self.overrun, 4)
            }
            0x14 => self.interrupts,
            0x18 => {
                let errors = self.transmit_errors;
                flag(errors >= 96, 0)
                    | flag(errors >= PASSIVE, 1)
                    | flag(self.is_off, 2)
                    | self.last_error << 4
                    | errors.min(255) << 16
            }
            0x1C => self.timing,
            0x180..=0x1AF => {
                let place = (offset - 0x180) / 4;
                self.mailboxes[(place / 4) as usize].words[(place % 4) as usize]
            }
            0x1B0..=0x1BF => {
                let place = self.fifo.front().copied().unwrap_or([0; 4]);
                place[((offset - 0x1B0) / 4) as usize]
            }
            0x200 => self.filter_control,
            0x204 => self.filter_modes[0],
            0x20C => self.filter_modes[1],
            0x214 => self.filter_modes[2],
            0x21C => self.filters_on,
            0x240..=0x31F => self.filters[bank(offset)][(offset / 4 % 2) as usize],
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
        match offset {
            0x00 => {
                let was_on = self.control & (INITIALISE | SLEEP) == 0;
                self.control = value;
                let on = value & (INITIALISE | SLEEP) == 0;
                if on && !was_on {
                    self.on_since = Some(now + SILENCE * self.bit(clock));
                }
                if !on {
                    self.on_since = None;
                }
            }
            0x08 => {
                for index in 0..3 {
                    if value >> (8 * index) & 1 != 0 {
                        self.results &= !(0xF << (8 * index));
                    }
                    let mailbox = &mut self.mailboxes[index];
                    if value >> (7 + 8 * index) & 1 != 0 && mailbox.order.is_some() {
                        mailbox.aborted = true;
                        // A frame under way goes to its end.
                        if !(is_sending && self.offered == Some(index)) {
                            self.end(index, false);
                        }
                    }
                }
            }
            0x0C => {
                if value & 1 << 4 != 0 {
                    self.overrun = false;
                }
                if value & 1 << 5 != 0 {
                    self.fifo.pop_front();
                }
            }
            0x14 => self.interrupts = value,
            0x18 => self.last_error = value >> 4 & 7,
            // Only in initialisation.
            0x1C if self.control & INITIALISE != 0 => self.timing = value,
            0x1C => {}
            0x180..=0x1AF => {
                let place = (offset - 0x180) / 4;
                let index = (place / 4) as usize;
                let mailbox = &mut self.mailboxes[index];
                mailbox.words[(place % 4) as usize] = value;
                if place % 4 == 0 && value & REQUESTED != 0 && mailbox.order.is_none() {
                    mailbox.order = Some(self.orders);
                    self.orders += 1;
                    self.results &= !(0xF << (8 * index));
                }
            }
            0x200 => self.filter_control = value,
            0x204 => self.filter_modes[0] = value,
            0x20C => self.filter_modes[1] = value,
            0x214 => self.filter_modes[2] = value,
            0x21C => self.filters_on = value,
            0x240..=0x31F => {
                self.filters[((offset - 0x240) / 8) as usize][(offset / 4 % 2) as usize] = value;
            }
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MS;

    /// Period of APB1 at 42 MHz, and the timing of 1 Mbit/s as the image writes it: 14 quanta of three periods.
    const CLOCK: Time = 24;
    const TIMING: u32 = 1 << 24 | 1 << 20 | 10 << 16 | 2;

    fn started(control: u32) -> BxCan {
        let mut can = BxCan::new();
        let writes = [
            (0x00, INITIALISE | control),
            (0x1C, TIMING),
            // One filter: identifier 0x28 to 0x2F.
            (0x20C, 1),
            (0x240, 0x28 << 21),
            (0x244, 0x7F8 << 21 | 0b110),
            (0x21C, 1),
            (0x200, 0),
            (0x14, 1 << 1),
            (0x00, control),
        ];
        for (offset, value) in writes {
            assert!(can.write(offset, value, 0, CLOCK, false), "{offset:#x}");
        }
        can
    }

    fn request(can: &mut BxCan, index: u32, id: u32) {
        let place = 0x180 + 0x10 * index;
        for (offset, value) in [(4, 8), (8, 1), (12, 2), (0, id << 21 | REQUESTED)] {
            assert!(can.write(place + offset, value, MS, CLOCK, false));
        }
    }

    #[test]
    fn the_timing_of_the_image_makes_a_megabit_and_counts_in_initialisation_alone() {
        let mut can = started(RECOVERS);
        assert_eq!(can.bit_rate_hz(CLOCK), 1e6);
        can.write(0x1C, 0, MS, CLOCK, false);
        assert_eq!(can.read(0x1C), Some(TIMING));
        assert!(!can.is_on(10 * 1008) && can.is_on(11 * 1008));
    }

    #[test]
    fn a_filter_lets_its_frames_in_and_a_fourth_overruns() {
        let mut can = started(RECOVERS);
        let frame = |id: u16, data: &[u8]| {
            let id = StandardId::new(id).expect("eleven bits");
            WireFrame::new(id, data).expect("short")
        };
        can.receive(&frame(0x30, &[1]));
        assert!(!can.interrupts());
        for byte in 1..=4 {
            can.receive(&frame(0x2C, &[byte, 0xFF]));
        }
        // Three, full, one lost.
        assert_eq!(can.read(0x0C), Some(3 | 1 << 3 | 1 << 4));
        assert!(can.interrupts());
        assert_eq!(
            (can.read(0x1B0), can.read(0x1B4)),
            (Some(0x2C << 21), Some(2))
        );
        assert_eq!(can.read(0x1B8), Some(0xFF01));
        for _ in 0..3 {
            can.write(0x0C, 1 << 5, MS, CLOCK, false);
        }
        assert!(!can.interrupts());
    }

    #[test]
    fn frames_go_in_the_order_of_requests_or_of_identifiers() {
        for (control, first) in [(IN_ORDER, Some(0)), (0, Some(1))] {
            let mut can = started(control);
            request(&mut can, 0, 0x300);
            request(&mut can, 1, 0x200);
            can.choose(MS);
            assert_eq!(can.offered, first);
        }
    }

    #[test]
    fn a_frame_under_way_is_aborted_at_its_end_and_another_at_once() {
        let mut can = started(IN_ORDER);
        request(&mut can, 0, 0x300);
        request(&mut can, 1, 0x200);
        can.choose(MS);
        can.write(0x08, 1 << 7 | 1 << 15, MS, CLOCK, true);
        let empty = |can: &BxCan| can.read(0x08).expect("TSR") >> 26;
        assert_eq!(empty(&can), 0b110);
        can.handle(MS, CLOCK, BusEvent::NotAcknowledged);
        assert_eq!(empty(&can), 0b111);
    }

    #[test]
    fn errors_of_bits_end_off_the_bus_and_missing_acknowledgements_do_not() {
        let mut can = started(RECOVERS);
        for _ in 0..100 {
            can.handle(MS, CLOCK, BusEvent::NotAcknowledged);
        }
        assert_eq!(can.read(0x18).expect("ESR") & 0b111, 0b011);
        for _ in 0..16 {
            can.handle(MS, CLOCK, BusEvent::BitError);
        }
        assert_eq!(can.read(0x18).expect("ESR") & 0b111, 0b111);
        assert!(!can.is_on(MS));
        // Back after 128 times 11 bits of a microsecond.
        let back = MS + 1408 * 1008;
        assert_eq!(can.next(None), Some(back));
        can.advance(back - 1, CLOCK, None);
        assert!(!can.is_on(back - 1));
        can.advance(back, CLOCK, None);
        assert!(can.is_on(back));
        assert_eq!(can.read(0x18).expect("ESR") >> 16, 0);
    }
}
