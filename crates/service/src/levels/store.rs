//! The background's end of power lists.

use super::list::MoveLevels;
use super::slot;
use crate::number::ServiceNumber;
use crate::offered::Offered;
use crate::queue::Sender;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use heapless::Deque;
use trirrr_core::setpoint::CurveKind;
use trirrr_protocol::message::{LEVELS, LISTED, LevelPiece, LevelRange, Refusal};

/// End at which the background puts levels and lists in.
///
/// Levels are counted modulo 2^32. Those before `released` may be overwritten; those up to `sent` belong to admitted moves, those
/// up to `bound` to offered ones, those up to `written` to nobody yet.
pub(crate) struct LevelStore<'q, N: ServiceNumber> {
    levels: &'q [AtomicU8],
    lists: Sender<'q, MoveLevels<N>>,
    released: &'q AtomicU32,
    period: N::Factor,
    /// Most levels that are held at a time; 0 of a machine that plays no lists.
    room: u16,
    /// Lists of moves that are not judged yet.
    waiting: Deque<MoveLevels<N>, LISTED>,
    sent: u32,
    bound: u32,
    written: u32,
}

impl<'q, N: ServiceNumber> LevelStore<'q, N> {
    pub(super) fn new(
        levels: &'q [AtomicU8],
        lists: Sender<'q, MoveLevels<N>>,
        released: &'q AtomicU32,
        (period, room): (N::Factor, u16),
    ) -> Self {
        Self {
            levels,
            lists,
            released,
            period,
            room,
            waiting: Deque::new(),
            sent: 0,
            bound: 0,
            written: 0,
        }
    }

    /// Most levels that are held at a time; 0 of a machine that plays no lists.
    pub(crate) fn room(&self) -> u16 {
        self.room
    }

    /// Takes levels, in the place of those given before and not taken by a move from there on.
    pub(crate) fn give(&mut self, piece: &LevelPiece) -> Result<(), Refusal<N>> {
        if self.room == 0 {
            return Err(Refusal::NoLevels);
        }
        if piece.count == 0 || usize::from(piece.count) > LEVELS {
            return Err(Refusal::LevelRange);
        }
        if !self.is_free(piece.first) {
            return Err(Refusal::LevelNumber {
                expected: self.written,
            });
        }
        let released = self.released.load(Ordering::Acquire);
        if piece.next().wrapping_sub(released) > u32::from(self.room) {
            return Err(Refusal::LevelsFull);
        }
        for (number, level) in (0..).zip(piece.levels()) {
            if let Some(place) = slot(self.levels, piece.first.wrapping_add(number)) {
                place.store(*level, Ordering::Relaxed);
            }
        }
        self.written = piece.next();
        Ok(())
    }

    /// Returns true if level `number` belongs to no move, or is the next to give.
    fn is_free(&self, number: u32) -> bool {
        number.wrapping_sub(self.bound) <= self.written.wrapping_sub(self.bound)
    }

    /// Looks at the levels of a move that is to be taken.
    pub(crate) fn list<K: CurveKind>(
        &mut self,
        offered: &Offered<N, K>,
        range: LevelRange,
    ) -> Result<MoveLevels<N>, Refusal<N>> {
        if self.room == 0 {
            return Err(Refusal::NoLevels);
        }
        let ahead = |number: u32| number.wrapping_sub(self.bound);
        let is_given = self.is_free(range.first)
            && self.is_free(range.next())
            && ahead(range.first) < ahead(range.next());
        if !is_given {
            return Err(Refusal::LevelNumber {
                expected: self.written,
            });
        }
        if !range.is_whole() {
            return Err(Refusal::LevelRange);
        }
        if self.waiting.len() + self.lists.len() >= LISTED {
            return Err(Refusal::QueueFull);
        }
        MoveLevels::new(offered, range, self.period).ok_or(Refusal::LevelRange)
    }

    /// Keeps the list of a move that was taken, until it is judged.
    pub(crate) fn bind(&mut self, list: MoveLevels<N>) {
        self.bound = list.range.next();
        // There is room: it was looked for.
        let _ = self.waiting.push_back(list);
    }

    /// Hands the list of move `number` to the tick, if the move has one. It is to be played next after those before it.
    pub(crate) fn admit(&mut self, number: u32, generation: u8) {
        if self
            .waiting
            .front()
            .is_some_and(|list| list.number == number)
            && let Some(list) = self.waiting.pop_front()
        {
            self.sent = list.range.next();
            self.lists.send(list.of_generation(generation));
        }
    }

    /// Levels that are not free: those given, and those that belong to moves.
    #[cfg(test)]
    pub(crate) fn held(&self) -> [u32; 2] {
        let released = self.released.load(Ordering::Acquire);
        [self.written, self.bound].map(|number| number.wrapping_sub(released))
    }

    /// Drops the lists of moves that are not judged, and the levels that no admitted move has.
    pub(crate) fn withdraw(&mut self) {
        self.waiting.clear();
        self.bound = self.sent;
        self.written = self.sent;
    }
}
