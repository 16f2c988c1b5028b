//! The plan of a run, smoothed over a few steps of time.
//!
//! A uniform cubic spline in time whose coefficients are the plan's poses, a step apart. Its acceleration is an average
//! of the plan's over two steps: continuous where the plan's jumps, and of no value that the plan does not take nearby.

use crate::course::{PathPiece, PathPlace, Run};
use crate::timeline::Timeline;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Pose, Setpoint};

/// The smoothed run. It begins and ends at rest, one step before and after the plan.
pub(crate) struct Spline<'a> {
    run: &'a Run,
    pieces: &'a [PathPiece],
    timeline: Timeline,
    /// Pose of the plan at each step, from one before the start to one after the end.
    poses: Vec<Pose<f64>>,
    /// Seconds between two of them.
    step_s: f64,
    /// Duration in ticks.
    pub(crate) ticks: u32,
    period_s: f64,
}

impl<'a> Spline<'a> {
    /// Smooths `run` over steps of `least_s` or a little more, so that it takes whole ticks.
    pub(crate) fn new(run: &'a Run, pieces: &'a [PathPiece], least_s: f64, period_s: f64) -> Self {
        let timeline = Timeline::of(run);
        let planned = timeline.duration();
        let mut ticks = ((planned + 2.0 * least_s) / period_s).ceil();
        let (step_s, count) = loop {
            let count = (ticks * period_s / least_s).floor();
            let step_s = ticks * period_s / count;
            // The last coefficients but two are poses of the plan.
            if (count - 2.0) * step_s >= planned {
                break (step_s, count as usize);
            }
            ticks += 1.0;
        };
        let mut spline = Self {
            run,
            pieces,
            timeline,
            poses: Vec::new(),
            step_s,
            ticks: ticks as u32,
            period_s,
        };
        let pose = |index: usize| {
            let distance = spline.timeline.distance_at((index as f64 - 2.0) * step_s);
            let place = spline.timeline.place_at(distance, &run.places);
            pieces[place.piece].piece.at(place.p).pose
        };
        spline.poses = (0..=count + 2).map(pose).collect();
        spline
    }

    /// The setpoint at `tick`.
    pub(crate) fn at(&self, tick: f64) -> Setpoint<f64> {
        let steps = tick * self.period_s / self.step_s;
        let index = (steps.floor() as usize).min(self.poses.len() - 4);
        let w = steps - index as f64;
        let origin = self.poses[index + 1];
        let [before, after, last] =
            [0, 2, 3].map(|other| origin.displacement(&self.poses[index + other]));
        let sum = |weights: [f64; 3]| -> Vector3<f64> {
            before * weights[0] + after * weights[1] + last * weights[2]
        };
        let v = 1.0 - w;
        let way = sum([
            v * v * v / 6.0,
            (1.0 + 3.0 * w * (1.0 + w - w * w)) / 6.0,
            w * w * w / 6.0,
        ]);
        let first = sum([-0.5 * v * v, 0.5 + w - 1.5 * w * w, 0.5 * w * w]);
        let second = sum([v, 1.0 - 3.0 * w, w]);
        Setpoint {
            pose: origin.displaced(way),
            velocity: first / self.step_s,
            acceleration: second / (self.step_s * self.step_s),
        }
    }

    /// Distance of the plan at `tick`.
    pub(crate) fn distance(&self, tick: f64) -> f64 {
        let time = tick * self.period_s - self.step_s;
        self.timeline.distance_at(time)
    }

    /// Tick at which the plan is at `distance`.
    pub(crate) fn tick_at(&self, distance: f64) -> f64 {
        (self.timeline.time_at(distance) + self.step_s) / self.period_s
    }

    /// Place of the plan at `tick`.
    pub(crate) fn place(&self, tick: f64) -> PathPlace {
        let distance = self.distance(tick);
        self.timeline.place_at(distance, &self.run.places)
    }

    /// Greatest speed of D at `tick`, m/s; infinite where it is not limited.
    pub(crate) fn feed(&self, tick: f64) -> f64 {
        let piece = &self.pieces[self.place(tick).piece];
        piece.feed_m_s.unwrap_or(f64::INFINITY)
    }

    /// Cells of the plan that the motion between two ticks is made of.
    pub(crate) fn cells(&self, [from, to]: [f64; 2]) -> core::ops::Range<usize> {
        let around = 2.0 * self.step_s / self.period_s;
        let cell = |tick| self.timeline.cell_at(self.distance(tick));
        cell(from - around)..cell(to + around) + 1
    }

    /// The pieces of the path.
    pub(crate) fn pieces(&self) -> &'a [PathPiece] {
        self.pieces
    }
}
