//! Published records by their numbers, for those who have missed some.

use std::collections::VecDeque;
use std::ops::Range;

/// The last items, numbered from 0 without a gap.
#[derive(Clone, Debug)]
pub(crate) struct History<T> {
    items: VecDeque<T>,
    room: usize,
    next: u64,
}

impl<T> History<T> {
    /// Keeps the last `room` items, at least one.
    pub(crate) fn new(room: usize) -> Self {
        Self {
            items: VecDeque::new(),
            room: room.max(1),
            next: 0,
        }
    }

    /// Number of the next item.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// Number of the first item that is kept.
    pub(crate) fn first(&self) -> u64 {
        self.next - self.items.len() as u64
    }

    /// The newest item.
    pub(crate) fn last(&self) -> Option<&T> {
        self.items.back()
    }

    pub(crate) fn push(&mut self, item: T) {
        if self.items.len() >= self.room {
            self.items.pop_front();
        }
        self.items.push_back(item);
        self.next += 1;
    }

    /// Returns the part of `range` that is kept, at most `most` items of it from its begin on.
    pub(crate) fn kept(&self, range: Range<u64>, most: usize) -> Range<u64> {
        let start = range.start.clamp(self.first(), self.next);
        let end = range.end.clamp(start, self.next);
        start..end.min(start.saturating_add(most as u64))
    }

    /// Returns the items of a range that is [kept](Self::kept).
    pub(crate) fn items(&self, range: Range<u64>) -> impl ExactSizeIterator<Item = &T> {
        let range = self.kept(range, usize::MAX);
        let first = self.first();
        // The range lies within the items: both fit.
        self.items
            .range((range.start - first) as usize..(range.end - first) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_items_are_found_by_their_numbers() {
        let mut history = History::new(4);
        assert_eq!(history.kept(0..10, 9), 0..0);
        for number in 0..10_u64 {
            history.push(number);
        }
        assert_eq!((history.first(), history.next()), (6, 10));
        let items = |range| history.items(range).copied().collect::<Vec<_>>();
        assert_eq!(items(7..9), [7, 8]);
        assert_eq!(items(0..u64::MAX), [6, 7, 8, 9]);
        assert_eq!(items(20..30), [0; 0]);
        assert_eq!(history.kept(0..9, 2), 6..8);
        let backwards = Range { start: 9, end: 7 };
        assert_eq!(history.kept(backwards, 5), 9..9);
    }
}
