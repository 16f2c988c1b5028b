//! A host at the USB plug of the board, and the bus between them at full speed.
//!
//! The host powers the port, enumerates the device as a serial port, opens that and carries bytes. A frame of 1 ms has as many transactions
//! as fit into its 12,000 bits: 19 with 64 bytes. A transaction takes 13 bytes more than its data, by which the specification counts (USB 2.0, 5.8.4);
//! one that the device refuses is tried again.

mod control;

pub(crate) use control::Found;

use crate::chip::{Answer, BusSignal, UsbController, UsbPacket};
use crate::time::{MICROSECOND, MS, Time};
use control::{ADDRESS, ADDRESS_STEP, ControlTransfer, RESET_AFTER, Stage, line_state};
use std::collections::VecDeque;

/// Data of a packet, bytes.
pub(crate) const PACKET: usize = 64;

/// Bytes of a transaction besides its data.
const OVERHEAD: usize = 13;

/// Time of a byte at 12 Mbit/s.
const BYTE: Time = MICROSECOND * 8 / 12;

/// The host asks an endpoint again so long after it has refused.
const RETRY: Time = 10 * MICROSECOND;

/// Times of a host (USB 2.0, 7.1.7): contacts of a plug that do not bounce any more, reset, rest behind it and behind a new address, resume.
const DEBOUNCE: Time = 100 * MS;
const RESET: Time = 10 * MS;
const RECOVERY: Time = 10 * MS;
const ADDRESS_RECOVERY: Time = 2 * MS;
const RESUME: Time = 20 * MS;

/// A bus that rests for so long suspends the device.
const REST: Time = 3 * MS;

/// Times without an answer, one behind the other, after which the host resets the bus.
const SILENCES: u32 = 3;

/// Bytes that the host keeps for a program that does not read: then it asks for no more.
const KEPT: usize = 16 * PACKET;

/// State of the port.
#[derive(Clone, Debug)]
enum PortState {
    /// No device, or none that pulls D+ up.
    Empty,
    /// Until that time, as all that have one.
    Debounce(Time),
    Reset,
    InReset(Time),
    Recovery(Time),
    /// The control transfer of a step.
    Enumeration(usize, ControlTransfer),
    /// Between two steps.
    Pause(Time, usize),
    Open,
    Suspended,
    Resume(Time),
}

/// Host, its port and the cable.
pub(crate) struct UsbHost {
    state: PortState,
    /// The cable is in.
    is_plugged: bool,
    /// The program at the port takes and gives bytes.
    is_carrying: bool,
    next: Time,
    /// Begin of the frame, and its number.
    frame: Time,
    number: u16,
    /// Last time that anything was on the bus, and whether the device was told of its rest.
    rests_since: Time,
    has_rested: bool,
    /// The second reset of an enumeration is over.
    is_second: bool,
    silences: u32,
    /// Toggles of the data, and whether it is the turn of the device.
    is_odd: (bool, bool),
    is_devices_turn: bool,
    /// Transaction under way: what happens at its end.
    under_way: Option<Transaction>,
    /// Control transfer beside the data.
    control: Option<ControlTransfer>,
    pub(crate) found: Found,
    /// The device was pulled up first, and the port was open, at these times.
    pub(crate) attached: Option<Time>,
    pub(crate) opened: Option<Time>,
    /// Bytes to the board.
    to_board: VecDeque<u8>,
    /// Bytes from the board, with the times of their packets' ends, and how many of them the program has taken.
    from_board: Vec<(Time, u8)>,
    taken: usize,
    /// Bytes that the board has taken.
    went: usize,
    /// Most packets of data that a frame has had, and those of the present one.
    pub(crate) most_packets: u32,
    packets: u32,
    /// Enumerations that ended.
    pub(crate) enumerations: u32,
    /// What the device has done against the specification.
    pub(crate) errors: Vec<String>,
}

#[derive(Clone, Debug)]
enum Transaction {
    /// A packet to the device is on the wire.
    ToDevice(UsbPacket),
    /// One from it.
    FromDevice(UsbPacket),
    Control(Option<UsbPacket>),
}

