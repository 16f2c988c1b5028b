//! Mailbox for a changed scene on its way to the tick.

use crate::queue::{Receiver, Sender};
use crate::splice::{Optional, Present};
use heapless::spsc::Queue;

/// Mailbox for one item between the two halves. A scene that cannot change at run time has one of
/// size zero.
pub trait Slot<T>: Send + 'static {
    /// Empty mailbox.
    const EMPTY: Self;

    /// Sending end.
    type Put<'q>: Put<T>;
    /// Receiving end.
    type Take<'q>: Take<T>;
    /// Memory that only a scene with a mailbox needs.
    type Memory<U: Copy + Default + Send>: Optional<U> + Copy + Default + Send;

    /// Returns both ends.
    fn split(&mut self) -> (Self::Put<'_>, Self::Take<'_>);
}

/// Sending end of a [`Slot`].
pub trait Put<T> {
    /// Puts `item` in. Returns false if there is no room.
    fn put(&mut self, item: T) -> bool;
}

/// Receiving end of a [`Slot`].
pub trait Take<T> {
    /// Takes the item out, if there is one.
    fn take(&mut self) -> Option<T>;
}

/// Mailbox without room, of size zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSlot;

impl<T> Slot<T> for NoSlot {
    const EMPTY: Self = Self;
    type Put<'q> = Self;
    type Take<'q> = Self;
    type Memory<U: Copy + Default + Send> = ();

    fn split(&mut self) -> (Self, Self) {
        (Self, Self)
    }
}

impl<T> Put<T> for NoSlot {
    fn put(&mut self, _: T) -> bool {
        false
    }
}

impl<T> Take<T> for NoSlot {
    #[inline(always)]
    fn take(&mut self) -> Option<T> {
        None
    }
}

impl<T: Send + 'static> Slot<T> for Queue<T, 2> {
    const EMPTY: Self = Queue::new();
    type Put<'q> = QueuePut<'q, T>;
    type Take<'q> = QueueTake<'q, T>;
    type Memory<U: Copy + Default + Send> = Present<U>;

    fn split(&mut self) -> (QueuePut<'_, T>, QueueTake<'_, T>) {
        let (put, take) = Queue::split(self);
        (QueuePut(Sender::new(put)), QueueTake(Receiver::new(take)))
    }
}

/// Sending end of a queue of one.
pub struct QueuePut<'q, T>(Sender<'q, T>);

/// Receiving end of a queue of one.
pub struct QueueTake<'q, T>(Receiver<'q, T>);

impl<T> Put<T> for QueuePut<'_, T> {
    fn put(&mut self, item: T) -> bool {
        self.0.send(item)
    }
}

impl<T> Take<T> for QueueTake<'_, T> {
    fn take(&mut self) -> Option<T> {
        self.0.receive()
    }
}
