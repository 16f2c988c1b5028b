//! Dynamic program over places of the path and values of alpha.

use super::estimate::{Sample, Sampler};
use super::knots::{Knot, Stretch};
use crate::cell::Obstacle;
use core::f64::consts::PI;
use trirrr_core::model::Model;
use trirrr_core::setpoint::Pose;

/// Step of alpha, rad, unless that makes more than so many values.
const STEP: f64 = 0.04;
const VALUES_MAX: f64 = 2000.0;
/// Most steps from one knot to the next, where the next is free.
const STEPS_MAX: usize = 20;
/// Places between two knots that are looked at, beside the second knot.
const BETWEEN: usize = 4;

/// The farthest place that no alpha leads beyond.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeadEnd {
    pub(crate) piece: usize,
    pub(crate) p: f64,
    pub(crate) pose: Pose<f64>,
    pub(crate) obstacle: Obstacle,
    /// D's way to it.
    way_m: f64,
}

/// Least estimated time to a knot with a value of alpha, and the value at the knot before.
#[derive(Clone, Copy)]
struct Reached {
    time: f64,
    from: usize,
}

/// Samples of the places between two knots and of the second knot, as far as they are known.
type Samples = [Option<Result<Sample, Obstacle>>; BETWEEN + 1];

/// Values of alpha and what is known of the places.
struct Search<'a, M: Model<N = f64>> {
    sampler: &'a Sampler<M>,
    stretch: &'a Stretch<'a>,
    side: bool,
    margin: f64,
    turning: f64,
    least: f64,
    step: f64,
    count: usize,
    /// Samples of the places between two knots, for each value.
    samples: Vec<Option<Box<Samples>>>,
    dead_end: Option<DeadEnd>,
}

/// Returns alpha at each of `knots`, so that the estimated time is least and the distances keep their `margin`.
/// `turning` weights the turn of the platform's joints beside D's way.
///
/// # Errors
/// The place beyond which no alpha leads.
pub(crate) fn search<M: Model<N = f64>>(
    sampler: &Sampler<M>,
    stretch: &Stretch<'_>,
    knots: &[Knot],
    [margin, turning]: [f64; 2],
) -> Result<Vec<f64>, DeadEnd> {
    let start = knots[0].fixed.unwrap_or(0.0);
    let fixed = || knots.iter().filter_map(|knot| knot.fixed);
    let below = start - fixed().fold(start, f64::min) + PI;
    let above = fixed().fold(start, f64::max) + PI - start;
    let step = STEP.max((below + above) / VALUES_MAX);
    // Whole steps from the start, which is a value itself.
    let [below, above] = [below, above].map(|range| (range / step).ceil());
    let pose = Pose {
        angle: start,
        ..stretch.pieces[0].piece.at(0.0).pose
    };
    let mut search = Search {
        sampler,
        stretch,
        side: sampler.side(pose),
        margin,
        turning,
        least: start - below * step,
        step,
        count: (below + above) as usize + 1,
        samples: Vec::new(),
        dead_end: None,
    };
    search.run(knots, below as usize)
}

