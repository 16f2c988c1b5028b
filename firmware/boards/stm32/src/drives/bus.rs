//! CAN controller as the tick sees it, and the way of received frames: the interrupt of the controller has its reception for itself and fills
//! a queue, which the tick empties.
//!
//! Nothing waits without bound. Frames go out in the order in which they came. The controller repeats a frame
//! until a drive has acknowledged it. Frames come in from the drives alone: a filter for each of them keeps others out.
#![allow(unsafe_code)]

use crate::chip::bus::{self, BusFrame, BusTiming, INTERRUPT};
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::interrupt::{Mutex, free};
use cortex_m::peripheral::NVIC;
use embedded_can::ErrorKind;
use heapless::spsc::{Consumer, Producer, Queue};
use trirrr_app::scene::drive::{FILTERS, HEARD};
use trirrr_drives::can::Bus;

/// Queue of the frames that came in: a tick's, and the place that stays empty.
pub(crate) type Inbox = Queue<BusFrame, { HEARD as usize + 1 }>;

/// Returns an empty queue.
pub(crate) const fn no_frames() -> Inbox {
    Queue::new()
}

/// Frames that were lost: the interrupt came too late, or the queue was full. The interrupt alone adds.
static LOST: AtomicU32 = AtomicU32::new(0);

/// The queue's end of reception, until the interrupt has taken it.
static RECEPTION: Mutex<Cell<Option<Received>>> = Mutex::new(Cell::new(None));

/// Received frames, on their way into the queue.
pub(crate) type Received = Producer<'static, BusFrame>;

/// The controller is off the bus, or did not start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Off;

impl embedded_can::Error for Off {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The controller: places of frames that go out, and the queue of what came in.
pub(crate) struct BusController {
    /// The start has not failed.
    runs: bool,
    inbox: Consumer<'static, BusFrame>,
}

impl BusController {
    /// Starts the controller with this bit timing, or fails without one. It takes frames from the drives alone, and takes part once the bus has
    /// been idle.
    pub(super) fn start(timing: Option<BusTiming>, inbox: &'static mut Inbox) -> Self {
        let (frames, inbox) = inbox.split();
        let runs = timing.is_some_and(|timing| bus::configure(timing, &FILTERS));
        if !runs {
            defmt::error!("the CAN controller does not start");
        }
        free(|section| RECEPTION.borrow(section).set(Some(frames)));
        // It is an interrupt of its own: as a task it would be unmasked in every image.
        // SAFETY: the interrupt has the registers of reception for itself, the tick those of transmission. No task
        // shares anything with the interrupt, so no lock has to keep it out.
        unsafe { NVIC::unmask(INTERRUPT) };
        Self { runs, inbox }
    }
}

impl embedded_can::nb::Can for BusController {
    type Frame = BusFrame;
    type Error = Off;

    #[inline]
    fn transmit(&mut self, frame: &BusFrame) -> nb::Result<Option<BusFrame>, Off> {
        match self.runs {
            true => bus::transmit(frame).map(|()| None),
            false => Err(nb::Error::Other(Off)),
        }
    }

    #[inline]
    fn receive(&mut self) -> nb::Result<BusFrame, Off> {
        self.inbox.dequeue().ok_or(nb::Error::WouldBlock)
    }
}

impl Bus for BusController {
    fn abort(&mut self) {
        if self.runs {
            bus::abort();
        }
    }
}

/// Runs reception in its interrupt, which keeps the queue's end in `own`.
#[inline(always)]
pub(crate) fn run(own: &mut Option<Received>) {
    if own.is_none() {
        *own = free(|section| RECEPTION.borrow(section).take());
    }
    if let Some(frames) = own {
        bus::receive(frames);
    }
}

/// Puts a frame into the queue, or counts it as lost.
#[inline(always)]
pub(crate) fn put(frames: &mut Received, frame: BusFrame) {
    if frames.enqueue(frame).is_err() {
        count_lost();
    }
}

/// Counts a lost frame.
#[cold]
pub(crate) fn count_lost() {
    // A load and a store would do: the log, which sets the count to 0, is below.
    LOST.fetch_add(1, Ordering::Relaxed);
}

/// Logs frames that were lost since the last call, which the queue has room for.
pub(crate) fn report() {
    let lost = LOST.swap(0, Ordering::Relaxed);
    if lost > 0 {
        defmt::error!("{=u32} frames from the bus were lost", lost);
    }
}
