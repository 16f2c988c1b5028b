//! The wire: one frame at a time, the lowest identifier first.

use super::frame::BusFrame;
use super::model::DriveModel;
use embedded_can::ErrorKind;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use trirrr_drives::can::Bus;

/// Mailboxes of the board's controller.
const MAILBOXES: usize = 3;

/// Faults of the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WireFaults {
    /// The board's controller is off the bus.
    pub board_is_off: bool,
    /// Share of the frames to the board that are lost, percent.
    pub lost_percent: u32,
    /// Frames to the board arrive so much later, ns.
    pub late_ns: u64,
    /// The wire between the board and the drives is cut: neither hears the other.
    pub is_cut: bool,
    /// The two wires touch: a bit that is sent is not there, and no frame passes.
    pub is_shorted: bool,
}

/// Event at the controller of the board, of a bus that is [stepped](Medium::step).
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerEvent<const LONGEST: usize> {
    /// The frame that was [offered](Medium::offer) has gone out, and a drive has acknowledged it.
    Sent(BusFrame<LONGEST>),
    /// No drive has acknowledged the frame.
    NotAcknowledged,
    /// The wire did not follow the bits of the controller.
    BitError,
    /// A drive's frame has come.
    Received(BusFrame<LONGEST>),
}

/// Bits from a bit that is not there to the next attempt: start and error flag, its delimiter, the space between frames.
const ERROR_BITS: u64 = 1 + 6 + 8 + 3;

/// A frame under way.
#[derive(Debug)]
struct Transfer<const LONGEST: usize> {
    frame: BusFrame<LONGEST>,
    /// The drive that sends; none for the board.
    from: Option<usize>,
    ends_ns: u64,
    /// The wire does not follow.
    is_error: bool,
}

/// A bus with a board and three drives.
pub struct Medium<const LONGEST: usize> {
    bit_rate_hz: u32,
    now_ns: u64,
    /// Frames of the board, in the order in which they go out.
    mailboxes: VecDeque<BusFrame<LONGEST>>,
    /// Frames for the board, with the times from which it has them.
    inbox: VecDeque<(u64, BusFrame<LONGEST>)>,
    transfer: Option<Transfer<LONGEST>>,
    /// Events that [`step`](Self::step) gives out, with their times.
    events: VecDeque<(u64, ControllerEvent<LONGEST>)>,
    is_stepped: bool,
    drives: [Box<dyn DriveModel<LONGEST> + Send>; 3],
    /// Faults to inject.
    pub faults: WireFaults,
    to_board: u32,
    /// Time that frames took, ns.
    busy_ns: u64,
}

impl<const LONGEST: usize> Medium<LONGEST> {
    /// A bus of `bit_rate_hz` with these drives.
    pub fn new(bit_rate_hz: u32, drives: [Box<dyn DriveModel<LONGEST> + Send>; 3]) -> Self {
        Self {
            bit_rate_hz,
            now_ns: 0,
            mailboxes: VecDeque::new(),
            inbox: VecDeque::new(),
            transfer: None,
            events: VecDeque::new(),
            is_stepped: false,
            drives,
            faults: WireFaults::default(),
            to_board: 0,
            busy_ns: 0,
        }
    }

    /// A drive of the bus.
    pub fn drive(&mut self, index: usize) -> &mut (dyn DriveModel<LONGEST> + Send) {
        &mut *self.drives[index]
    }

    /// Share of the time in which the bus was taken.
    pub fn load(&self) -> f64 {
        self.busy_ns as f64 / (self.now_ns.max(1)) as f64
    }

    /// Lets the time go on to `until_ns`.
    pub fn advance(&mut self, until_ns: u64) {
        while self.go_on(until_ns) {}
        self.arrive(until_ns);
    }

    /// Lets the time go on to `until_ns`, or to the next event at the controller of the board: for one that
    /// [offers](Self::offer) its frames itself, in place of an [`Endpoint`].
    pub fn step(&mut self, until_ns: u64) -> Option<(u64, ControllerEvent<LONGEST>)> {
        self.is_stepped = true;
        while self.events.is_empty() && self.go_on(until_ns) {}
        if self.events.is_empty() {
            self.arrive(until_ns);
        }
        self.events.pop_front()
    }

    /// Sets the frame with which the controller of the board takes part in the next arbitration. A frame under way goes on.
    pub fn offer(&mut self, frame: Option<BusFrame<LONGEST>>) {
        self.mailboxes.clear();
        self.mailboxes.extend(frame);
    }

    /// Returns true while a frame of the board is under way.
    pub fn is_sending(&self) -> bool {
        let transfer = self.transfer.as_ref();
        transfer.is_some_and(|transfer| transfer.from.is_none())
    }

    /// Returns the time until which nothing happens on the bus, ns; none if nothing will.
    pub fn next_ns(&self) -> Option<u64> {
        if let Some(transfer) = &self.transfer {
            return Some(transfer.ends_ns);
        }
        if !self.mailboxes.is_empty() && !self.faults.board_is_off {
            return Some(self.now_ns);
        }
        self.drives.iter().filter_map(|drive| drive.next_ns()).min()
    }

