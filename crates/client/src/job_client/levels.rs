//! Levels of power that a client gives to a machine ahead of the moves that have them.

use core::ops::Range;
use trirrr_protocol::message::{LEVELS, LISTED, LevelPiece, LevelRange};
use trirrr_scene::JobLevels;

/// Levels of a job that a machine was given, as far as known.
#[derive(Clone, Debug, Default)]
pub(super) struct GivenLevels {
    /// Number by which the machine calls the first level of the job. A machine that counts otherwise says so.
    base: u32,
    /// The machine has taken levels by these numbers.
    is_known: bool,
    /// Levels that were given.
    given: u32,
    /// Levels for which the machine has room.
    room: u32,
}

/// Next act for a move with levels.
pub(super) enum NextLevels {
    /// Give these.
    Piece(LevelPiece),
    /// Offer the move: it has these.
    Given(LevelRange),
}

impl GivenLevels {
    pub(super) fn set_room(&mut self, room: u16) {
        self.room = room.into();
    }

    /// Next act for a move with the levels `range`. The moves `waiting` were offered and are not over. None while the machine has
    /// no room.
    pub(super) fn next(
        &self,
        levels: &JobLevels,
        range: &LevelRange,
        waiting: Range<u32>,
    ) -> Option<NextLevels> {
        if self.given >= range.next() {
            let number = self.base.wrapping_add(range.first);
            let range = LevelRange {
                first: number,
                ..*range
            };
            // That under way does not count, but is not known.
            let has_room = levels.count(waiting.start, waiting.end) < LISTED;
            return has_room.then_some(NextLevels::Given(range));
        }
        // What was not given of moves before, in an earlier conversation, is not asked for any more.
        let from = self.given.max(levels.first_from(waiting.end));
        let behind = levels.levels.get(from as usize..)?;
        let part = behind.get(..LEVELS).unwrap_or(behind);
        let held = from.saturating_sub(levels.first_from(waiting.start));
        // A machine without room for any list says so itself.
        let fits = self.room == 0 || held + part.len() as u32 <= self.room;
        let piece = LevelPiece::new(self.base.wrapping_add(from), part);
        fits.then_some(NextLevels::Piece(piece))
    }

    /// The machine has taken levels.
    pub(super) fn confirm(&mut self) {
        self.is_known = true;
    }

    /// Counts what was sent.
    pub(super) fn count(&mut self, piece: &LevelPiece) {
        self.given = piece.next().wrapping_sub(self.base);
    }

    /// Goes back to the level that the machine calls `number`. `first` is the first level of the next move to take.
    pub(super) fn go_back(&mut self, number: u32, first: u32) {
        let index = number.wrapping_sub(self.base);
        if self.is_known && (first..=self.given).contains(&index) {
            self.given = index;
        } else {
            self.is_known = false;
            self.base = number.wrapping_sub(first);
            self.given = first;
        }
    }
}
