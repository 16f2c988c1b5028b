//! Parts that every CAN controller has: its failure, and the way of received frames. The interrupt of the controller has its reception
//! for itself and fills a queue, which the tick empties.
#![allow(unsafe_code)]

use super::super::controller::{BusFrame, FrameReceiver};
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::interrupt::{InterruptNumber, Mutex, free};
use cortex_m::peripheral::NVIC;
use embedded_can::ErrorKind;
use heapless::spsc::Producer;

/// Frames that were lost: the interrupt came too late, or the queue was full. The interrupt alone adds.
static LOST: AtomicU32 = AtomicU32::new(0);

/// Reception, until the interrupt has taken it.
static RECEIVER: Mutex<Cell<Option<FrameReceiver>>> = Mutex::new(Cell::new(None));

/// The controller is off the bus, or did not start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Off;

impl embedded_can::Error for Off {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// Hands reception to its interrupt, and lets that come. It is an interrupt of its own: as a task it would be unmasked in every image.
pub(crate) fn hand_over(receiver: FrameReceiver, interrupt: impl InterruptNumber) {
    free(|section| RECEIVER.borrow(section).set(Some(receiver)));
    // SAFETY: the interrupt has the registers of reception for itself, the tick those of transmission. No task
    // shares anything with the interrupt, so no lock has to keep it out.
    unsafe { NVIC::unmask(interrupt) };
}

/// Runs reception in its interrupt, which keeps it in `own`.
#[inline(always)]
pub(crate) fn run(own: &mut Option<FrameReceiver>) {
    if own.is_none() {
        *own = free(|section| RECEIVER.borrow(section).take());
    }
    if let Some(receiver) = own {
        receiver.run();
    }
}

/// Puts a frame into the queue, or counts it as lost.
#[inline(always)]
pub(crate) fn put(frames: &mut Producer<'static, BusFrame>, frame: BusFrame) {
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

/// Returns the frames that were lost since the last call.
pub(super) fn take_lost() -> u32 {
    LOST.swap(0, Ordering::Relaxed)
}
