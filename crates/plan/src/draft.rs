//! Moves of a run: quintics that follow its [`Spline`], as long as they can be.

use crate::deviation::Deviation;
use crate::fit::{Fit, LONGEST_S, ends, rest, size};
use crate::path::PathPiece;
use crate::planned::{PlannedMove, Sampling};
use crate::run::Run;
use crate::spline::Spline;
use core::ops::Range;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Segment, Setpoint};

/// Factor from a move that is too long to the next one that is tried.
const SHORTER: f64 = 0.75;
/// Instants at which the path is compared.
const INSTANTS: u32 = 16;
/// Part of the largest acceleration, and of the feed, that the rounding of poses may make.
const ROUNDING: f64 = 0.01;
/// Part of the tolerances that moves may use at the instants that are looked at.
const PART_OF_TOLERANCE: f64 = 0.95;
/// Part of the feed by which a move may be faster than the spline.
const FASTER: f64 = 1e-4;
/// Part of the feed that moves may use at the instants that are looked at.
const FEED: f64 = 0.9997;
/// Part of the limits that a plan for moves uses at most; the rest is for what moves differ from it.
const SHARE: f64 = 0.999;
/// The same where the feed is hardly more than rounding.
const SHARE_MIN: f64 = 0.25;
/// Part of the largest jerk by which a move may differ from the spline.
const JERK: f64 = 0.03;
/// Part of the largest jerk that the rounding of poses may make.
const ROUNDED_JERK: f64 = 0.03;
/// Ticks of a step of the spline at least, for moves that are as long.
const SMOOTHING_TICKS: f64 = 1.0;

/// A place of a run near which moves are shorter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine {
    /// Distance along the run.
    distance: f64,
    /// Ticks of a move there.
    ticks: f64,
}