    /// Goes on by one frame, or to the next message of a drive. Returns false where nothing happens until `until_ns`.
    fn go_on(&mut self, until_ns: u64) -> bool {
        let ended = self
            .transfer
            .take_if(|transfer| transfer.ends_ns <= until_ns);
        if let Some(transfer) = ended {
            self.now_ns = transfer.ends_ns;
            self.deliver(transfer);
            return true;
        }
        if self.transfer.is_some() {
            return false;
        }
        for drive in &mut self.drives {
            drive.at(self.now_ns);
        }
        if self.begin() {
            return true;
        }
        // Nothing to send: up to the next message of a drive.
        let next = self.drives.iter().filter_map(|drive| drive.next_ns()).min();
        match next {
            Some(next) if next <= until_ns => {
                self.now_ns = next.max(self.now_ns + 1);
                true
            }
            _ => false,
        }
    }

    fn arrive(&mut self, until_ns: u64) {
        self.now_ns = self.now_ns.max(until_ns);
        for drive in &mut self.drives {
            drive.at(self.now_ns);
        }
    }

    /// Tells the controller of a bus that is stepped.
    fn tell(&mut self, event: ControllerEvent<LONGEST>) {
        if self.is_stepped {
            self.events.push_back((self.now_ns, event));
        }
    }

    /// Begins with the frame that wins, if there is one.
    fn begin(&mut self) -> bool {
        let of_board = self.mailboxes.front().filter(|_| !self.faults.board_is_off);
        let mut winner = of_board.map(|frame| (frame, None));
        let is_error = self.faults.is_shorted;
        for (index, drive) in self.drives.iter().enumerate() {
            if let Some(frame) = drive.waiting().filter(|_| !is_error)
                && winner.is_none_or(|(best, _)| frame.rank() < best.rank())
            {
                winner = Some((frame, Some(index)));
            }
        }
        let Some((frame, from)) = winner else {
            return false;
        };
        let frame = frame.clone();
        let duration_ns = match is_error {
            true => ERROR_BITS * 1_000_000_000 / u64::from(self.bit_rate_hz.max(1)),
            false => frame.duration_ns(self.bit_rate_hz),
        };
        self.busy_ns += duration_ns;
        self.transfer = Some(Transfer {
            frame,
            from,
            ends_ns: self.now_ns + duration_ns,
            is_error,
        });
        true
    }

    /// Ends a transfer. A frame that nobody has acknowledged goes out again.
    fn deliver(&mut self, transfer: Transfer<LONGEST>) {
        let Transfer {
            frame,
            from,
            ends_ns,
            is_error,
        } = transfer;
        if is_error {
            self.tell(ControllerEvent::BitError);
            return;
        }
        let board_hears = !self.faults.board_is_off && !self.faults.is_cut;
        let mut acknowledged = from.is_some() && board_hears;
        let drives_hear = from.is_some() || !self.faults.is_cut;
        for (index, drive) in self.drives.iter_mut().enumerate() {
            if Some(index) != from && drive.is_alive() && drives_hear {
                acknowledged = true;
                drive.receive(&frame, ends_ns);
            }
        }
        if !acknowledged {
            if from.is_none() {
                self.tell(ControllerEvent::NotAcknowledged);
            }
            return;
        }
        let Some(sender) = from else {
            self.tell(ControllerEvent::Sent(frame.clone()));
            // A frame that was dropped meanwhile is not there any more.
            if self.mailboxes.front() == Some(&frame) {
                self.mailboxes.pop_front();
            }
            return;
        };
        self.drives[sender].sent();
        self.to_board = self.to_board.wrapping_add(1);
        let faults = self.faults;
        // Scattered by the golden ratio: in no step with the drives' cycles.
        let scattered = self.to_board.wrapping_mul(0x9E37_79B9) >> 16;
        let is_lost = (scattered * 100) >> 16 < faults.lost_percent;
        if !is_lost && board_hears {
            match self.is_stepped {
                true => self.tell(ControllerEvent::Received(frame)),
                false => self.inbox.push_back((ends_ns + faults.late_ns, frame)),
            }
        }
    }
}

/// The board's controller on a [`Medium`].
pub struct Endpoint<const LONGEST: usize>(Arc<Mutex<Medium<LONGEST>>>);

impl<const LONGEST: usize> Endpoint<LONGEST> {
    /// Controller on `medium`.
    pub fn new(medium: Arc<Mutex<Medium<LONGEST>>>) -> Self {
        Self(medium)
    }

    fn medium(&self) -> MutexGuard<'_, Medium<LONGEST>> {
        // A panic elsewhere leaves nothing half done here.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The controller is off the bus.
#[derive(Clone, Copy, Debug)]
pub struct OffBus;

impl embedded_can::Error for OffBus {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl<const LONGEST: usize> embedded_can::nb::Can for Endpoint<LONGEST> {
    type Frame = BusFrame<LONGEST>;
    type Error = OffBus;

    fn transmit(&mut self, frame: &Self::Frame) -> nb::Result<Option<Self::Frame>, OffBus> {
        let mut medium = self.medium();
        if medium.faults.board_is_off {
            return Err(nb::Error::Other(OffBus));
        }
        if medium.mailboxes.len() == MAILBOXES {
            return Err(nb::Error::WouldBlock);
        }
        medium.mailboxes.push_back(frame.clone());
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Self::Frame, OffBus> {
        let mut medium = self.medium();
        match medium.inbox.front() {
            Some((since_ns, _)) if *since_ns <= medium.now_ns => {}
            _ => return Err(nb::Error::WouldBlock),
        }
        let next = medium.inbox.pop_front();
        next.map(|(_, frame)| frame).ok_or(nb::Error::WouldBlock)
    }
}

impl<const LONGEST: usize> Bus for Endpoint<LONGEST> {
    fn abort(&mut self) {
        self.medium().mailboxes.clear();
    }
}
