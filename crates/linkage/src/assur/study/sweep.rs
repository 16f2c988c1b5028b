//! A track between its positions: zeros and least values of a quantity over the motion.

use super::super::description::Linkage;
use super::super::solve::{Position, Solver};
use super::super::track::{HALVINGS, Track};
use std::f64::consts::TAU;

/// Values below this part of the largest one have no sign: they are rounding.
const ROUNDING: f64 = 1e-12;
/// Part of the linkage's size, or rad, by which a turn may miss its start.
const CLOSED: f64 = 1e-9;
/// Most steps of a search between two positions. Golden sections leave 0.618 of the interval each.
const NARROWED: u32 = 60;
/// Positions over a motion between which nothing turns back twice, and in each turn of a drive.
const POSITIONS: (u32, f64) = (360, 180.0);
/// Most positions that are solved for that.
const MOST_POSITIONS: f64 = 36_000.0;

/// Returns the linkage with so many steps that no turning point is missed, if its own are too few.
pub(super) fn finer(linkage: &Linkage) -> Option<Linkage> {
    let motion = linkage.motion;
    let turns = linkage
        .drives
        .iter()
        .filter(|drive| !drive.slides)
        .map(|drive| {
            let fastest = drive.at(motion.duration)[1].abs().max(drive.rate.abs());
            fastest * motion.duration / TAU
        });
    let needed = (POSITIONS.1 * turns.fold(0.0, f64::max)).min(MOST_POSITIONS);
    let needed = POSITIONS.0.max(needed.ceil() as u32);
    (motion.steps < needed).then(|| {
        let mut finer = linkage.clone();
        // Whole parts of the steps, so that the positions of the file are among them.
        finer.motion.steps = motion.steps * needed.div_ceil(motion.steps);
        finer
    })
}

/// A track that can be solved at any time between its first and its last position.
pub(super) struct Sweep<'a> {
    solver: Solver<'a>,
    pub(super) track: &'a Track,
    /// Whole turns of the only drive, after which everything is where it was.
    pub(super) turns: Option<u32>,
}

impl<'a> Sweep<'a> {
    /// `None` for a track without a position.
    pub(super) fn new(linkage: &'a Linkage, track: &'a Track) -> Option<Self> {
        let (solver, _) = Solver::start(linkage).ok()?;
        let (first, last) = (track.positions.first()?, track.positions.last()?);
        let turns = match linkage.drives.as_slice() {
            [drive] if !drive.slides && drive.acceleration == 0.0 && track.stop.is_none() => {
                let turned = (drive.at(last.t)[0] - drive.at(first.t)[0]).abs() / TAU;
                let whole = turned.round();
                let closes = first.states.iter().zip(&last.states).all(|(from, to)| {
                    let (from, to) = (from.pose(), to.pose());
                    let angle = (to[2] - from[2]) / TAU;
                    let off = [
                        (to[0] - from[0]) / linkage.size(),
                        (to[1] - from[1]) / linkage.size(),
                        TAU * (angle - angle.round()),
                    ];
                    off.iter().all(|off| off.abs() < CLOSED)
                });
                let is_whole = whole >= 1.0 && (turned - whole).abs() < CLOSED;
                (is_whole && closes).then_some(whole as u32)
            }
            _ => None,
        };
        Some(Self {
            solver,
            track,
            turns,
        })
    }

    /// Duration of the motion, s.
    pub(super) fn duration(&self) -> f64 {
        self.track.positions.last().map_or(0.0, |last| last.t)
    }

    /// The position at a time; `None` where it cannot be solved. Times beyond the end follow the last position.
    pub(super) fn at(&self, t: f64) -> Option<Position> {
        let positions = &self.track.positions;
        let after = positions.partition_point(|position| position.t <= t);
        let from = positions.get(after.saturating_sub(1))?;
        self.solver.advance(from, t, HALVINGS).ok()
    }

    /// `t` less whole motions, if the motion is of whole turns.
    fn within(&self, t: f64) -> f64 {
        match self.turns {
            Some(_) if t >= self.duration() => t - self.duration(),
            _ => t,
        }
    }

