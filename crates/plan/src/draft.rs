//! Moves of a run: quintics that follow its [`Law`], as long as they can be.

use crate::cell::{Limited, Planner};
use crate::deviation::Deviation;
use crate::fit::{Fit, LONGEST_S, ends, rest, size};
use crate::law::Law;
use crate::path::{PathPiece, PathPlace};
use crate::planned::{PlannedMove, Sampling};
use crate::run::Run;
use nalgebra::Vector3;
use trirrr_core::model::Model;
use trirrr_core::setpoint::{Segment, Setpoint};

/// Factor from a move that is too long to the next one that is tried.
const SHORTER: f64 = 0.75;
/// Instants at which the path is compared.
const INSTANTS: u32 = 16;
/// Part of the largest acceleration, and of the feed, that the rounding of poses may make.
const ROUNDING: f64 = 0.01;
/// The same of the feed where the motion has it: this part of it or more.
const ROUNDING_AT_FEED: f64 = 5e-4;
const REACHED: f64 = 0.98;
/// Part of the tolerances that moves may use at the instants that are looked at.
const PART_OF_TOLERANCE: f64 = 0.95;
/// Part of the feed by which a move may be faster than the law.
const FASTER: f64 = 1e-4;
/// Part of the feed that moves may use at the instants that are looked at.
const FEED: f64 = 0.9997;
/// Part of the limits that a plan for moves uses at most; the rest is for what moves differ from it.
const SHARE: f64 = 0.997;
/// The same where the feed is hardly more than rounding.
const SHARE_MIN: f64 = 0.25;
/// Part of the largest jerk by which a move may differ from the law.
const JERK: f64 = 0.03;
/// Part of the largest jerk that the rounding of poses may make.
const ROUNDED_JERK: f64 = 0.03;

/// Time of a move across a jump of the acceleration where pieces meet, s.
const BLEND_S: f64 = 0.006;
/// Difference from the law that a short move may have, in parts of that of others.
const SHORT_DIFFERENCE: f64 = 4.0;
/// Part of the largest acceleration of a run to which those of a move are compared at least.
const LEAST_OF_LARGEST: f64 = 0.05;
/// Part of the largest acceleration below which such a jump is none.
const SMALLEST_JUMP: f64 = 0.005;

/// Moves of the least length that the moves before a short one may be longer in sum, at most: after a long stretch without a short move,
/// so many may follow each other.
const SPARE: f64 = 32.0;

/// Instants of a move at which the limits of the motors are looked at, and the part of them that it may use there: what is left is for the
/// motion between, and for the rounding of another number type in which the moves may be played.
const LOOKED: u32 = 16;
const OF_LIMITS: f64 = 0.998;

/// A place of a run near which moves are shorter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine {
    /// Distance along the run.
    distance: f64,
    /// Ticks of a move there.
    ticks: f64,
}

/// Part of a limit, and the ticks between which it is more than 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beyond {
    pub(crate) most: f64,
    /// The limit.
    pub(crate) what: Limited,
    pub(crate) knots: [f64; 2],
}

/// Moves of a run before they are judged.
pub(crate) struct Draft<'a> {
    pub(crate) law: Law<'a>,
    pub(crate) moves: Vec<PlannedMove>,
    /// Ticks at which the moves begin, and the last one ends.
    knots: Vec<f64>,
    /// Ticks of the shortest move.
    shortest: f64,
    /// Ticks that the moves so far are longer in sum than the least length that most of them have to have.
    pub(crate) spare: f64,
    /// Ticks of the shortest move that could take the place of each move.
    least: Vec<f64>,
    /// Ticks between changes of the tool's setting at least.
    least_change: f64,
    fit: Fit<f64>,
    /// Largest jerk of the law, where it is limited.
    jerk: Option<f64>,
    sampling: Sampling,
}

