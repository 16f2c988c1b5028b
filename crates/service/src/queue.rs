//! The two ends of a queue, without a panic.
//!
//! The ends that `heapless` gives hold no length at compile time and divide by one at run time. A
//! queue's length is never zero, but the compiler does not know: a path to a panic would be left
//! in the tick. Asking for the capacity first tells it.

use heapless::spsc::{Consumer, Producer};

/// End of a queue at which one side puts items in.
pub(super) struct Sender<'q, T> {
    producer: Producer<'q, T>,
    /// Items that there is room for at least: the other side only makes room.
    room: usize,
}

/// End of a queue at which the other side takes items out.
pub(super) struct Receiver<'q, T>(Consumer<'q, T>);

/// Both ends of a queue that one side uses alone.
pub(super) type BothEnds<'q, T> = (Sender<'q, T>, Receiver<'q, T>);

impl<'q, T> Sender<'q, T> {
    pub(super) fn new(producer: Producer<'q, T>) -> Self {
        Self { producer, room: 0 }
    }

    /// Puts `item` in; whether there was room.
    #[inline]
    #[allow(unsafe_code)]
    pub(super) fn send(&mut self, item: T) -> bool {
        if !self.has_room() {
            return false;
        }
        // SAFETY: there is room, and nobody else puts in. `enqueue` would hand the item back where
        // there is none, and copy it back and forth for that.
        unsafe { self.producer.enqueue_unchecked(item) };
        self.room -= 1;
        true
    }

    /// Returns whether there is room for an item. It is counted, by a division, where the last count is used up.
    #[inline]
    pub(super) fn has_room(&mut self) -> bool {
        if self.room == 0 {
            self.room = self.capacity() - self.len();
        }
        self.room != 0
    }

    /// Items that wait.
    pub(super) fn len(&self) -> usize {
        if self.producer.capacity() == usize::MAX {
            return 0;
        }
        self.producer.len()
    }

    /// Items that there is room for at most.
    pub(super) fn capacity(&self) -> usize {
        self.producer.capacity()
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
