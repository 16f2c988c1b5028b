//! Moves that were offered.

use crate::curves::PlayedCurves;
use crate::offered::Offered;
use crate::splice::Place;
use heapless::deque::DequeView;
use trirrr_core::number::Number;

/// Moves that are not judged yet. Before them those that are admitted and not over, in services that may cut one.
pub(crate) struct OfferedMoves<'q, N: Number, K: PlayedCurves> {
    moves: &'q mut DequeView<Offered<N, K>>,
    admitted: usize,
}

impl<'q, N: Number, K: PlayedCurves> OfferedMoves<'q, N, K> {
    pub(crate) fn new(moves: &'q mut DequeView<Offered<N, K>>) -> Self {
        Self { moves, admitted: 0 }
    }

    /// Moves that are not judged.
    pub(super) fn waiting(&self) -> usize {
        self.moves.storage_len() - self.admitted()
    }

    /// Moves before them.
    #[inline(always)]
    fn admitted(&self) -> usize {
        if K::CUTS { self.admitted } else { 0 }
    }

    /// Moves for which there is room.
    pub(super) fn room(&self) -> usize {
        self.moves.storage_capacity() - self.moves.storage_len()
    }

    /// Moves for which there is room where there are none.
    pub(super) fn capacity(&self) -> usize {
        self.moves.storage_capacity()
    }

    /// Adds a move that is not judged. Returns false if there is no room.
    pub(super) fn add(&mut self, offered: Offered<N, K>) -> bool {
        self.moves.push_back(offered).is_ok()
    }

    /// Adds a move that is admitted, behind others that are.
    pub(super) fn add_admitted(&mut self, offered: Offered<N, K>) {
        if self.add(offered) {
            self.admitted += 1;
        }
    }

    /// The oldest move that is not judged.
    pub(super) fn peek(&self) -> Option<&Offered<N, K>> {
        match self.admitted() {
            0 => self.moves.front(),
            admitted => self.moves.get(admitted),
        }
    }

    /// The same, no longer to be judged: it is admitted.
    pub(super) fn admit(&mut self) -> Option<Offered<N, K>> {
        if !K::CUTS {
            return self.moves.pop_front();
        }
        let offered = *self.peek()?;
        self.admitted += 1;
        Some(offered)
    }

    /// Drops all that are not judged. Returns the oldest of them.
    pub(super) fn refuse(&mut self) -> Option<Offered<N, K>> {
        let mut oldest = None;
        while self.waiting() != 0 {
            oldest = self.moves.pop_back();
        }
        oldest
    }

    /// Drops all.
    pub(super) fn clear(&mut self) {
        self.moves.clear();
        self.admitted = 0;
    }

    /// Drops the moves before number `done`.
    pub(super) fn release(&mut self, done: u32) {
        while self.admitted() != 0
            && let Some(first) = self.moves.front()
            && (first.common.number.wrapping_sub(done) as i32) < 0
        {
            self.moves.pop_front();
            self.admitted -= 1;
        }
    }

    /// Drops the moves behind number `last`.
    pub(super) fn cut_behind(&mut self, last: u32) {
        while let Some(back) = self.moves.back()
            && (back.common.number.wrapping_sub(last) as i32) > 0
        {
            self.moves.pop_back();
        }
        self.admitted = self.admitted.min(self.moves.storage_len());
    }

    /// The place so many ticks behind a place on admitted moves, with its move; none behind their end. `count` moves from
    /// the oldest on end with it.
    pub(super) fn place_behind(
        &self,
        from: Place,
        ticks: u32,
    ) -> Option<(Place, Offered<N, K>, usize)> {
        let mut left = from.tick.saturating_add(ticks);
        for index in 0..self.admitted {
            let offered = self.moves.get(index)?;
            let number = offered.common.number;
            if (number.wrapping_sub(from.number) as i32) < 0 {
                continue;
            }
            if left <= offered.common.ticks {
                return Some((Place { number, tick: left }, *offered, index + 1));
            }
            left -= offered.common.ticks;
        }
        None
    }
}