impl<'a> Draft<'a> {
    /// Moves of `run`, none shorter than `least_s`, from a point of the platform `lever_m` from D.
    pub(crate) fn new(
        run: &'a Run,
        pieces: &'a [PathPiece],
        [lever_m, least_s]: [f64; 2],
        sampling: Sampling,
        fine: &[Fine],
        spare: f64,
    ) -> Self {
        let shortest = sampling.shortest(least_s);
        let law = Law::new(run, pieces, shortest * sampling.period_s, sampling.period_s);
        let mut draft = Self {
            law,
            moves: Vec::new(),
            knots: vec![0.0],
            shortest,
            spare,
            least: Vec::new(),
            least_change: change_ticks(run, pieces, &sampling)
                .max((least_s / sampling.period_s).ceil()),
            fit: Fit {
                period: sampling.period_s,
                tolerances: [sampling.tolerance_m, sampling.tolerance_rad],
                lever: lever_m,
                faster: FASTER,
                noise: 0.0,
                largest: largest(run, pieces, lever_m),
            },
            jerk: None,
            sampling,
        };
        draft.jerk = run.jerk.is_some().then(|| draft.law.largest_jerk(lever_m));
        let fine: Vec<(f64, f64)> = fine
            .iter()
            .map(|each| (draft.law.tick_at(each.distance), each.ticks))
            .collect();
        let end = f64::from(draft.law.ticks);
        let mut changes = draft.changes(end);
        draft.add_feeds(&mut changes, end);
        let blends = draft.blends(&fine, &changes, end);
        let mut at = 0.0;
        let mut state = rest(draft.law.at(0.0).pose);
        while at < end {
            if let Some([_, to]) = blends.iter().find(|blend| blend[0] == at) {
                let there = draft.law.at(*to);
                draft.push([at, *to], [state, there]);
                (at, state) = (*to, there);
                continue;
            }
            let ends = changes.iter().chain(blends.iter().map(|blend| &blend[0]));
            let next = ends.copied().filter(|&change| change > at).reduce(f64::min);
            let (to, state_there) = draft.longest(at, state, [next.unwrap_or(end), end], &fine);
            draft.push([at, to], [state, state_there]);
            (at, state) = (to, state_there);
        }
        draft
    }

    /// Ticks at which moves end because the tool's setting changes, so far apart that there is room for a move between them. Where
    /// settings change faster than other moves follow each other, as along a row of an image, moves are as short as they.
    fn changes(&self, end: f64) -> Vec<f64> {
        let mut last = 0.0;
        let mut changes = self.law.changes();
        changes.retain_mut(|change| {
            *change = change.max(last + self.least_change);
            let fits = *change <= end - self.least_change;
            if fits {
                last = *change;
            }
            fits
        });
        changes
    }

    /// Adds the ticks at which the feed changes: a move along the slower piece lies on it, whose ends are rounded.
    fn add_feeds(&self, changes: &mut Vec<f64>, end: f64) {
        for tick in self.law.feed_changes() {
            let is_near = |other: &f64| (other - tick).abs() < self.shortest;
            if !changes.iter().chain(&[0.0, end]).any(is_near) {
                changes.push(tick);
            }
        }
        changes.sort_by(f64::total_cmp);
    }

    /// Ticks of the shortest move from `tick`: the rounding of its ends is little beside the feed.
    fn shortest_at(&self, tick: f64) -> f64 {
        let rounded = self.sampling.rounded_speed(1.0);
        let least_s = |feed: f64| {
            let velocity = self.law.at(tick).velocity;
            let is_reached = libm::hypot(velocity.x, velocity.y) > REACHED * feed;
            // At the feed itself, no more of it is given up for short moves than long ones take.
            let finest = rounded / (ROUNDING_AT_FEED * feed);
            let at_feed = finest.min(f64::from(self.sampling.ticks_min) * self.sampling.period_s);
            let least = rounded / (ROUNDING * feed);
            if is_reached {
                least.max(at_feed)
            } else {
                least
            }
        };
        let least_s = self.law.feed(tick + 1.0).map_or(0.0, least_s);
        let ticks_min = f64::from(self.sampling.ticks_min);
        let least = match self.spare > ticks_min {
            true => self.shortest,
            // A queue of moves has to last.
            false => self.shortest.max(ticks_min),
        };
        (least_s.min(LONGEST_S) / self.sampling.period_s)
            .ceil()
            .max(least)
    }

