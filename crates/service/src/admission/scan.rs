//! The way through a move, interval by interval.

use super::breach::Breach;
use super::path::Path;
use super::taylor::TaylorModel;
use crate::admission::Enclose;
use crate::pace::MovePaces;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{CurveKind, Segment};

/// Halvings of the whole move at which an interval that was measured roughly is measured again, precisely. From there
/// on rounding is about as much as what is not linear. Shorter intervals are measured precisely at once.
const FINEST_ROUGH: u32 = 6;

/// Intervals of one length that have to pass in a row before a longer one is tried.
const PATIENCE: u32 = 4;

/// Halvings down to the shortest interval. Its middle is still a binary32 number.
const FINEST: u32 = 20;

/// Intervals after which none is halved any more. A move that keeps a limit by less than the
/// bounds tell, all along, would otherwise take 2^16 of them.
const MOST: u32 = 4096;

/// Instants, evenly spread over the rest of the move, that are looked at for a limit that is broken for certain.
const SPREAD: u32 = 64;

/// Place that a check has reached. Intervals are [k, k + 1] / 2^level of the move, in the order of
/// time. The next is as long as its place among the dyadic ones allows, and is halved as needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scan<N> {
    coarsest: u32,
    level: u32,
    index: u32,
    measured: u32,
    /// Intervals in a row that were passed since the last that was not, or since the length was last changed.
    passed: u32,
    /// True if the interval is too rough for its limits.
    precise: bool,
    /// The sign of det A so far.
    side: Option<bool>,
    /// A limit that is not certain to be kept.
    doubt: Option<Doubt<N>>,
}

/// A limit that is broken, or not certain to be kept, in the interval where the scan stands. The move is refused.
/// From there on it is looked at for a limit that is broken for certain, at single instants: bounds are narrowest
/// there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Doubt<N> {
    breach: Breach<N>,
    /// Number of the next instant.
    look: u32,
}

/// Progress or outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scanned<N> {
    /// Not at its end.
    Undecided,
    /// Every limit is kept for certain.
    Passed,
    /// A limit is broken, or not certain to be kept, from the fraction `at` of the move on.
    Failed { breach: Breach<N>, at: N },
}

impl<N: Arithmetic> Scan<N> {
    pub(super) fn new<T: Enclose<Bound = N>>() -> Self {
        Self::at_level(T::COARSEST)
    }

    /// With intervals of at most 1 / 2^`level`.
    pub(super) fn at_level(level: u32) -> Self {
        Self {
            coarsest: level,
            level,
            index: 0,
            measured: 0,
            passed: 0,
            precise: false,
            side: None,
            doubt: None,
        }
    }

    /// The start of the interval, as a fraction of the move.
    fn at(&self) -> N {
        N::ratio(self.index, 1 << self.level)
    }

    /// The interval.
    pub(super) fn interval<T: Enclose<Bound = N>>(&self) -> TaylorModel<T> {
        let halves = 2 << self.level;
        let span = TaylorModel::span(N::ratio(2 * self.index + 1, halves), N::ratio(1, halves));
        if self.precise || self.level > FINEST_ROUGH {
            span
        } else {
            span.made_rough()
        }
    }

    /// Steps to the next interval; whether there is none.
    pub(super) fn advance(&mut self) -> bool {
        self.precise = false;
        self.index += 1;
        self.passed += 1;
        // The one twice as long has hardly failed by chance: only after some more it is tried again.
        while self.level > self.coarsest && self.index.is_multiple_of(2) && self.passed >= PATIENCE
        {
            self.index /= 2;
            self.level -= 1;
            self.passed = 0;
        }
        self.index >> self.level == 1
    }

    /// Measures one interval of `segment`, or one instant once the move cannot pass any more. Lowers the `paces` to what the
    /// limits leave room for; without them, to what is asked of every move.
    pub(super) fn step<T: Enclose<Bound = N>, M: Model<N = T>, K: CurveKind>(
        &mut self,
        path: &Path<M>,
        segment: &Segment<TaylorModel<T>, K>,
        paces: Option<&mut MovePaces>,
    ) -> Scanned<N> {
        if let Some(doubt) = self.doubt {
            return self.look(doubt, path, segment);
        }
        self.measured += 1;
        let interval = self.interval();
        let (ticks, level, index) = (segment.ticks(), self.level, self.index);
        let mut pace = match &paces {
            Some(paces) => paces.over(ticks, level, index),
            None => path.least,
        };
        let before = pace;
        match path.check(segment, interval, &mut self.side, &mut pace) {
            // Long intervals have wide bounds, and lower the rates all along.
            Ok(()) if pace != before && self.level < MovePaces::finest(ticks) => self.halve(1),
            Ok(()) => {
                if let Some(paces) = paces {
                    paces.lower(ticks, level, index, pace);
                }
                if self.advance() {
                    return Scanned::Passed;
                }
            }
            Err(breach) if breach.certain || self.level == FINEST || self.measured >= MOST => {
                self.doubt = Some(Doubt { breach, look: 0 });
            }
            Err(_) if self.level == FINEST_ROUGH && !self.precise && T::IS_ROUGH_FIRST => {
                self.precise = true;
            }
            Err(breach) => {
                self.halve(breach.halvings.min(FINEST - self.level));
            }
        }
        Scanned::Undecided
    }

    /// So many times.
    fn halve(&mut self, times: u32) {
        self.level += times;
        self.index <<= times;
        self.passed = 0;
    }

    /// Looks at one instant for a limit that is broken for certain.
    fn look<T: Enclose<Bound = N>, M: Model<N = T>, K: CurveKind>(
        &mut self,
        doubt: Doubt<N>,
        path: &Path<M>,
        segment: &Segment<TaylorModel<T>, K>,
    ) -> Scanned<N> {
        let Doubt { breach, look } = doubt;
        let Some(at) = self.instant(look) else {
            return Scanned::Failed {
                breach,
                at: self.at(),
            };
        };
        // Beyond the end by its rounding.
        let at = if at > N::ONE { N::ONE } else { at };
        let mut least = path.least;
        match path.check(segment, TaylorModel::point(at), &mut self.side, &mut least) {
            Err(breach) if breach.certain => {
                // det A has changed its sign before this instant: where the doubt is.
                let crossed = breach.value == N::ZERO && breach.error == N::ZERO;
                let at = if crossed { self.at() } else { at };
                Scanned::Failed { breach, at }
            }
            _ => {
                self.doubt = Some(Doubt {
                    breach,
                    look: look + 1,
                });
                Scanned::Undecided
            }
        }
    }

    /// Returns the `look`-th instant: first further and further from the start of the interval, which is
    /// mostly where a limit is just reached, then all over the rest of the move. None after the last.
    fn instant(&self, look: u32) -> Option<N> {
        let start = self.at();
        let rest = N::ONE - start;
        let part = match look {
            0 => N::ZERO,
            1..=FINEST => N::ratio(1, 1 << (FINEST + 1 - look)),
            _ => {
                let spread = look - FINEST;
                if spread > SPREAD {
                    return None;
                }
                N::ratio(2 * spread - 1, 2 * SPREAD)
            }
        };
        Some(start + rest * part)
    }
}