/// Moves of a run before they are judged.
pub(crate) struct Draft<'a> {
    spline: Spline<'a>,
    pub(crate) moves: Vec<PlannedMove>,
    /// Ticks at which the moves begin, and the last one ends.
    knots: Vec<f64>,
    /// Ticks of the shortest move.
    least: f64,
    /// Ticks between changes of the tool's setting at least.
    least_change: f64,
    fit: Fit<f64>,
    /// Largest jerk of the spline, where it is limited.
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
    ) -> Self {
        let least = (least_s / sampling.period_s)
            .ceil()
            .max(f64::from(sampling.ticks_min));
        let step_s = least.max(SMOOTHING_TICKS) * sampling.period_s;
        let spline = Spline::new(run, pieces, step_s, sampling.period_s);
        let mut draft = Self {
            spline,
            moves: Vec::new(),
            knots: vec![0.0],
            least,
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
        draft.jerk = run
            .jerk
            .is_some()
            .then(|| draft.spline.largest_jerk(lever_m));
        let fine: Vec<(f64, f64)> = fine
            .iter()
            .map(|each| (draft.spline.tick_at(each.distance), each.ticks))
            .collect();
        let end = f64::from(draft.spline.ticks);
        let changes = draft.changes(end);
        let mut at = 0.0;
        let mut state = rest(draft.spline.at(0.0).pose);
        while at < end {
            let next = changes.iter().copied().find(|&change| change > at);
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
        let mut changes = self.spline.changes();
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

    /// The end of the longest move from `from` that follows the spline and goes no further than `until`, of a run until `end`.
    fn longest(
        &self,
        from: f64,
        state: Setpoint<f64>,
        [until, end]: [f64; 2],
        fine: &[(f64, f64)],
    ) -> (f64, Setpoint<f64>) {
        let left = until - from;
        let mut ticks = (LONGEST_S / self.sampling.period_s).floor().min(left);
        loop {
            // What is left behind it is a move, too.
            if left - ticks < self.least && left > ticks {
                ticks = match left >= 2.0 * self.least {
                    true => (left - self.least).min(ticks),
                    false => left,
                };
            }
            let to = from + ticks;
            let there = match to >= end {
                true => rest(self.spline.at(to).pose),
                false => self.spline.at(to),
            };
            let shorter = (SHORTER * ticks).floor().max(self.least);
            let is_fine = |&(place, most): &(f64, f64)| ticks <= most || place < from || place > to;
            let span = [from as u32, to as u32];
            let follows = fine.iter().all(is_fine)
                && self.fit.difference(&self.spline, span, &[state, there]) <= 1.0
                && self.follows_jerk([from, to], &[state, there]);
            if follows || shorter >= ticks || left < 2.0 * self.least {
                return (to, there);
            }
            ticks = shorter;
        }
    }

    /// Returns true if the move between `states` has the jerk of the spline, where that is limited.
    fn follows_jerk(&self, [from, to]: [f64; 2], states: &[Setpoint<f64>; 2]) -> bool {
        let Some(largest) = self.jerk else {
            return true;
        };
        let period_s = self.sampling.period_s;
        let segment = Segment::new(&ends(states), (to - from) as u32, period_s);
        (0..=INSTANTS).all(|instant| {
            let part = f64::from(instant) / f64::from(INSTANTS);
            let tick = (from + part * (to - from)).clamp(from + 0.5, to - 0.5);
            let bent = segment.jerk_at_fraction(part, period_s) - self.spline.jerk_at(tick);
            size(bent, self.fit.lever) <= JERK * largest
        })
    }

    fn push(&mut self, [from, to]: [f64; 2], states: [Setpoint<f64>; 2]) {
        self.knots.push(to);
        self.moves.push(PlannedMove {
            ends: ends(&states),
            ticks: (to - from) as u32,
            place: self.spline.place(from),
            piece: self.spline.place(0.5 * (from + to)).piece,
        });
    }

    /// Returns true if move `index` can be cut.
    pub(crate) fn splits(&self, index: usize) -> bool {
        f64::from(self.moves[index].ticks) >= 2.0 * self.least
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
            spline: &self.spline,
            tolerances: Vector3::new(metres, metres, radians),
            period_s: sampling.period_s,
        };
        let segment = self.moves[index].segment(sampling.period_s);
        path.of(&segment, [self.knots[index], self.knots[index + 1]])
    }

    /// Returns the largest speed of move `index` at a few instants, in parts of the feed.
    pub(crate) fn speed(&self, index: usize) -> f64 {
        let sampling = &self.sampling;
        let each = &self.moves[index];
        let segment = each.segment(sampling.period_s);
        let ticks = f64::from(each.ticks);
        let rounded = sampling.rounded_speed(ticks * sampling.period_s);
        let speeds = (0..=INSTANTS).filter_map(|instant| {
            let part = f64::from(instant) / f64::from(INSTANTS);
            let feed = self.spline.feed(self.knots[index] + part * ticks)?;
            let velocity = segment.at_fraction(part).velocity;
            Some((libm::hypot(velocity.x, velocity.y) + rounded) / (FEED * feed))
        });
        speeds.fold(0.0, f64::max)
    }

    /// Moves half as long at move `index`.
    pub(crate) fn closer(&self, index: usize) -> Fine {
        Fine {
            distance: self
                .spline
                .distance(0.5 * (self.knots[index] + self.knots[index + 1])),
            ticks: (0.5 * f64::from(self.moves[index].ticks))
                .floor()
                .max(self.least),
        }
    }

    /// Cells of the plan that move `index` is made of.
    pub(crate) fn cells(&self, index: usize) -> Range<usize> {
        self.spline
            .cells([self.knots[index], self.knots[index + 1]])
    }
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
    let least_s = least_s.max(least_at_feed_s(run, pieces, sampling));
    if run.jerk.is_none() {
        return least_s;
    }
    // The jerk changes by at most 60 h / T^3, and with it the verdict on each move, at random.
    let step_s = least_s.max(f64::from(sampling.ticks_min) * sampling.period_s);
    let spline = Spline::new(run, pieces, step_s, sampling.period_s);
    let rounded = 60.0 * (sampling.resolution_m + lever_m * sampling.resolution_rad);
    let jerk = spline.largest_jerk(lever_m);
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
        run.tighten(
            index..index + 1,
            (speed * speed.abs()).clamp(SHARE_MIN, SHARE),
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
