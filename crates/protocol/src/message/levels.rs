//! Power lists: levels of the tool's power at equal distances along a move.
//!
//! The host sends levels ahead, as a stream of bytes that both sides count. A move names its own among them: so it can
//! neither begin without one nor take another's.

use super::{AnyMove, MoveStep, Transmit};
use crate::wire::checksum;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;

/// Levels in a row of a [`LevelPiece`].
const ROW: usize = 32;

/// Most levels of a [`LevelPiece`].
pub const LEVELS: usize = 4 * ROW;

/// Listed moves that may wait, that under way not counted.
pub const LISTED: usize = 31;

/// Level of the full power of a move.
pub const FULL_LEVEL: u8 = u8::MAX;

/// Parts of a level in which a [`LevelRange`] is given.
pub const LEVEL_PARTS: u32 = 1 << 16;

/// Levels that follow those before. An image without power lists answers `NoLevels` and does not read the content,
/// here and in a [`ListedMove`](super::ListedMove).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LevelPiece {
    /// Number of the first level, modulo 2^32: that behind the last one given, or any other behind those of the last
    /// move that was taken. What lies behind it is sent anew.
    pub first: u32,
    /// Levels of the piece, 1 to [`LEVELS`].
    pub count: u8,
    /// The levels, 0 for no power to [`FULL_LEVEL`] for that of the move's tool setting; zeros behind them.
    pub levels: [[u8; ROW]; LEVELS / ROW],
}

/// Levels of a move. Place `p` of D's way along the chord of the move, 0 at its start and 1 at its end, has the
/// level number `first` + (`offset` + `p` `span`) / [`LEVEL_PARTS`], rounded down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LevelRange {
    /// Number of the first level.
    pub first: u32,
    /// Number of levels, positive.
    pub count: u16,
    /// Place in the first level at which the move starts, in 1/65536 of a level.
    pub offset: u16,
    /// Levels from the start of the move to its end, in 1/65536 of a level, positive. With `offset` no more than
    /// `count`.
    pub span: u32,
}

/// A move with levels. It is offered as a [`MoveBatch`](super::MoveBatch) of one is, behind the levels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct ListedMove<N: Number> {
    /// Number of the move, as in a [`Move`](super::Move).
    pub number: u32,
    /// Checksum of the setpoint from which it starts, as in a [`MoveBatch`](super::MoveBatch).
    pub check: u32,
    /// The move. The tool has its power at the full level, and that part of it at another.
    pub step: MoveStep<N>,
    /// Its levels.
    pub levels: LevelRange,
}

impl LevelPiece {
    /// Piece of as many of `levels` as fit, from number `first` on.
    pub fn new(first: u32, levels: &[u8]) -> Self {
        let mut piece = Self {
            first,
            count: levels.len().min(LEVELS) as u8,
            levels: [[0; ROW]; LEVELS / ROW],
        };
        for (place, level) in piece.levels.as_flattened_mut().iter_mut().zip(levels) {
            *place = *level;
        }
        piece
    }

    /// The levels.
    pub fn levels(&self) -> &[u8] {
        let all = self.levels.as_flattened();
        all.get(..usize::from(self.count)).unwrap_or(all)
    }

    /// Number of the level behind the last.
    pub fn next(&self) -> u32 {
        self.first.wrapping_add(u32::from(self.count))
    }
}

impl LevelRange {
    /// Number of the level behind the last.
    pub fn next(&self) -> u32 {
        self.first.wrapping_add(u32::from(self.count))
    }

    /// Returns true if the move has levels, and all along its way.
    pub fn is_whole(&self) -> bool {
        let end = u64::from(self.offset) + u64::from(self.span);
        self.span > 0 && end <= u64::from(self.count) * u64::from(LEVEL_PARTS)
    }
}

impl<N: Transmit> ListedMove<N> {
    /// The offer of `step` as move `number` behind `start`.
    pub fn new(number: u32, start: &Setpoint<N>, step: &AnyMove<N>, levels: LevelRange) -> Self {
        Self {
            number,
            // A setpoint has a length that is known beforehand.
            check: checksum(start).unwrap_or_default(),
            step: step.step(),
            levels,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_takes_what_fits_and_leaves_zeros_behind() {
        let levels: [u8; 200] = core::array::from_fn(|index| index as u8 + 1);
        let piece = LevelPiece::new(u32::MAX - 9, &levels);
        assert_eq!(piece.levels(), &levels[..LEVELS]);
        assert_eq!(piece.next(), 118);
        let short = LevelPiece::new(7, &levels[..33]);
        assert_eq!((short.levels(), short.next()), (&levels[..33], 40));
        assert_eq!(short.levels.as_flattened()[33..], [0; LEVELS - 33]);
        // A count beyond the piece is cut, not trusted.
        let wrong = LevelPiece {
            count: 255,
            ..short
        };
        assert_eq!(wrong.levels().len(), LEVELS);
    }

    #[test]
    fn a_range_has_to_cover_the_way() {
        let range = |offset, span| LevelRange {
            first: 0,
            count: 2,
            offset,
            span,
        };
        assert!(range(0, 2 * LEVEL_PARTS).is_whole());
        assert!(range(0x8000, LEVEL_PARTS + 0x8000).is_whole());
        assert!(!range(1, 2 * LEVEL_PARTS).is_whole());
        assert!(!range(0, 0).is_whole());
        assert!(!range(u16::MAX, u32::MAX).is_whole());
    }
}
