//! The plan of a run with a smooth law of time.
//!
//! The passes find the distance along the path as a function of time whose second derivative jumps. The law is its mean over a
//! short window, or the mean of a mean where jerk is limited: twice continuously differentiable, at rest at both ends. The path
//! itself stays as it is.

use crate::fit::{Motion, size};
use crate::path::{PathPiece, PathPlace};
use crate::run::Run;
use crate::timeline::Timeline;
use nalgebra::Vector3;
use trirrr_core::setpoint::Setpoint;

/// A run in time, as it is played.
pub(crate) struct Law<'a> {
    run: &'a Run,
    pieces: &'a [PathPiece],
    timeline: Timeline,
    /// Duration in ticks.
    pub(crate) ticks: u32,
    period_s: f64,
}

impl<'a> Law<'a> {
    /// The law of `run`, a mean over `window_s` or up to a tick more: it takes whole ticks.
    pub(crate) fn new(run: &'a Run, pieces: &'a [PathPiece], window_s: f64, period_s: f64) -> Self {
        let (timeline, ticks) = Timeline::of(run, window_s, period_s);
        Self {
            run,
            pieces,
            timeline,
            ticks,
            period_s,
        }
    }

    /// The setpoint at `tick`.
    pub(crate) fn at(&self, tick: f64) -> Setpoint<f64> {
        let [distance, pace, acceleration] = self.timeline.at(tick * self.period_s);
        let (place, scale) = self.timeline.place_at(distance, &self.run.places);
        let point = self.pieces[place.piece].piece.at(place.p);
        let (pace, acceleration) = (pace / scale, acceleration / scale);
        Setpoint {
            pose: point.pose,
            velocity: point.first * pace,
            acceleration: point.first * acceleration + point.second * (pace * pace),
        }
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

    /// Distance along the run at `tick`.
    pub(crate) fn distance(&self, tick: f64) -> f64 {
        self.timeline.at(tick * self.period_s)[0]
    }

    /// Tick at which the motion is at `distance`, or about it.
    pub(crate) fn tick_at(&self, distance: f64) -> f64 {
        self.timeline.time_at(distance) / self.period_s
    }

    /// Ticks at which pieces meet whose accelerations differ by more than `least`, that of a point of the platform `lever_m` from D.
    pub(crate) fn jumps(&self, least: f64, lever_m: f64) -> Vec<f64> {
        let is_joint =
            |index: &usize| self.run.places[*index].piece != self.run.places[*index - 1].piece;
        let joints = (1..self.run.cells.len()).filter(is_joint);
        let jumps = joints.filter_map(|index| {
            let tick = self.timeline.time_of(index) / self.period_s;
            let [_, pace, _] = self.timeline.at(tick * self.period_s);
            let [before, here] = [(index - 1, 1.0), (index, 0.0)].map(|(cell, p)| {
                let scale = pace / self.timeline.scale(cell);
                self.pieces[self.run.places[cell].piece].piece.at(p).second * (scale * scale)
            });
            (size(here - before, lever_m) > least).then_some(tick)
        });
        jumps.collect()
    }

    /// Whole ticks nearest to where the tool's setting changes along the run.
    pub(crate) fn changes(&self) -> Vec<f64> {
        let pairs = self.run.places.windows(2).enumerate();
        let changes = pairs.filter(|(_, pair)| {
            let [before, here] = [pair[0].piece, pair[1].piece].map(|piece| &self.pieces[piece]);
            before.setting != here.setting
        });
        let tick = |index: usize| self.timeline.time_of(index) / self.period_s;
        changes.map(|(index, _)| tick(index + 1).round()).collect()
    }

    /// Ticks about the places at which the feed changes, on the faster side.
    pub(crate) fn feed_changes(&self) -> Vec<f64> {
        let feed = |index: usize| {
            let piece = &self.pieces[self.run.places[index].piece];
            piece.feed_m_s.unwrap_or(f64::INFINITY)
        };
        let changes = (1..self.run.cells.len()).filter_map(|index| {
            let tick = || self.timeline.time_of(index) / self.period_s;
            match feed(index - 1).total_cmp(&feed(index)) {
                core::cmp::Ordering::Equal => None,
                core::cmp::Ordering::Greater => Some(tick().floor()),
                core::cmp::Ordering::Less => Some(tick().ceil()),
            }
        });
        changes.collect()
    }

    /// Place on the path at `tick`.
    pub(crate) fn place(&self, tick: f64) -> PathPlace {
        let distance = self.distance(tick);
        self.timeline.place_at(distance, &self.run.places).0
    }

    /// Greatest speed of D at `tick`, m/s, if it is limited.
    pub(crate) fn feed(&self, tick: f64) -> Option<f64> {
        self.pieces[self.place(tick).piece].feed_m_s
    }

    /// Cells of the plan that the motion between two ticks is made of.
    pub(crate) fn cells(&self, [from, to]: [f64; 2]) -> core::ops::Range<usize> {
        let times = [from, to].map(|tick| tick * self.period_s);
        self.timeline.cells(times)
    }

    /// Places of the plan between which lies all that the motion between two ticks is made of.
    pub(crate) fn span(&self, [from, to]: [f64; 2]) -> [PathPlace; 2] {
        let times = [from, to].map(|tick| tick * self.period_s);
        let place = |distance| self.timeline.place_at(distance, &self.run.places).0;
        self.timeline.span(times).map(place)
    }

    /// The run.
    pub(crate) fn run(&self) -> &'a Run {
        self.run
    }

    /// The pieces of the path.
    pub(crate) fn pieces(&self) -> &'a [PathPiece] {
        self.pieces
    }
}

impl Motion<f64> for Law<'_> {
    fn at(&self, eighths: u32) -> Setpoint<f64> {
        self.at(f64::from(eighths) / 8.0)
    }

    fn feed(&self, eighths: u32) -> Option<f64> {
        self.feed(f64::from(eighths) / 8.0)
    }
}