    /// Moves across jumps of the acceleration where pieces meet, as near to their middles as whole ticks allow: a quintic goes evenly from
    /// the one to the other.
    fn blends(&self, fine: &[(f64, f64)], changes: &[f64], end: f64) -> Vec<[f64; 2]> {
        let mut blends: Vec<[f64; 2]> = Vec::new();
        let longest = (BLEND_S / self.sampling.period_s).round();
        for jump in self
            .law
            .jumps(SMALLEST_JUMP * self.fit.largest, self.fit.lever)
        {
            let at = |ticks: f64| {
                let from = (jump - 0.5 * ticks).round();
                [from, from + ticks]
            };
            // Of the nearest two lengths that one which has its middle nearer.
            let nearest = |ticks: f64| {
                let off = |[from, to]: [f64; 2]| (0.5 * (from + to) - jump).abs();
                let longer = if ticks < longest { ticks } else { ticks + 1.0 };
                let both = [at(ticks), at(longer)];
                if off(both[1]) < off(both[0]) {
                    both[1]
                } else {
                    both[0]
                }
            };
            let near = |&&(place, _): &&(f64, f64)| (place - jump).abs() <= longest;
            let most = fine
                .iter()
                .filter(near)
                .map(|fine| fine.1)
                .fold(longest, f64::min);
            let [mut from, to] = nearest(most.max(self.shortest));
            let last = blends.last().map_or(0.0, |last| last[1]);
            let before = changes.iter().copied().filter(|change| *change <= from);
            let last = before.fold(last, f64::max);
            let behind = changes.iter().copied().filter(|change| *change >= to);
            let behind = behind.fold(end, f64::min);
            let least = self.shortest.max(f64::from(self.sampling.ticks_min));
            // No short move between two.
            if from - last < least {
                from = last;
            }
            let is_alone = behind == to || behind - to >= least;
            let is_asked = most == longest || to - from <= most.max(least);
            let is_cut = changes.iter().any(|change| from < *change && *change < to);
            if to - from >= least && to < end && is_alone && is_asked && !is_cut {
                blends.push([from, to]);
            }
        }
        blends
    }

    /// The end of the longest move from `from` that follows the law and goes no further than `until`, of a run until `end`.
    fn longest(
        &self,
        from: f64,
        state: Setpoint<f64>,
        [until, end]: [f64; 2],
        fine: &[(f64, f64)],
    ) -> (f64, Setpoint<f64>) {
        let (left, shortest) = (until - from, self.shortest_at(from));
        let longest = (LONGEST_S / self.sampling.period_s).floor();
        let mut ticks = longest.max(shortest).min(left);
        loop {
            // What is left behind it is a move, too.
            if left - ticks < shortest && left > ticks {
                ticks = match left >= 2.0 * shortest {
                    true => (left - shortest).min(ticks),
                    false => left,
                };
            }
            let to = from + ticks;
            let there = match to >= end {
                true => rest(self.law.at(to).pose),
                false => self.law.at(to),
            };
            let shorter = (SHORTER * ticks).floor().max(shortest);
            let is_fine = |&(place, most): &(f64, f64)| ticks <= most || place < from || place > to;
            let span = [from as u32, to as u32];
            let middle = self.law.at(0.5 * (from + to));
            let sizes =
                [&state, &middle, &there].map(|state| size(state.acceleration, self.fit.lever));
            let here = sizes
                .into_iter()
                .fold(LEAST_OF_LARGEST * self.fit.largest, f64::max);
            let fit = Fit {
                largest: here,
                ..self.fit
            };
            let follows = fine.iter().all(is_fine)
                && fit.difference(&self.law, span, &[state, there]) <= self.allowed(ticks)
                && self.follows_jerk([from, to], &[state, there]);
            if follows || shorter >= ticks || left < 2.0 * shortest {
                return (to, there);
            }
            ticks = shorter;
        }
    }

    /// Difference from the law, in parts of that of a long move, that a move of so many ticks may have: short ones are dear to prove.
    fn allowed(&self, ticks: f64) -> f64 {
        match ticks > f64::from(self.sampling.ticks_min) {
            true => 1.0,
            false => SHORT_DIFFERENCE,
        }
    }

    /// Returns true if the move between `states` has the jerk of the law, where that is limited.
    fn follows_jerk(&self, [from, to]: [f64; 2], states: &[Setpoint<f64>; 2]) -> bool {
        let Some(largest) = self.jerk else {
            return true;
        };
        let period_s = self.sampling.period_s;
        let segment = Segment::new(&ends(states), (to - from) as u32, period_s);
        (0..=INSTANTS).all(|instant| {
            let part = f64::from(instant) / f64::from(INSTANTS);
            let tick = (from + part * (to - from)).clamp(from + 0.5, to - 0.5);
            let bent = segment.jerk_at_fraction(part, period_s) - self.law.jerk_at(tick);
            size(bent, self.fit.lever) <= JERK * largest
        })
    }

