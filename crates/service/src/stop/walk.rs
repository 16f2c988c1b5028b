//! Stops from a stretch of starts, followed from part to part.

use super::fall::{Braked, FRACTION, Fall, MOST};
use super::{NARROW, PathPlace, Starts, StopJob, Stops};
use crate::pace::MovePaces;

/// x that the last tick before rest may lose, and what it may have left beyond a boundary.
const LAST: i64 = (MOST * MOST / 4) as i64;
const BEYOND: u64 = 3 * MOST * MOST;

/// Walks that a look may split off. Without more it only tells less.
const SPLITS: u32 = 256;

/// Bounds of the stops that have come to rest.
#[derive(Clone, Copy, Debug, Default)]
struct FoundStop {
    ticks: u64,
    /// Place beyond which none goes, and parts of a tick from the first start to there.
    to: PathPlace,
    passed: u64,
    /// True if one may leave the moves.
    is_open: bool,
    /// Time of the first.
    first: Option<u64>,
    /// Walks that were split off.
    splits: u32,
}

/// Stops from a stretch of starts, followed together.
#[derive(Clone)]
pub(super) struct StopWalk<'a> {
    job: &'a StopJob<'a>,
    index: usize,
    part: u32,
    /// Parts of a tick to the end of that part of the move, for the lower line and for the upper one,
    left: [u64; 2],
    /// and x of both.
    x: [u64; 2],
    /// True if all are at T / 2 or below.
    is_slow: bool,
    /// Parts of a tick from the first start on.
    passed: u64,
    /// Time of the lower line, or of those that are slower.
    time: u64,
    /// From the start on, and from where the first has come to rest.
    braked: [Braked; 2],
    found: FoundStop,
}

impl<'a> StopWalk<'a> {
    pub(super) fn new(job: &'a StopJob<'a>, starts: &Starts) -> Self {
        let [_, level] = starts.levels;
        Self {
            job,
            index: starts.index,
            part: starts.part,
            left: starts.left,
            x: starts.levels.map(|level| level.pow(2)),
            is_slow: 2 * level <= job.top,
            passed: 0,
            time: 0,
            braked: [Braked::new(0, level); 2],
            found: FoundStop::default(),
        }
    }

    /// Bounds of the stops from `starts`.
    pub(super) fn stops(mut self, starts: &Starts) -> Stops {
        self.walk();
        let found = self.found;
        let [width, levels] = [starts.left, starts.levels].map(|[a, b]| a.abs_diff(b));
        let is_least = width < self.job.whole() / NARROW && levels < self.job.top / NARROW;
        let is_short = width <= found.passed / NARROW && levels <= starts.levels[1] / NARROW;
        let first = found.first.unwrap_or(self.time) >> FRACTION;
        Stops {
            ticks: found.ticks,
            from: PathPlace {
                index: starts.index,
                parts: self.job.end_of(starts.index, starts.part) - starts.left[0],
            },
            to: (!found.is_open).then_some(found.to),
            parts: found.passed.min(self.most_parts()),
            is_narrow: [
                is_least || found.ticks <= first + first / NARROW + 3,
                is_least || is_short,
            ],
        }
    }

    /// Walks until all are at rest.
    fn walk(&mut self) {
        loop {
            let fall = self.gather();
            let mut lines = self.behind(fall);
            // Where some rest and others hardly slow down, these are followed on their own.
            while self.found.splits < SPLITS
                && lines[0] < 0
                && lines[1] > (fall.quarter / NARROW) as i64
                && self.left[0] == self.left[1]
                && self.x[0] < self.x[1]
            {
                let middle = u64::midpoint(self.x[0], self.x[1]);
                let mut slower = self.clone();
                slower.x[1] = middle;
                self.follow(slower);
                self.x[0] = middle + 1;
                lines = self.behind(fall);
            }
            if lines[0] < 0 {
                let x = fall.needed(self.left[0]).min(self.x[1]);
                self.found
                    .first
                    .get_or_insert(self.time + fall.rest(self.x[0]));
                self.rest(self.time + fall.rest(x) + (3 << FRACTION));
            }
            if lines[1] < -LAST {
                let left = self.left[1].saturating_sub(self.to_rest(fall));
                return self.end_at(self.left[0] - left, left);
            }
            self.time += match lines[0] < 0 {
                true => fall.slowest(self.left[0]) + (2 << FRACTION),
                false => fall.time(self.x[0], self.left[0]),
            };
            let Some(next) = self.next() else {
                self.rest_here();
                self.found.is_open |= !self.job.ends;
                return self.end_at(self.left[0], 0);
            };
            self.passed += self.left[0];
            self.cross(fall, lines, next);
        }
    }