impl UsbHost {
    /// Creates a host with the cable in the plug of the board.
    pub(crate) fn new() -> Self {
        Self {
            state: PortState::Empty,
            is_plugged: true,
            is_carrying: true,
            next: 0,
            frame: 0,
            number: 0,
            rests_since: 0,
            has_rested: false,
            is_second: false,
            silences: 0,
            is_odd: (false, false),
            is_devices_turn: false,
            under_way: None,
            control: None,
            found: Found::default(),
            attached: None,
            opened: None,
            to_board: VecDeque::new(),
            from_board: Vec::new(),
            taken: 0,
            went: 0,
            most_packets: 0,
            packets: 0,
            enumerations: 0,
            errors: Vec::new(),
        }
    }

    /// Returns the time of the next step.
    pub(crate) fn next(&self) -> Time {
        self.next
    }

    /// Returns true while a program on the host has the port open, and the device knows it.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self.state, PortState::Open) && self.opened.is_some()
    }

    /// Pulls the cable, or puts it in.
    pub(crate) fn plug(&mut self, is_plugged: bool) {
        self.is_plugged = is_plugged;
        self.state = PortState::Empty;
        self.forget();
    }

    /// The program stops, or goes on: it neither takes nor gives bytes.
    pub(crate) fn carry(&mut self, is_carrying: bool) {
        self.is_carrying = is_carrying;
    }

    /// Resets the bus, as a host does that has lost its device, and enumerates that again.
    pub(crate) fn reset(&mut self, now: Time) {
        self.forget();
        self.is_second = false;
        self.state = PortState::Reset;
        self.next = now;
    }

    /// Suspends the device, as a host does that goes to sleep.
    pub(crate) fn suspend(&mut self) {
        self.state = PortState::Suspended;
        self.under_way = None;
    }

    /// Wakes the device.
    pub(crate) fn resume(&mut self, now: Time) {
        self.state = PortState::Resume(now + RESUME);
    }

    /// A program opens or closes the port.
    pub(crate) fn open(&mut self, is_open: bool) {
        self.control = Some(line_state(is_open));
    }

    /// Gives bytes to the board.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.to_board.extend(bytes);
    }

    /// Returns the number of bytes of data in both directions so far.
    pub(crate) fn count(&self) -> usize {
        self.went + self.from_board.len()
    }

    /// Returns the bytes from the board that the program has not taken.
    pub(crate) fn take(&mut self) -> &[(Time, u8)] {
        let from = self.taken;
        self.taken = self.from_board.len();
        self.from_board.get(from..).unwrap_or_default()
    }

    fn forget(&mut self) {
        self.under_way = None;
        self.control = None;
        self.opened = None;
        self.is_odd = (false, false);
        self.silences = 0;
        self.found = Found::default();
        // A program that has lost its port has lost what it wrote.
        self.to_board.clear();
    }

    /// Carries out what is due. Returns true if a frame begins.
    ///
    /// `is_on` is whether the device pulls D+ up, `hears` whether it keeps the bit rate.
    pub(crate) fn step(&mut self, usb: &mut dyn UsbController, is_on: bool, hears: bool) -> bool {
        let now = self.next;
        self.next = now + RETRY;
        if !is_on || !self.is_plugged {
            if !matches!(self.state, PortState::Empty) {
                self.state = PortState::Empty;
                self.forget();
            }
            self.next = now + MS / 10;
            self.rest(now, usb);
            return false;
        }
        match self.state.clone() {
            PortState::Empty => {
                self.attached = Some(now);
                self.rests_since = now;
                self.has_rested = false;
                self.is_second = false;
                self.state = PortState::Debounce(now + DEBOUNCE);
            }
            PortState::Debounce(end) => {
                self.rest(now, usb);
                if now >= end {
                    self.state = PortState::Reset;
                }
                self.next = now + MS / 10;
            }
            PortState::Reset => {
                usb.signal(BusSignal::ResetBegins);
                self.state = PortState::InReset(now + RESET);
                self.next = now + RESET;
            }
            PortState::InReset(end) if now < end => self.next = end,
            PortState::InReset(_) => {
                usb.signal(BusSignal::ResetEnds);
                self.is_odd = (false, false);
                self.frame = now;
                self.state = PortState::Recovery(now + RECOVERY);
                self.next = now;
            }
            PortState::Suspended => {
                self.rest(now, usb);
                self.next = now + MS / 10;
            }
            PortState::Resume(end) => {
                if self.has_rested {
                    usb.signal(BusSignal::Resume);
                    self.has_rested = false;
                }
                self.rests_since = now;
                self.next = now + MS / 10;
                if now >= end {
                    self.frame = now;
                    self.next = now;
                    self.state = PortState::Open;
                }
            }
            _ => return self.step_in_frame(now, usb, hears),
        }
        false
    }

    /// A bus at rest: after a while the device is told.
    fn rest(&mut self, now: Time, usb: &mut dyn UsbController) {
        if !self.has_rested && now >= self.rests_since + REST {
            self.has_rested = true;
            usb.signal(BusSignal::Suspend);
        }
    }

    /// Begins a frame, or a transaction in it, or ends one.
    fn step_in_frame(&mut self, now: Time, usb: &mut dyn UsbController, hears: bool) -> bool {
        self.rests_since = now;
        self.has_rested = false;
        if let Some(transaction) = self.under_way.take() {
            self.next = now;
            self.end(now, transaction, usb, hears);
            return false;
        }
        if now >= self.frame {
            self.number = (self.number + 1) & 0x7FF;
            usb.signal(BusSignal::Frame(self.number));
            self.frame += MS;
            self.packets = 0;
            // Three bytes of the start of a frame, and its end.
            self.next = now + 4 * BYTE;
            return true;
        }
        self.begin(now, usb, hears);
        // The next frame begins on time, whatever is tried again.
        if self.under_way.is_none() {
            self.next = self.next.min(self.frame);
        }
        false
    }

    /// Begins the transaction that is due, if it fits into the frame.
    fn begin(&mut self, now: Time, usb: &mut dyn UsbController, hears: bool) {
        match &self.state {
            PortState::Recovery(end) if now >= *end => {
                let step = if self.is_second { RESET_AFTER + 1 } else { 0 };
                self.enumerate(step, now);
            }
            PortState::Pause(end, step) if now >= *end => self.enumerate(*step, now),
            PortState::Enumeration(_, transfer) => {
                let transfer = transfer.clone();
                self.begin_control(now, &transfer, usb, hears);
            }
            PortState::Open => match self.control.clone() {
                Some(transfer) => self.begin_control(now, &transfer, usb, hears),
                None => self.begin_data(now, usb, hears),
            },
            _ => {}
        }
    }

    /// Reserves the wire for a transaction with so many bytes. Returns false if the frame has no room for it.
    fn reserve(&mut self, now: Time, bytes: usize, transaction: Transaction) -> bool {
        let end = now + (OVERHEAD + bytes) as Time * BYTE;
        let fits = end <= self.frame;
        if fits {
            self.next = end;
            self.under_way = Some(transaction);
        }
        fits
    }

    fn begin_control(
        &mut self,
        now: Time,
        transfer: &ControlTransfer,
        usb: &mut dyn UsbController,
        hears: bool,
    ) {
        match transfer.stage {
            Stage::FromDevice | Stage::StatusFromDevice => {
                let answer = match hears {
                    true => usb.give(self.address(), 0),
                    false => Answer::Silence,
                };
                match answer {
                    Answer::Packet(packet) => {
                        self.silences = 0;
                        let bytes = packet.bytes.len();
                        self.reserve(now, bytes, Transaction::Control(Some(packet)));
                    }
                    answer => self.not_done(now, &answer, transfer.request),
                }
            }
            stage => {
                let bytes = match stage {
                    Stage::SetUp => 8,
                    _ => transfer.packet().bytes.len(),
                };
                self.reserve(now, bytes, Transaction::Control(None));
            }
        }
    }

    fn begin_data(&mut self, now: Time, usb: &mut dyn UsbController, hears: bool) {
        let Some((_, from)) = self.found.endpoints else {
            return;
        };
        let has_bytes = self.is_carrying && !self.to_board.is_empty();
        let has_room = self.is_carrying || self.from_board.len() - self.taken < KEPT;
        self.is_devices_turn = !self.is_devices_turn;
        if has_room && (self.is_devices_turn || !has_bytes) {
            let answer = match hears {
                true => usb.give(ADDRESS, from),
                false => Answer::Silence,
            };
            match answer {
                Answer::Packet(packet) => {
                    self.silences = 0;
                    let bytes = packet.bytes.len();
                    self.reserve(now, bytes, Transaction::FromDevice(packet));
                    return;
                }
                answer => self.not_done(now, &answer, [from; 8]),
            }
        }
        if has_bytes && self.under_way.is_none() && matches!(self.state, PortState::Open) {
            let bytes: Vec<u8> = self.to_board.iter().copied().take(PACKET).collect();
            let (length, odd) = (bytes.len(), self.is_odd.0);
            let packet = UsbPacket { bytes, odd };
            self.reserve(now, length, Transaction::ToDevice(packet));
        }
    }

    fn end(
        &mut self,
        now: Time,
        transaction: Transaction,
        usb: &mut dyn UsbController,
        hears: bool,
    ) {
        match transaction {
            Transaction::FromDevice(packet) => {
                let Some((_, from)) = self.found.endpoints else {
                    return;
                };
                usb.acknowledge(from);
                self.count_packet();
                if packet.odd != self.is_odd.1 {
                    let text = "a packet of data has the wrong toggle";
                    self.errors.push(text.into());
                }
                self.is_odd.1 = !packet.odd;
                let bytes = packet.bytes.iter().map(|byte| (now, *byte));
                self.from_board.extend(bytes);
            }
            Transaction::ToDevice(packet) => {
                let Some((to, _)) = self.found.endpoints else {
                    return;
                };
                let answer = match hears {
                    true => usb.take(ADDRESS, to, &packet),
                    false => Answer::Silence,
                };
                match answer {
                    Answer::Taken => {
                        self.silences = 0;
                        self.count_packet();
                        self.is_odd.0 = !self.is_odd.0;
                        self.to_board.drain(..packet.bytes.len());
                        self.went += packet.bytes.len();
                    }
                    answer => self.not_done(now, &answer, [to; 8]),
                }
            }
            Transaction::Control(given) => self.end_control(now, given, usb, hears),
        }
    }

    fn end_control(
        &mut self,
        now: Time,
        given: Option<UsbPacket>,
        usb: &mut dyn UsbController,
        hears: bool,
    ) {
        let address = self.address();
        let Some(transfer) = self.transfer() else {
            return;
        };
        let request = transfer.request;
        let answer = match (&given, transfer.stage) {
            (Some(_), _) => Answer::Taken,
            _ if !hears => Answer::Silence,
            (None, Stage::SetUp) => usb.set_up(address, request),
            (None, _) => usb.take(address, 0, &transfer.packet()),
        };
        if answer != Answer::Taken {
            return self.not_done(now, &answer, request);
        }
        let is_over = match &given {
            Some(packet) => {
                usb.acknowledge(0);
                transfer.came(packet)
            }
            None => Ok(transfer.went()),
        };
        self.silences = 0;
        match is_over {
            Ok(false) => {}
            Ok(true) => self.finish_control(now),
            Err(text) => {
                self.errors.push(text);
                self.reset(now);
            }
        }
    }

    fn transfer(&mut self) -> Option<&mut ControlTransfer> {
        match &mut self.state {
            PortState::Enumeration(_, transfer) => Some(transfer),
            _ => self.control.as_mut(),
        }
    }

    /// Address of the device in the present step.
    fn address(&self) -> u8 {
        match &self.state {
            PortState::Enumeration(step, _) if *step <= ADDRESS_STEP => 0,
            _ => ADDRESS,
        }
    }

    fn finish_control(&mut self, now: Time) {
        let PortState::Enumeration(step, transfer) = &self.state else {
            self.control = None;
            return;
        };
        let step = *step;
        self.found.learn(step, &transfer.received);
        if step == RESET_AFTER && !self.is_second {
            self.is_second = true;
            self.state = PortState::Reset;
        } else if step == ADDRESS_STEP {
            self.state = PortState::Pause(now + ADDRESS_RECOVERY, step + 1);
        } else {
            self.enumerate(step + 1, now);
        }
    }

    /// Begins a step of the enumeration, or ends it.
    fn enumerate(&mut self, step: usize, now: Time) {
        self.state = match self.found.step(step) {
            Some(transfer) => PortState::Enumeration(step, transfer),
            None => {
                self.opened = Some(now);
                self.enumerations += 1;
                PortState::Open
            }
        };
    }

    /// The device has refused, or not answered.
    fn not_done(&mut self, now: Time, answer: &Answer, request: [u8; 8]) {
        match answer {
            Answer::NotNow => self.silences = 0,
            Answer::Stall => {
                self.errors.push(format!("the device refuses {request:?}"));
                self.reset(now);
            }
            _ => {
                self.silences += 1;
                if self.silences >= SILENCES {
                    self.reset(now);
                }
            }
        }
        self.next = now + RETRY;
    }

    fn count_packet(&mut self) {
        self.packets += 1;
        self.most_packets = self.most_packets.max(self.packets);
    }
}
