//! The tick's end of power lists.

use super::list::MoveLevels;
use super::{full_count, slot};
use crate::number::ServiceNumber;
use crate::queue::Receiver;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{FULL_LEVEL, LISTED};

/// End at which the tick takes lists.
pub(crate) struct LevelPlayer<'q, N: ServiceNumber> {
    levels: &'q [AtomicU8],
    lists: Receiver<'q, MoveLevels<N>>,
    released: &'q AtomicU32,
    /// List of the move under way,
    current: Option<MoveLevels<N>>,
    /// and the index of the level in it.
    index: u16,
    full: N::Count,
}

impl<'q, N: ServiceNumber> LevelPlayer<'q, N> {
    pub(super) fn new(
        levels: &'q [AtomicU8],
        lists: Receiver<'q, MoveLevels<N>>,
        released: &'q AtomicU32,
    ) -> Self {
        Self {
            levels,
            lists,
            released,
            current: None,
            index: 0,
            full: full_count::<N>(),
        }
    }

    /// Takes the list of move `number`, which begins, if the move has one. Lists of moves that are over or dropped go.
    #[inline(never)]
    pub(crate) fn begin(&mut self, number: u32, generation: u8) {
        self.end();
        for _ in 0..=LISTED {
            let Some(front) = self.lists.peek() else {
                return;
            };
            let ahead = front.number.wrapping_sub(number) as i32;
            if front.generation == generation && ahead > 0 {
                return;
            }
            if front.generation == generation && ahead == 0 {
                self.current = self.lists.receive();
                self.index = 0;
                return;
            }
            self.drop_front();
        }
    }

    /// Drops a list of another generation, if it is the next.
    #[inline]
    pub(crate) fn drop_stale(&mut self, generation: u8) {
        if self
            .lists
            .peek()
            .is_some_and(|front| front.generation != generation)
        {
            self.drop_front();
        }
    }

    /// The move under way is over.
    pub(crate) fn end(&mut self) {
        if let Some(list) = self.current.take() {
            self.release(&list);
        }
    }

    /// Returns true if the move under way has levels.
    #[cfg(test)]
    pub(crate) fn has_levels(&self) -> bool {
        self.current.is_some()
    }

    fn drop_front(&mut self) {
        if let Some(list) = self.lists.receive() {
            self.release(&list);
        }
    }

    /// Gives the levels of a list back.
    fn release(&self, list: &MoveLevels<N>) {
        self.released.store(list.range.next(), Ordering::Release);
    }

    /// Power from `setpoint` on: the part of `power` that the level there says, all of it where the move has no levels.
    #[inline]
    pub(crate) fn part_of(&mut self, power: N, setpoint: &Setpoint<N>) -> N {
        let Some(list) = &self.current else {
            return power;
        };
        self.index = list.index_from(self.index, setpoint);
        let number = list.range.first.wrapping_add(u32::from(self.index));
        let level = slot(self.levels, number).map_or(0, |level| level.load(Ordering::Relaxed));
        match level {
            FULL_LEVEL => power,
            level => power * N::fraction(u32::from(level), &self.full),
        }
    }
}
