//! The planned motion in time, sampled at equal steps.

use super::look::{Look, Planned};
use trirrr_core::number::Number;

/// A place of the motion: where it is between two samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<B> {
    /// Number of the cell.
    pub(super) cell: u32,
    /// Way in p from the start of the cell.
    pub(super) at: B,
    /// x there.
    pub(super) square: B,
    /// Samples of the pose at which it stands before it goes on.
    pub(super) standing: u8,
}

/// Samples of the pose at a stop: the smoothed motion is at rest at the second of three equal poses.
pub(super) const STANDING: u8 = 2;

/// Result of a step along the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Along<B> {
    /// The whole time is passed.
    There,
    /// At the end of a cell with this time left.
    Left(B),
    /// At a stop.
    Stop,
    /// The next cell is not committed yet.
    Ahead,
    /// No motion through the cell was found.
    Stuck,
}

impl<B: Number> Cursor<B> {
    /// At rest in front of cell `cell`.
    pub(super) fn before(cell: u32) -> Self {
        Self {
            cell,
            at: B::ZERO,
            square: B::ZERO,
            standing: 0,
        }
    }

    /// Goes on by `time`, to the end of the cell at most.
    pub(super) fn advance<const CELLS: usize>(
        &mut self,
        look: &Look<B, CELLS>,
        time: B,
    ) -> Along<B> {
        if self.cell == look.committed {
            return Along::Ahead;
        }
        let Some(planned) = look.cells.get(self.cell) else {
            return Along::Ahead;
        };
        let (length, end) = (planned.cell.length, look.end_square(self.cell));
        let rate = (end - planned.square).div(length + length);
        let left = length - self.at;
        let (pace, end_pace) = (self.square.sqrt(), end.sqrt());
        if !(pace + end_pace > B::ZERO) {
            return Along::Stuck;
        }
        let time_left = (left + left).div(pace + end_pace);
        if time < time_left {
            let way = (pace + B::HALF * rate * time) * time;
            let pace = pace + rate * time;
            self.at += way;
            self.square = pace * pace;
            return Along::There;
        }
        let next = self.cell.wrapping_add(1);
        let stops = look.cells.get(next).is_none_or(Planned::stops);
        let square = look.cells.get(next).map_or(B::ZERO, |next| next.square);
        *self = Self {
            cell: next,
            at: B::ZERO,
            square,
            standing: 0,
        };
        match stops {
            true => {
                self.square = B::ZERO;
                self.standing = STANDING;
                Along::Stop
            }
            false => Along::Left(time - time_left),
        }
    }
}
