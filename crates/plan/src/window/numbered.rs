//! A queue whose items keep their numbers.

use heapless::{Deque, Vec};

/// A value that may be there. None is a count of zero: a planner that lies in a static of an image costs no flash.
pub(super) type Maybe<T> = Vec<T, 1>;

/// Sets `maybe` to a value.
pub(super) fn set<T>(maybe: &mut Maybe<T>, value: T) {
    maybe.clear();
    let _ = maybe.push(value);
}

/// Items with the numbers `first`, `first + 1` and so on.
#[derive(Clone, Debug)]
pub(super) struct Numbered<T, const N: usize> {
    items: Deque<T, N>,
    first: u32,
}

impl<T, const N: usize> Numbered<T, N> {
    pub(super) const fn new() -> Self {
        Self {
            items: Deque::new(),
            first: 0,
        }
    }

    /// Number of the oldest item.
    pub(super) fn first(&self) -> u32 {
        self.first
    }

    /// Number of the item that is put in next.
    pub(super) fn end(&self) -> u32 {
        self.first.wrapping_add(self.items.len() as u32)
    }

    pub(super) fn has_room(&self) -> bool {
        !self.items.is_full()
    }

    pub(super) fn get(&self, number: u32) -> Option<&T> {
        self.items.get(number.wrapping_sub(self.first) as usize)
    }

    pub(super) fn get_mut(&mut self, number: u32) -> Option<&mut T> {
        self.items.get_mut(number.wrapping_sub(self.first) as usize)
    }

    /// Puts `item` in. Returns false where there is no room.
    pub(super) fn push(&mut self, item: T) -> bool {
        self.items.push_back(item).is_ok()
    }

    /// Drops the items before `number`.
    pub(super) fn drop_before(&mut self, number: u32) {
        while self.first != number && self.items.pop_front().is_some() {
            self.first = self.first.wrapping_add(1);
        }
    }

    /// Drops the items from `number` on.
    pub(super) fn truncate(&mut self, number: u32) {
        let keep = number.wrapping_sub(self.first) as usize;
        while self.items.len() > keep && self.items.pop_back().is_some() {}
    }
}
