//! Ticks of a job before each of its moves.

use std::collections::VecDeque;

/// Ticks before each of the moves that are known.
#[derive(Debug, Default)]
pub(super) struct MoveStarts {
    /// Index of the first move that is known.
    first: u32,
    ticks: VecDeque<u64>,
}

impl MoveStarts {
    /// Adds moves from `index` on, `before` ticks into the job, by their durations. Returns the ticks at their end. Moves that do not
    /// follow those that are known take their place.
    pub(super) fn extend(
        &mut self,
        index: u32,
        before: u64,
        ticks: impl IntoIterator<Item = u32>,
    ) -> u64 {
        if index != self.first + self.ticks.len() as u32 {
            self.ticks.clear();
            self.first = index;
        }
        ticks.into_iter().fold(before, |start, ticks| {
            self.ticks.push_back(start);
            start + u64::from(ticks)
        })
    }

    /// Forgets all moves but the last `count`.
    pub(super) fn keep(&mut self, count: usize) {
        let gone = self.ticks.len().saturating_sub(count);
        self.ticks.drain(..gone);
        self.first += gone as u32;
    }

    /// Ticks before the move `index`, if it is known.
    pub(super) fn before(&self, index: u32) -> Option<u64> {
        let at = index.checked_sub(self.first)?;
        self.ticks.get(at as usize).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_moves_keep_their_ticks() {
        let mut starts = MoveStarts::default();
        assert_eq!(starts.extend(0, 0, [10, 20, 30]), 60);
        assert_eq!(starts.extend(3, 60, [40]), 100);
        assert_eq!(
            [0, 1, 3].map(|index| starts.before(index)),
            [Some(0), Some(10), Some(60)]
        );
        assert_eq!(starts.before(4), None);
        starts.keep(2);
        assert_eq!(
            [1, 2, 3].map(|index| starts.before(index)),
            [None, Some(30), Some(60)]
        );
        // A jump.
        starts.extend(50, 7000, [5, 5]);
        assert_eq!(
            [3, 50, 51].map(|index| starts.before(index)),
            [None, Some(7000), Some(7005)]
        );
    }
}
