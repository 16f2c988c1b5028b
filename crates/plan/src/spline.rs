//! The plan of a run, smoothed over a few steps of time.
//!
//! A uniform cubic spline in time whose coefficients are the plan's poses, a step apart. Its acceleration is an average
//! of the plan's over two steps: continuous where the plan's jumps, and of no value that the plan does not take nearby.

use crate::fit::{Motion, size, smoothed};
use crate::path::{PathPiece, PathPlace};
use crate::run::Run;
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
        let poses = [0, 1, 2, 3].map(|other| &self.poses[index + other]);
        smoothed(poses, w, self.step_s)
    }

    /// The jerk over the tick about `tick`.
    pub(crate) fn jerk_at(&self, tick: f64) -> Vector3<f64> {
        let [before, after] = [-0.5, 0.5].map(|half| self.at(tick + half).acceleration);
        (after - before) / self.period_s
    }

    /// Size of the largest jerk, that of a point of the platform `lever_m` from D.
    pub(crate) fn largest_jerk(&self, lever_m: f64) -> f64 {
        let jerks = (0..self.ticks).map(|tick| self.jerk_at(f64::from(tick) + 0.5));
        jerks.map(|jerk| size(jerk, lever_m)).fold(0.0, f64::max)
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

    /// Whole ticks nearest to where the tool's setting changes along the run.
    pub(crate) fn changes(&self) -> Vec<f64> {
        let pairs = self.run.places.windows(2).enumerate();
        let changes = pairs.filter(|(_, pair)| {
            let [before, here] = [pair[0].piece, pair[1].piece].map(|piece| &self.pieces[piece]);
            before.setting != here.setting
        });
        let tick = |index: usize| (self.timeline.time_of(index) + self.step_s) / self.period_s;
        changes.map(|(index, _)| tick(index + 1).round()).collect()
    }

    /// Place of the plan at `tick`.
    pub(crate) fn place(&self, tick: f64) -> PathPlace {
        let distance = self.distance(tick);
        self.timeline.place_at(distance, &self.run.places)
    }

    /// Greatest speed of D at `tick`, m/s, if it is limited.
    pub(crate) fn feed(&self, tick: f64) -> Option<f64> {
        self.pieces[self.place(tick).piece].feed_m_s
    }

    /// Cells of the plan that the motion between two ticks is made of.
    pub(crate) fn cells(&self, [from, to]: [f64; 2]) -> core::ops::Range<usize> {
        let around = (2.0 * self.step_s + 2.0 * self.run.mean_s()) / self.period_s;
        let cell = |tick| self.timeline.cell_at(self.distance(tick));
        let [first, last] = [cell(from - around), cell(to + around)];
        // Where a mean of the plan is at rest, the distance is rounded.
        first.min(last)..first.max(last) + 1
    }

    /// The run that is smoothed.
    pub(crate) fn run(&self) -> &'a Run {
        self.run
    }

    /// The pieces of the path.
    pub(crate) fn pieces(&self) -> &'a [PathPiece] {
        self.pieces
    }
}

impl Motion<f64> for Spline<'_> {
    fn at(&self, eighths: u32) -> Setpoint<f64> {
        self.at(f64::from(eighths) / 8.0)
    }

    fn feed(&self, eighths: u32) -> Option<f64> {
        self.feed(f64::from(eighths) / 8.0)
    }
}
