//! The two ends of a queue, without a panic, for two cores too.
//!
//! The ends that `heapless` gives hold no length at compile time and divide by one at run time. A
//! queue's length is never zero, but the compiler does not know: a path to a panic would be left
//! in the tick. Asking for the capacity first tells it.

use core::sync::atomic::{Ordering, fence};
use heapless::spsc::{Consumer, Producer};

/// End of a queue at which one side puts items in.
pub(super) struct Sender<'q, T>(Producer<'q, T>);

/// End of a queue at which the other side takes items out.
pub(super) struct Receiver<'q, T>(Consumer<'q, T>);

/// Both ends of a queue that one side uses alone.
pub(super) type BothEnds<'q, T> = (Sender<'q, T>, Receiver<'q, T>);

impl<'q, T> Sender<'q, T> {
    pub(super) fn new(producer: Producer<'q, T>) -> Self {
        Self(producer)
    }

    /// Puts `item` in. Returns false if there is no room.
    #[inline]
    pub(super) fn send(&mut self, item: T) -> bool {
        self.0.capacity() != usize::MAX && self.0.enqueue(item).is_ok()
    }

    /// Returns true if there is room for an item.
    #[inline]
    pub(super) fn has_room(&self) -> bool {
        self.0.capacity() != usize::MAX && self.0.ready()
    }

    /// Items that wait.
    pub(super) fn len(&self) -> usize {
        match self.0.capacity() {
            usize::MAX => 0,
            _ => self.0.len(),
        }
    }

    /// Items that there is room for at most.
    pub(super) fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<'q, T> Receiver<'q, T> {
    pub(super) fn new(consumer: Consumer<'q, T>) -> Self {
        Self(consumer)
    }

    /// The oldest item, taken out.
    #[inline]
    pub(super) fn receive(&mut self) -> Option<T> {
        if self.0.capacity() == usize::MAX {
            return None;
        }
        self.0.dequeue()
    }

    /// The oldest item.
    #[inline]
    pub(super) fn peek(&self) -> Option<&T> {
        if !self.0.ready() {
            return None;
        }
        // `peek` looks only whether there is an item: it does not wait for the item to be written on another core, as `dequeue` does.
        fence(Ordering::Acquire);
        self.0.peek()
    }

    /// Takes the oldest item out and drops it.
    #[inline]
    pub(super) fn discard(&mut self) {
        self.receive();
    }

    /// Items that wait.
    pub(super) fn len(&self) -> usize {
        match self.0.capacity() {
            usize::MAX => 0,
            _ => self.0.len(),
        }
    }

    /// Items that there is room for at most.
    pub(super) fn capacity(&self) -> usize {
        self.0.capacity()
    }
}