    /// Times at which a quantity changes its sign, in order.
    pub(super) fn zeros(&self, quantity: impl Fn(&Position) -> f64) -> Vec<f64> {
        let values: Vec<(f64, f64)> = self
            .track
            .positions
            .iter()
            .map(|position| (position.t, quantity(position)))
            .collect();
        let largest = values
            .iter()
            .fold(0.0, |most, (_, v)| f64::max(most, v.abs()));
        let has_sign = |(_, value): &&(f64, f64)| value.abs() > ROUNDING * largest;
        let mut signed: Vec<(f64, f64)> = values.iter().filter(has_sign).copied().collect();
        if let (Some(_), Some(&(t, value))) = (self.turns, signed.first()) {
            signed.push((t + self.duration(), value));
        }
        let mut zeros: Vec<f64> = Vec::new();
        for pair in signed.windows(2) {
            if (pair[0].1 > 0.0) != (pair[1].1 > 0.0) {
                zeros.push(self.within(self.zero_between(pair[0], pair[1], &quantity)));
            }
        }
        zeros.sort_by(f64::total_cmp);
        zeros
    }

    /// The zero between two times at which a quantity has different signs: regula falsi in Illinois's form, which halves the value of an
    /// end that stays, so that both ends move.
    fn zero_between(
        &self,
        (mut low, mut at_low): (f64, f64),
        (mut high, mut at_high): (f64, f64),
        quantity: impl Fn(&Position) -> f64,
    ) -> f64 {
        let mut stays = 0;
        for _ in 0..NARROWED {
            let middle = (low * at_high - high * at_low) / (at_high - at_low);
            if !(low < middle && middle < high) {
                break;
            }
            let Some(position) = self.at(middle) else {
                break;
            };
            let value = quantity(&position);
            if value == 0.0 {
                return middle;
            }
            if (value > 0.0) == (at_low > 0.0) {
                (low, at_low) = (middle, value);
                at_high *= if stays == 1 { 0.5 } else { 1.0 };
                stays = 1;
            } else {
                (high, at_high) = (middle, value);
                at_low *= if stays == -1 { 0.5 } else { 1.0 };
                stays = -1;
            }
        }
        // The end nearer to zero.
        if at_low.abs() < at_high.abs() {
            low
        } else {
            high
        }
    }

    /// Least value of a quantity over the motion, and its time; by golden sections between the neighbours of the least position.
    pub(super) fn least(&self, quantity: impl Fn(&Position) -> f64) -> Option<(f64, f64)> {
        let values: Vec<f64> = self.track.positions.iter().map(&quantity).collect();
        let (index, &value) = values
            .iter()
            .enumerate()
            .min_by(|(_, one), (_, other)| one.total_cmp(other))?;
        let t = |index: usize| self.track.positions[index].t;
        let last = values.len() - 1;
        let mut best = (value, t(index));
        let step = self.duration() / last.max(1) as f64;
        let (mut low, mut high) = match (index, self.turns) {
            // At the seam of whole turns the neighbours are on both sides of it: the last position and the second.
            (0, Some(_)) => (t(last) - step, t(last) + step),
            (index, Some(_)) if index == last => (t(last) - step, t(last) + step),
            (index, _) => (t(index.saturating_sub(1)), t((index + 1).min(last))),
        };
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let value_at = |t: f64| {
            self.at(t)
                .map_or(f64::INFINITY, |position| quantity(&position))
        };
        let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let (mut at_left, mut at_right) = (value_at(left), value_at(right));
        for _ in 0..NARROWED {
            if at_left < at_right {
                (high, right, at_right) = (right, left, at_left);
                left = high - GOLDEN * (high - low);
                at_left = value_at(left);
            } else {
                (low, left, at_left) = (left, right, at_right);
                right = low + GOLDEN * (high - low);
                at_right = value_at(right);
            }
        }
        for (value, t) in [(at_left, left), (at_right, right)] {
            if value < best.0 {
                best = (value, self.within(t));
            }
        }
        Some(best)
    }
}