impl<M: Model<N = f64>> Search<'_, M> {
    fn angle(&self, knot: &Knot, value: usize) -> f64 {
        knot.fixed.unwrap_or(self.least + self.step * value as f64)
    }

    /// The value nearest to `angle`.
    fn nearest(&self, angle: f64) -> usize {
        let value = ((angle - self.least) / self.step).round().max(0.0) as usize;
        value.min(self.count - 1)
    }

    fn run(&mut self, knots: &[Knot], start: usize) -> Result<Vec<f64>, DeadEnd> {
        let mut stages: Vec<Vec<Option<Reached>>> = Vec::with_capacity(knots.len());
        let mut alive = vec![None; self.count];
        alive[start] = Some(Reached {
            time: 0.0,
            from: start,
        });
        stages.push(alive);
        for (index, ends) in knots.windows(2).enumerate() {
            let next = self.stage([&ends[0], &ends[1]], &stages[index]);
            if next.iter().all(Option::is_none) {
                // A transition that fails notes where.
                return Err(self.dead_end.expect("a place"));
            }
            stages.push(next);
        }
        let time = |stage: &Vec<Option<Reached>>, value: usize| {
            stage[value].map_or(f64::INFINITY, |reached| reached.time)
        };
        let last = &stages[knots.len() - 1];
        let mut value = (0..self.count)
            .min_by(|a, b| time(last, *a).total_cmp(&time(last, *b)))
            .unwrap_or(start);
        let mut angles = vec![0.0; knots.len()];
        for (index, stage) in stages.iter().enumerate().rev() {
            angles[index] = self.angle(&knots[index], value);
            value = stage[value].map_or(value, |reached| reached.from);
        }
        Ok(angles)
    }

    /// Continues from the values that were reached at a knot to the next.
    fn stage(&mut self, ends: [&Knot; 2], before: &[Option<Reached>]) -> Vec<Option<Reached>> {
        self.samples = vec![None; self.count];
        let mut next: Vec<Option<Reached>> = vec![None; self.count];
        for (from, reached) in before.iter().enumerate() {
            let Some(reached) = reached else { continue };
            let window = match ends[1].fixed {
                Some(fixed) => {
                    let value = self.nearest(fixed);
                    value..value + 1
                }
                None => from.saturating_sub(STEPS_MAX)..(from + STEPS_MAX + 1).min(self.count),
            };
            for to in window {
                let Some(time) = self.transition(ends, [from, to]) else {
                    continue;
                };
                let time = reached.time + time;
                if next[to].is_none_or(|known| time < known.time) {
                    next[to] = Some(Reached { time, from });
                }
            }
        }
        next
    }

    /// Estimated time from one knot to the next; none where it is not possible.
    fn transition(&mut self, ends: [&Knot; 2], values: [usize; 2]) -> Option<f64> {
        let angles = [0, 1].map(|i: usize| self.angle(ends[i], values[i]));
        let way_m = ends[1].way_m - ends[0].way_m;
        let turn = angles[1] - angles[0];
        let mut time = 0.0;
        for place in 0..=BETWEEN {
            let is_end = place == BETWEEN;
            let part = match is_end {
                true => 1.0,
                false => (place as f64 + 0.5) / BETWEEN as f64,
            };
            let at_m = ends[0].way_m + way_m * part;
            let (piece, p) = match is_end {
                true => (ends[1].piece, ends[1].p),
                false => self.stretch.place(at_m),
            };
            let value = match is_end {
                true => values[1],
                false => self.nearest(angles[0] + turn * part),
            };
            let known = self.samples[value].get_or_insert_default()[place];
            let sample = match known {
                Some(known) => known,
                None => {
                    let angle = match is_end {
                        true => angles[1],
                        false => self.least + self.step * value as f64,
                    };
                    let sample = self.sample(piece, p, angle, at_m);
                    self.samples[value].get_or_insert_default()[place] = Some(sample);
                    sample
                }
            };
            let Ok(sample) = sample else { return None };
            if !is_end {
                let length_m = self.stretch.length_m(piece);
                let to_stop = self.stretch.to_stop_m(at_m) / length_m;
                let slope = turn / way_m * length_m;
                let share = way_m / (BETWEEN as f64 * length_m);
                let turning = self.turning;
                time += share * self.sampler.time(&sample, slope, to_stop, turning);
            }
        }
        Some(time)
    }

    fn sample(&mut self, piece: usize, p: f64, angle: f64, way_m: f64) -> Result<Sample, Obstacle> {
        let each = &self.stretch.pieces[piece];
        let mut point = each.piece.at(p);
        point.pose.angle = angle;
        let sample = self
            .sampler
            .sample(&point, each.feed_m_s, self.side, self.margin);
        if let Err(obstacle) = sample
            && self.dead_end.is_none_or(|known| known.way_m < way_m)
        {
            self.dead_end = Some(DeadEnd {
                piece,
                p,
                pose: point.pose,
                obstacle,
                way_m,
            });
        }
        sample
    }
}