    fn push(&mut self, [from, to]: [f64; 2], states: [Setpoint<f64>; 2]) {
        self.knots.push(to);
        self.least.push(self.shortest_at(from));
        let ticks_min = f64::from(self.sampling.ticks_min);
        self.spare = (self.spare + (to - from) - ticks_min).min(SPARE * ticks_min);
        self.moves.push(PlannedMove {
            ends: ends(&states),
            ticks: (to - from) as u32,
            place: self.law.place(from),
            piece: self.law.place(0.5 * (from + to)).piece,
        });
    }

    /// Returns the largest deviation of move `index` from the path, in parts of the tolerances.
    pub(crate) fn deviation(&self, index: usize) -> f64 {
        let sampling = &self.sampling;
        // Both ends of a move are rounded.
        let allowed = |tolerance: f64, resolution: f64| {
            (PART_OF_TOLERANCE * tolerance - 2.0 * resolution).max(0.5 * tolerance)
        };
        let metres = allowed(sampling.tolerance_m, sampling.resolution_m);
        let radians = allowed(sampling.tolerance_rad, sampling.resolution_rad);
        let path = Deviation {
            law: &self.law,
            tolerances: Vector3::new(metres, metres, radians),
            period_s: sampling.period_s,
        };
        let segment = self.moves[index].segment(sampling.period_s);
        path.of(&segment, [self.knots[index], self.knots[index + 1]])
    }

    /// Largest part of the feed, squared, and of a limit of the motors that move `index` takes at a few instants.
    pub(crate) fn parts_of_limits<M: Model<N = f64>>(
        &self,
        planner: &Planner<M>,
        index: usize,
    ) -> [Beyond; 2] {
        let sampling = &self.sampling;
        let each = &self.moves[index];
        let segment = each.segment(sampling.period_s);
        let (from, ticks) = (self.knots[index], f64::from(each.ticks));
        let rounded = sampling.rounded_speed(ticks * sampling.period_s);
        let speed = |part: f64| {
            let feed = self.law.feed(from + part * ticks)?;
            let velocity = segment.at_fraction(part).velocity;
            let speed = (libm::hypot(velocity.x, velocity.y) + rounded) / (FEED * feed);
            Some((speed * speed, Limited::Feed))
        };
        let motors = |part: f64| {
            let (part, what) = planner.part_of_limits(&segment.at_fraction(part))?;
            Some((part / OF_LIMITS, what))
        };
        let beyond = |values: &dyn Fn(f64) -> Option<(f64, Limited)>, count: u32| {
            let mut beyond = Beyond {
                most: 0.0,
                what: Limited::Feed,
                knots: [from + ticks, from],
            };
            for instant in 0..=count {
                let part = f64::from(instant) / f64::from(count);
                let Some((value, what)) = values(part) else {
                    continue;
                };
                if value > beyond.most {
                    (beyond.most, beyond.what) = (value, what);
                }
                if value > 1.0 {
                    let [first, last] = [-1.0, 1.0]
                        .map(|by| from + ticks * (part + by / f64::from(count)).clamp(0.0, 1.0));
                    beyond.knots = [beyond.knots[0].min(first), beyond.knots[1].max(last)];
                }
            }
            beyond
        };
        [beyond(&speed, INSTANTS), beyond(&motors, LOOKED)]
    }

    /// Moves half as long at move `index`; none if it cannot be cut, or was to be shorter before and is not.
    pub(crate) fn closer(&self, index: usize, fine: &[Fine]) -> Option<Fine> {
        let ticks = f64::from(self.moves[index].ticks);
        let [from, to] = [self.knots[index], self.knots[index + 1]].map(|at| self.law.distance(at));
        let is_here = |each: &&Fine| (from..=to).contains(&each.distance);
        let is_in_vain = fine.iter().filter(is_here).any(|each| each.ticks < ticks);
        (ticks >= 2.0 * self.least[index] && !is_in_vain).then(|| Fine {
            distance: self
                .law
                .distance(0.5 * (self.knots[index] + self.knots[index + 1])),
            ticks: (0.5 * ticks).floor().max(self.shortest),
        })
    }

