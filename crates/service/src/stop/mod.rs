//! Bounds of the stops on a job that is known as a whole: the time and the way that a hold takes, wherever it begins, at whatever
//! pace.
//!
//! Let k be the level of the pace, T that of normal speed, x = k^2, and let a way be counted in parts of 1 / (2 T) of a tick, as
//! [`feed`](super::feed) counts it. A tick that lowers k by b covers 2 k - b parts, so x falls by b for each part: exactly, for
//! all are whole numbers. The *fall line* through a place and a level lowers x at the rates of the parts of the path themselves,
//! [`braking`](crate::pace::Pace::braking): that of any pace above T / 2, that of half of normal speed below. A stop brakes at these rates or less:
//!
//! - less in a tick that goes over from one part into another, where the lesser rate holds: x is higher behind it than the fall
//!   line by the difference times the parts of that tick on one side of the boundary, at most b + 2 k;
//! - less in the tick that goes below T / 2, by the difference of both rates times at most T - b parts;
//! - less in its last tick, which has fewer than b levels left: it goes b / 4 parts further.
//!
//! So a stop is never below the fall line through its start, and not above the same line with what it may lose added. Fall lines do
//! not cross. Followed backward, the fall line through any place and level climbs to normal speed, unless it comes to the
//! start of the job, or ends at T / 2 within a part where nothing but a slower pace may brake. So the stops that begin at
//! normal speed anywhere, those from any level at the start of the job, and those from T / 2 within such parts bound all: those from a
//! lower pace are the ends of these. Stops from neighbouring places are followed together, between the fall line of the first and the upper
//! line of the last:
//!
//! - the **way** of each lies between the place of the first and that where the upper line rests;
//! - the **time** over any stretch is at most that on the lower line. A stop that rests within a part takes, from the
//!   start of that part on, the levels that are left over the rate;
//! - all ticks but the last brake at the least rate of the way or more: so the time is at most T over that.
//!
//! A move that ends at rest ends the path there while nothing else is queued; the rest of that tick is lost if more comes in time.

mod fall;
#[cfg(test)]
mod tests;
mod walk;

use crate::feed::FeedScale;
use crate::pace::MovePaces;
use walk::StopWalk;

/// Move of a job, for its stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacedMove {
    /// Ticks that it takes, positive.
    pub ticks: u32,
    /// Rates that are proven for its parts.
    pub paces: MovePaces,
    /// True if it ends at rest.
    pub rests: bool,
}

/// Place on the path of a job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PathPlace {
    /// Index of the move.
    pub index: usize,
    /// Time of the path since the start of that move, in [parts](StopJob::ticks) of a tick.
    pub parts: u64,
}

/// Bounds of the stops that begin in a stretch of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stops {
    /// Most ticks until one stands.
    pub ticks: u64,
    /// Place where the first begins.
    pub from: PathPlace,
    /// Place beyond which none goes; `None` if one may leave the moves that are given.
    pub to: Option<PathPlace>,
    /// Most parts of a tick of path that one takes.
    pub parts: u64,
    /// True where a shorter stretch would not tell much more, of the time and of the way.
    pub is_narrow: [bool; 2],
}

/// Moves in which stops are looked at. The machine stands before the first if they `begin` a job, and behind the last if
/// they `end` it.
#[derive(Clone, Copy, Debug)]
pub struct StopJob<'a> {
    moves: &'a [PacedMove],
    begins: bool,
    ends: bool,
    /// T.
    top: u64,
}

/// A stretch is narrow if it is so small a part of the stops from it.
const NARROW: u64 = 64;

/// Stretch of starts in one part of a move.
#[derive(Clone, Copy, Debug)]
struct Starts {
    index: usize,
    part: u32,
    /// Parts of a tick to the end of that part of the move, of the first start and of the last.
    left: [u64; 2],
    /// Levels of both.
    levels: [u64; 2],
}

impl<'a> StopJob<'a> {
    /// Moves of a job on a ramp of `ramp` ticks.
    pub fn new(moves: &'a [PacedMove], ramp: u16, begins: bool, ends: bool) -> Self {
        let top = u64::from(FeedScale::new(ramp).top());
        Self {
            moves,
            begins,
            ends,
            top,
        }
    }

    /// Parts of a tick: 2 T.
    fn whole(&self) -> u64 {
        2 * self.top
    }

    /// Ticks of so many parts of one.
    pub fn ticks(&self, parts: u64) -> f64 {
        parts as f64 / self.whole() as f64
    }

    /// Calls `visit` with the stops that begin on the first `count` moves, the last of them first, in stretches: while it returns
    /// true, with the halves of a stretch in its place, unless that is narrow.
    pub fn each(&self, count: usize, mut visit: impl FnMut(&Stops) -> bool) {
        let normal = [self.top; 2];
        for (index, each) in self.moves.iter().enumerate().take(count).rev() {
            for part in (0..1 << MovePaces::parts_log2(each.ticks)).rev() {
                let length = self.length(index, part);
                let whole = Starts {
                    index,
                    part,
                    left: [length, 0],
                    levels: normal,
                };
                self.look(&whole, &mut visit);
                let [any, half] = self.rates(index, part);
                if any == 0 && half > 0 {
                    let levels = [self.top / 2; 2];
                    self.look(&Starts { levels, ..whole }, &mut visit);
                }
                if index == 0 && part == 0 && self.begins {
                    let (left, levels) = ([length; 2], [1, self.top]);
                    let starts = Starts {
                        left,
                        levels,
                        ..whole
                    };
                    self.look(&starts, &mut visit);
                }
            }
        }
    }

    /// Looks at `starts`, and closer where `visit` asks for it.
    fn look(&self, starts: &Starts, visit: &mut impl FnMut(&Stops) -> bool) {
        self.look_within(starts, None, visit);
    }

    /// Looks at `starts`, of which `all` are bounds already: what is told does not depend on who has asked before.
    fn look_within(
        &self,
        starts: &Starts,
        all: Option<&Stops>,
        visit: &mut impl FnMut(&Stops) -> bool,
    ) {
        let mut stops = StopWalk::new(self, starts).stops(starts);
        if let Some(all) = all {
            stops.ticks = stops.ticks.min(all.ticks);
            stops.parts = stops.parts.min(all.parts);
            stops.to = stops.to.into_iter().chain(all.to).min();
        }
        if visit(&stops) && stops.is_narrow != [true; 2] {
            let Starts { left, levels, .. } = *starts;
            let middle = |[a, b]: [u64; 2]| u64::midpoint(a, b);
            let (place, level) = (middle(left), middle(levels));
            for half in [0, 1] {
                let mut starts = *starts;
                starts.left[1 - half] = place;
                starts.levels[1 - half] = level;
                self.look_within(&starts, Some(&stops), visit);
            }
        }
    }

    /// Parts of a tick from the start of a move to the end of its part `part`.
    fn end_of(&self, index: usize, part: u32) -> u64 {
        u64::from(MovePaces::end_of(self.moves[index].ticks, part)) * self.whole()
    }

    /// Parts of a tick in part `part` of a move.
    fn length(&self, index: usize, part: u32) -> u64 {
        let end = self.end_of(index, part);
        part.checked_sub(1)
            .map_or(end, |before| end - self.end_of(index, before))
    }

    fn rates(&self, index: usize, part: u32) -> [u64; 2] {
        self.moves[index].paces.of(part).braking().map(u64::from)
    }

    /// x at T / 2.
    fn quarter(&self) -> u64 {
        (self.top / 2).pow(2)
    }
}