    /// Walks `others` to rest, which are among these.
    fn follow(&mut self, mut others: Self) {
        others.found.splits += 1;
        others.walk();
        self.found = others.found;
    }

    /// The last of them rests `gone` parts of a tick ahead of the first, and `left` before the end of the part.
    fn end_at(&mut self, gone: u64, left: u64) {
        self.found.to = self.found.to.max(self.place(left));
        self.found.passed = self.found.passed.max(self.passed + gone);
    }

    /// Adds the parts ahead that have the same rates, as far as the upper line goes: going over into them loses nothing.
    fn gather(&mut self) -> Fall {
        let rates = self.rates(self.index, self.part);
        let quarter = self.job.quarter();
        let fall = Fall { rates, quarter };
        for braked in &mut self.braked {
            braked.add(rates);
        }
        while fall.behind(self.x[1], self.left[1], true) >= -LAST
            && let Some((index, part)) = self.next()
            && !self.rests_before(index)
            && self.rates(index, part) == rates
        {
            (self.index, self.part) = (index, part);
            let length = self.job.length(index, part);
            self.left = self.left.map(|left| left + length);
        }
        fall
    }

    /// Rates of a part, above T / 2 and below.
    fn rates(&self, index: usize, part: u32) -> [u64; 2] {
        let [any, half] = self.job.rates(index, part);
        match self.is_slow {
            true => [half, half],
            false => [any, half],
        }
    }

    /// Both lines at the end of the parts.
    fn behind(&self, fall: Fall) -> [i64; 2] {
        let [lower, mut upper] = [0, 1].map(|i| fall.behind(self.x[i], self.left[i], i == 1));
        if self.x[1] > fall.quarter && upper < fall.quarter as i64 {
            upper += self.lost_at_half(fall) as i64;
        }
        [lower, upper]
    }

    /// x that the tick which goes below T / 2 may lose.
    fn lost_at_half(&self, fall: Fall) -> u64 {
        let [any, half] = fall.rates;
        (half - any) * (self.job.top - any)
    }

    /// Parts of a tick in which the upper line comes to rest.
    fn to_rest(&self, fall: Fall) -> u64 {
        let [_, half] = fall.rates;
        let above = fall.to_half(self.x[1], true).unwrap_or(0);
        let lost = match above {
            0 => 0,
            _ => self.lost_at_half(fall),
        };
        let below = self.x[1].min(fall.quarter) + lost;
        above + below.div_ceil(half.max(1)) + MOST / 4
    }

    /// The part ahead.
    fn next(&self) -> Option<(usize, u32)> {
        let each = &self.job.moves[self.index];
        if self.part + 1 < 1 << MovePaces::parts_log2(each.ticks) {
            return Some((self.index, self.part + 1));
        }
        (self.index + 1 < self.job.moves.len()).then_some((self.index + 1, 0))
    }

    /// Returns true if the path rests before it goes over into the move `index`.
    fn rests_before(&self, index: usize) -> bool {
        index != self.index && self.job.moves[self.index].rests
    }

