//! The way through a move, interval by interval.

use super::Breach;
use super::path::Path;
use super::taylor::{Float, TaylorModel};
use crate::admission::Enclose;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Segment;

/// Halvings of the whole move at the start: intervals much longer would seldom be certain. At
/// least one, because the setpoint is computed from the nearer end.
const COARSEST: u32 = 4;

/// Halvings down to the shortest interval. Its middle is still a binary32 number.
const FINEST: u32 = 20;

/// Intervals after which none is halved any more. A move that keeps a limit by less than the
/// bounds tell, all along, would otherwise take 2^16 of them.
const MOST: u32 = 4096;

/// Place that a check has reached. Intervals are [k, k + 1] / 2^level of the move, in the order of
/// time. The next is as long as its place among the dyadic ones allows, and is halved as needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scan {
    coarsest: u32,
    level: u32,
    index: u32,
    measured: u32,
}

/// Progress or outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scanned<N> {
    /// Not at its end.
    Undecided,
    /// Every limit is kept for certain.
    Passed,
    /// The interval where it stands breaks a limit.
    Failed(Breach<N>),
}

impl Scan {
    pub(super) fn new() -> Self {
        Self::at_level(COARSEST)
    }

    /// With intervals of at most 1 / 2^`level`.
    pub(super) fn at_level(level: u32) -> Self {
        Self {
            coarsest: level,
            level,
            index: 0,
            measured: 0,
        }
    }

    /// The start of the interval, as a fraction of the move.
    pub(super) fn at<N: Arithmetic>(&self) -> N {
        N::ratio(self.index, 1 << self.level)
    }

    /// The interval.
    pub(super) fn interval<N: Enclose>(&self) -> TaylorModel<N> {
        let halves = 2 << self.level;
        TaylorModel::span(
            <Float<N>>::ratio(2 * self.index + 1, halves),
            <Float<N>>::ratio(1, halves),
        )
    }

    /// Steps to the next interval; whether there is none.
    pub(super) fn advance(&mut self) -> bool {
        self.index += 1;
        while self.level > self.coarsest && self.index.is_multiple_of(2) {
            self.index /= 2;
            self.level -= 1;
        }
        self.index == 1 << self.level
    }

    /// Measures one interval of `segment`.
    pub(super) fn step<N: Enclose, M: Model<N = N>>(
        &mut self,
        path: &Path<M>,
        segment: &Segment<TaylorModel<N>>,
    ) -> Scanned<Float<N>> {
        self.measured += 1;
        match path.check(segment, self.interval()) {
            Ok(()) => {
                if self.advance() {
                    Scanned::Passed
                } else {
                    Scanned::Undecided
                }
            }
            Err(breach) => {
                if self.level == FINEST || self.measured >= MOST {
                    return Scanned::Failed(breach);
                }
                self.level += 1;
                self.index *= 2;
                Scanned::Undecided
            }
        }
    }
}