    /// Places of the plan between which lies all that move `index` is made of.
    pub(crate) fn span(&self, index: usize) -> [PathPlace; 2] {
        self.span_between([self.knots[index], self.knots[index + 1]])
    }

    /// The same between two ticks.
    pub(crate) fn span_between(&self, knots: [f64; 2]) -> [PathPlace; 2] {
        self.law.span(knots)
    }
}

/// Ticks that moves are longer in sum than the least length, at the start of a path.
pub(crate) fn spare_at_start(sampling: &Sampling) -> f64 {
    SPARE * f64::from(sampling.ticks_min)
}

/// Shortest move of `run`, s, for which the rounding of its ends is little beside the accelerations, the feeds and the jerk
/// of the run, as long as its limits are not lowered.
pub(crate) fn shortest_s(
    run: &Run,
    pieces: &[PathPiece],
    lever_m: f64,
    sampling: &Sampling,
) -> f64 {
    let full = largest(run, pieces, lever_m);
    // The position at an end, which is rounded, changes the acceleration within a quintic by at most 5.8 h / T^2.
    let least_s = (5.8 * sampling.resolution_m / (ROUNDING * full)).sqrt();
    if run.jerk.is_none() {
        return least_s;
    }
    // The jerk changes by at most 60 h / T^3, and with it the verdict on each move, at random.
    let step_s = least_s.max(f64::from(sampling.ticks_min) * sampling.period_s);
    let law = Law::new(run, pieces, step_s, sampling.period_s);
    let rounded = 60.0 * (sampling.resolution_m + lever_m * sampling.resolution_rad);
    let jerk = law.largest_jerk(lever_m);
    least_s.max(libm::cbrt(rounded / (ROUNDED_JERK * jerk)).min(LONGEST_S))
}

/// Shortest move, s, for which the rounding of its ends is little beside the feeds of `run`.
fn least_at_feed_s(run: &Run, pieces: &[PathPiece], sampling: &Sampling) -> f64 {
    let feeds = pieces[run.pieces.clone()]
        .iter()
        .filter_map(|each| each.feed_m_s);
    let feed = feeds.fold(f64::INFINITY, f64::min);
    (sampling.rounded_speed(1.0) / (ROUNDING * feed)).min(LONGEST_S)
}

/// Ticks between changes of the tool's setting at the feeds of `run`, at least 1 and at most those of the shortest move.
fn change_ticks(run: &Run, pieces: &[PathPiece], sampling: &Sampling) -> f64 {
    let pieces = &pieces[run.pieces.clone()];
    let equal = pieces.chunk_by(|before, here| before.setting == here.setting);
    // The first and the last group begin and end at rest.
    let within = equal.skip(1).filter_map(|group| {
        let times = group
            .iter()
            .map(|each| each.feed_m_s.map(|feed| each.piece.length_m() / feed));
        times.sum::<Option<f64>>()
    });
    let shortest_s = within.fold(f64::INFINITY, f64::min);
    (shortest_s / sampling.period_s)
        .round()
        .clamp(1.0, f64::from(sampling.ticks_min))
}

/// Lowers the limits of `run` to what moves can use of them: a feed, by what rounding adds to the speed of short moves.
pub(crate) fn leave_room(run: &mut Run, pieces: &[PathPiece], sampling: &Sampling) {
    let period_s = change_ticks(run, pieces, sampling) * sampling.period_s;
    let least_s = least_at_feed_s(run, pieces, sampling).max(period_s);
    for index in 0..run.cells.len() {
        let feed = pieces[run.places[index].piece].feed_m_s;
        let rounded = feed.map_or(0.0, |feed| sampling.rounded_speed(least_s) / feed);
        let speed = FEED - FASTER - rounded;
        run.tighten_for(
            index..index + 1,
            (speed * speed.abs()).clamp(SHARE_MIN, SHARE),
            Limited::Number,
        );
    }
}

/// Largest acceleration of the plan.
pub(crate) fn largest(run: &Run, pieces: &[PathPiece], lever_m: f64) -> f64 {
    let places = run.places.iter().zip(&run.squares).take(run.cells.len());
    let sizes = places.enumerate().map(|(index, (place, x))| {
        let point = pieces[place.piece].piece.at(place.p);
        size(
            point.first * run.acceleration(index) + point.second * *x,
            lever_m,
        )
    });
    sizes.fold(0.0, f64::max)
}
