//! CAN1 (bxCAN, RM0090 chapter 32): three mailboxes, filters of 32 bits with a mask, FIFO 0, counters of errors, bus-off.

use super::{CanController, Confinement, PLACES, SendError, is_off_rate};
use crate::bus::{CanBus, WireFrame};
use crate::time::{SECOND, Time};
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use std::collections::VecDeque;

/// Interrupt of FIFO 0.
const RX0: u16 = 20;

const INITIALISE: u32 = 1;
const SLEEP: u32 = 1 << 1;
/// Mailboxes in the order of their requests.
const IN_ORDER: u32 = 1 << 2;
/// Back on the bus by itself.
const RECOVERS: u32 = 1 << 6;

const REQUESTED: u32 = 1;

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
    confinement: Confinement,
    last_error: u32,
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
            confinement: Confinement::default(),
            last_error: 0,
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

    /// Chooses the mailbox that takes part in the next arbitration.
    fn choose(&mut self, now: Time) {
        let requested = |index: &usize| self.mailboxes[*index].order.is_some();
        self.offered = match self.confinement.is_on(now) {
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
}

impl CanController for BxCan {
    fn interrupt(&self) -> u16 {
        RX0
    }

    fn interrupts(&self) -> bool {
        self.interrupts & 1 << 1 != 0 && !self.fifo.is_empty()
    }

    fn confinement(&self) -> &Confinement {
        &self.confinement
    }

    fn confinement_mut(&mut self) -> &mut Confinement {
        &mut self.confinement
    }

    fn understands(&self, clock: Time, bus: &dyn CanBus) -> bool {
        !is_off_rate(self.bit_rate_hz(clock), bus.bit_rate_hz())
    }

    fn offered(&mut self, now: Time) -> Option<WireFrame> {
        self.choose(now);
        self.offered.and_then(|index| self.frame(index))
    }

    fn sent(&mut self, frame: &WireFrame) {
        self.last_error = 0;
        let of = |index: &usize| self.frame(*index).as_ref() == Some(frame);
        let sent = (0..3)
            .filter(|index| self.mailboxes[*index].order.is_some())
            .find(of);
        if let Some(index) = sent {
            self.end(index, true);
        }
    }

    fn failed(&mut self, error: SendError) {
        self.last_error = error as u32;
        self.drop_aborted();
    }

    fn gone_off(&mut self, time: Time, clock: Time) {
        if self.control & RECOVERS != 0 {
            self.confinement.start(time, self.bit(clock));
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

    fn read(&self, offset: u32) -> Option<u32> {
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
                let confinement = &self.confinement;
                flag(confinement.warns(), 0)
                    | flag(confinement.is_passive(), 1)
                    | flag(confinement.is_off, 2)
                    | self.last_error << 4
                    | confinement.shown_errors() << 16
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

    fn write(&mut self, offset: u32, value: u32, now: Time, clock: Time, is_sending: bool) -> bool {
        match offset {
            0x00 => {
                let was_on = self.control & (INITIALISE | SLEEP) == 0;
                self.control = value;
                let on = value & (INITIALISE | SLEEP) == 0;
                if on && !was_on {
                    self.confinement.start(now, self.bit(clock));
                }
                if !on {
                    self.confinement.stop();
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
                if place.is_multiple_of(4) && value & REQUESTED != 0 && mailbox.order.is_none() {
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
    use crate::bus::BusEvent;
    use crate::time::{MICROSECOND, MS};

    /// Period of APB1 at 42 MHz, and the timing of 1 Mbit/s as the image writes it: 14 quanta of three periods.
    const CLOCK: Time = SECOND / 42_000_000;
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
        assert!(
            !can.confinement.is_on(10 * MICROSECOND) && can.confinement.is_on(11 * MICROSECOND)
        );
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
        assert!(!can.confinement.is_on(MS));
        // Back after 128 times 11 bits of a microsecond.
        let back = MS + 1408 * MICROSECOND;
        assert_eq!(can.confinement.next(None), Some(back));
        can.advance(back - 1, CLOCK, None);
        assert!(!can.confinement.is_on(back - 1));
        can.advance(back, CLOCK, None);
        assert!(can.confinement.is_on(back));
        assert_eq!(can.read(0x18).expect("ESR") >> 16, 0);
    }
}
