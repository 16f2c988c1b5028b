//! The two ends of a queue, without a panic.
//!
//! The ends that `heapless` gives hold no length at compile time and divide by one at run time. A
//! queue's length is never zero, but the compiler does not know: a path to a panic would be left
//! in the tick. Asking for the capacity first tells it.

use heapless::spsc::{Consumer, Producer};

/// Where one side puts in.
pub(super) struct Sender<'q, T>(Producer<'q, T>);

/// Where the other side takes out.
pub(super) struct Receiver<'q, T>(Consumer<'q, T>);

impl<'q, T> Sender<'q, T> {
    pub(super) fn new(producer: Producer<'q, T>) -> Self {
        Self(producer)
    }

    /// Puts `item` in; whether there was room.
    #[inline]
    pub(super) fn send(&mut self, item: T) -> bool {
        self.0.capacity() != usize::MAX && self.0.enqueue(item).is_ok()
    }

    /// Whether there is room.
    #[inline]
    pub(super) fn has_room(&self) -> bool {
        self.0.capacity() != usize::MAX && self.0.ready()
    }

    /// Items that wait.
    pub(super) fn len(&self) -> usize {
        if self.0.capacity() == usize::MAX {
            return 0;
        }
        self.0.len()
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
        self.0.peek()
    }

    /// Whether there is no room for another.
    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.0.capacity() != usize::MAX && self.0.len() == self.0.capacity()
    }
}