    /// Goes over into the `next` part, with both `lines` at its start.
    fn cross(&mut self, fall: Fall, lines: [i64; 2], (index, part): (usize, u32)) {
        let ([any, half], [next_any, next_half]) = (fall.rates, self.rates(index, part));
        let greatest = self.braked[0].level.pow(2);
        let [mut lower, upper] = lines.map(|x| (x.max(0) as u64).min(greatest));
        if self.rests_before(index) {
            self.rest_here();
            // A tick that ends there goes no further.
            self.time += 1 << FRACTION;
            lower = lower.isqrt().saturating_sub(half + 1).pow(2);
        }
        lower = lower.max(1);
        self.left = [self.job.length(index, part); 2];
        (self.index, self.part) = (index, part);
        let middle = self.job.top / 2;
        // By a tick at the lesser of two rates, from a level that leads to x.
        let lifted = |x: u64, rate: u64, next: u64| {
            let lost = rate.abs_diff(next);
            let lifted = x + lost * (rate + 2 * (x.isqrt() + 1));
            match lines[0] < 0 && lost > 0 {
                true => lifted.max(BEYOND),
                false => lifted,
            }
        };
        let above = lifted(upper, any, next_any);
        if self.is_slow || lower.isqrt() >= middle + MOST || [any, half] == [next_any, next_half] {
            self.go_on([lower, above], lines[0] < 0);
            return;
        }
        // Those that come out of this tick at T / 2 or below, and may have gone into it above.
        let mut below = lifted(upper.min(fall.quarter), half, next_half);
        let level = upper.isqrt() + 1;
        if level + MOST > middle {
            let lost = half.max(next_half) - any.min(next_any);
            let lifted = upper + lost * (4 * half + 2 * level);
            below = below.max(lifted.min(fall.quarter + 2 * next_half * (middle + MOST)));
        }
        if self.found.splits >= SPLITS {
            self.go_on([lower, above.max(below)], lines[0] < 0);
            return;
        }
        let mut slow = self.clone();
        slow.is_slow = true;
        slow.go_on([lower.min(fall.quarter), below], lines[0] < 0);
        if above <= fall.quarter {
            *self = slow;
            return;
        }
        slow.braked[1] = Braked::new(self.time + (1 << FRACTION), middle);
        self.follow(slow);
        self.go_on([lower.max(fall.quarter + 1), above], lines[0] < 0);
    }

    /// Goes on between two x; some have come to `rest` before.
    fn go_on(&mut self, [lower, upper]: [u64; 2], rest: bool) {
        let level = upper.isqrt() + 1;
        if rest && level < self.braked[1].level / 2 {
            self.braked[1] = Braked::new(self.time + (1 << FRACTION), level);
        }
        self.x = [lower, upper.max(lower)];
    }

    /// The path ends here for some: a tick later the machine says so.
    fn rest_here(&mut self) {
        self.found.first.get_or_insert(self.time);
        self.rest(self.time + (2 << FRACTION));
    }

    /// Some have come to rest after this time.
    fn rest(&mut self, time: u64) {
        let middle = self.job.top / 2;
        let most = |braked: &Braked| {
            let ticks = braked.most(braked.level, middle, 0);
            (braked.since >> FRACTION).saturating_add(ticks)
        };
        let most = most(&self.braked[0]).min(most(&self.braked[1]));
        self.found.ticks = self.found.ticks.max((time >> FRACTION).min(most));
    }

    /// Most parts of a tick that a stop takes at the least rates. The tick that goes below T / 2 may lose, and so may the last, but
    /// for a ramp with all its room: T is a multiple of its rate.
    fn most_parts(&self) -> u64 {
        let [braked, _] = self.braked;
        let most = braked.most(braked.level.pow(2), self.job.quarter(), self.job.top);
        match braked.least == [MOST; 2] {
            true => most,
            false => most.saturating_add(MOST),
        }
    }

    /// Place so many parts of a tick before the end of the part.
    fn place(&self, mut before: u64) -> PathPlace {
        let mut index = self.index;
        let mut end = self.job.end_of(index, self.part);
        while before > end && index > 0 {
            before -= end;
            index -= 1;
            end = u64::from(self.job.moves[index].ticks) * self.job.whole();
        }
        PathPlace {
            index,
            parts: end.saturating_sub(before),
        }
    }
}
