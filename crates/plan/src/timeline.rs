//! The planned motion as a function of time.
//!
//! The plan of a run has an acceleration that is constant in each cell and jumps between them. The distance that is played is its mean
//! over a short time, and that once more where jerk is limited, so that the acceleration goes evenly from one to the next.

use crate::path::PathPlace;
use crate::run::Run;

/// Time, distance and pace at the start of a cell.
#[derive(Clone, Copy, Debug)]
struct Mark {
    time: f64,
    distance: f64,
    pace: f64,
    acceleration: f64,
    /// Distance for each unit of the piece's parameter.
    scale: f64,
}

impl Mark {
    /// Second and first integral of the distance, distance and pace, `t` after the mark, with this distance and these integrals at it.
    fn after(&self, t: f64, distance: f64, [sum, twice]: [f64; 2]) -> [f64; 4] {
        let Self {
            pace, acceleration, ..
        } = *self;
        [
            twice + (sum + (distance / 2.0 + (pace / 6.0 + acceleration * t / 24.0) * t) * t) * t,
            sum + (distance + (pace / 2.0 + acceleration * t / 6.0) * t) * t,
            distance + (pace + 0.5 * acceleration * t) * t,
            pace + acceleration * t,
        ]
    }
}

/// A run in time.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    /// Time over which the distance is a mean, and how often it is one.
    mean_s: f64,
    means: u32,
    /// Starts of the cells, and the end.
    marks: Vec<Mark>,
}

impl Timeline {
    /// `run`, as means over `window_s` or a little more, and its duration in ticks.
    pub(crate) fn of(run: &Run, window_s: f64, period_s: f64) -> (Self, u32) {
        let mut marks = Vec::with_capacity(run.places.len());
        let (mut time, mut distance, mut scale) = (0.0, 0.0, 1.0);
        for (index, cell) in run.cells.iter().enumerate() {
            if index > 0 {
                // The pace in s is continuous where the pace in p is not.
                scale /= cell.joint.sqrt();
            }
            let mark = Mark {
                time,
                distance,
                pace: scale * run.squares[index].sqrt(),
                acceleration: scale * run.acceleration(index),
                scale,
            };
            marks.push(mark);
            time += run.cell_duration_s(index);
            distance += scale * cell.length;
        }
        marks.push(Mark {
            time,
            distance,
            pace: 0.0,
            acceleration: 0.0,
            scale,
        });
        let (means, least_s) = match run.mean_s() > 0.0 {
            true => (2, run.mean_s()),
            false => (1, window_s),
        };
        let ticks = ((time + f64::from(means) * least_s) / period_s).ceil();
        let mean_s = (ticks * period_s - time) / f64::from(means);
        let timeline = Self {
            mean_s,
            means,
            marks,
        };
        (timeline, ticks as u32)
    }

    /// Index of the mark before `time`; none before the start.
    fn mark_at(&self, time: f64) -> Option<usize> {
        let next = self.marks.partition_point(|mark| mark.time <= time);
        next.checked_sub(1)
    }

    /// Distance and pace of the plan itself.
    fn planned(&self, time: f64) -> [f64; 2] {
        let Some(index) = self.mark_at(time) else {
            return [0.0; 2];
        };
        let mark = &self.marks[index];
        let [.., distance, pace] = mark.after(time - mark.time, mark.distance, [0.0; 2]);
        [distance, pace]
    }

    /// Distance, pace and acceleration at `time`.
    pub(crate) fn at(&self, time: f64) -> [f64; 3] {
        let mean = self.mean_s;
        if self.means == 1 {
            let from = self.planned(time - mean);
            let to = self.planned(time);
            let distance = from[0] + self.way(time - mean, from[0], time) / mean;
            return [distance, (to[0] - from[0]) / mean, (to[1] - from[1]) / mean];
        }
        let first = self.mark_at(time - 2.0 * mean).unwrap_or(0);
        let planned = |means: f64| self.planned_from(first, time - means * mean);
        let [now, before, first_of_all] = [0.0, 1.0, 2.0].map(planned);
        let change = |each: usize| {
            let changes = [now[each] - before[each], before[each] - first_of_all[each]];
            (changes[0] - changes[1]) / (mean * mean)
        };
        [self.marks[first].distance + change(0), change(1), change(2)]
    }

    /// As [`Mark::after`], with distance and integrals from mark `first` on: those of a whole run would lose the digits of their differences.
    fn planned_from(&self, first: usize, time: f64) -> [f64; 4] {
        if time <= self.marks[first].time {
            return [0.0; 4];
        }
        let base = self.marks[first].distance;
        let mut sums = [0.0; 2];
        let mut index = first;
        loop {
            let mark = self.marks[index];
            let (distance, began) = (mark.distance - base, mark.time);
            let next = self.marks.get(index + 1).filter(|next| next.time <= time);
            let until = next.map_or(time, |next| next.time);
            let after = mark.after(until - began, distance, sums);
            if next.is_none() {
                return after;
            }
            sums = [after[1], after[0]];
            index += 1;
        }
    }

    /// Integral of the distance beyond `base` over the time from `from` to `to`.
    fn way(&self, from: f64, base: f64, to: f64) -> f64 {
        let mut sum = 0.0;
        let first = self.mark_at(from).unwrap_or(0);
        for (index, mark) in self.marks.iter().enumerate().skip(first) {
            if mark.time >= to {
                break;
            }
            let end = self
                .marks
                .get(index + 1)
                .map_or(to, |next| next.time.min(to));
            let [t, u] = [from.max(mark.time), end].map(|time| time - mark.time);
            let integral = |t: f64| {
                ((mark.distance - base) + (mark.pace / 2.0 + mark.acceleration * t / 6.0) * t) * t
            };
            if u > t {
                sum += integral(u) - integral(t);
            }
        }
        // Before the start it stands.
        sum + (0.0 - base) * (self.marks[0].time.min(to) - from).max(0.0)
    }

    /// Time at which the motion is at `distance`, or about it.
    pub(crate) fn time_at(&self, distance: f64) -> f64 {
        0.5 * f64::from(self.means) * self.mean_s + self.planned_time_at(distance)
    }

    fn planned_time_at(&self, distance: f64) -> f64 {
        let next = self.marks.partition_point(|mark| mark.distance <= distance);
        match next.checked_sub(1).map(|index| &self.marks[index]) {
            None => 0.0,
            // At rest there is no time to divide by.
            Some(mark) if next == self.marks.len() || distance == mark.distance => mark.time,
            Some(mark) => {
                let ahead = distance - mark.distance;
                let pace_sq = mark.pace * mark.pace + 2.0 * mark.acceleration * ahead;
                mark.time + 2.0 * ahead / (mark.pace + pace_sq.max(0.0).sqrt())
            }
        }
    }

    /// Time at which the motion is at place `index` of the run: by bisection of the mean.
    pub(crate) fn time_of(&self, index: usize) -> f64 {
        let mark = &self.marks[index];
        let (mut low, mut high) = (mark.time, mark.time + f64::from(self.means) * self.mean_s);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            match self.at(middle)[0] < mark.distance {
                true => low = middle,
                false => high = middle,
            }
        }
        0.5 * (low + high)
    }

    /// Distance for each unit of the piece's parameter in a cell.
    pub(crate) fn scale(&self, cell: usize) -> f64 {
        self.marks[cell].scale
    }

    /// Index of the cell that holds `distance`.
    fn cell_at(&self, distance: f64) -> usize {
        let next = self.marks.partition_point(|mark| mark.distance <= distance);
        next.saturating_sub(1).min(self.marks.len() - 2)
    }

    /// Distances of the plan between which lies all of which the motion between two times is a mean.
    pub(crate) fn span(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        [from - f64::from(self.means) * self.mean_s, to].map(|time| self.planned_distance(time))
    }

    /// Distance of the plan itself.
    fn planned_distance(&self, time: f64) -> f64 {
        self.planned(time)[0]
    }

    /// Cells of the plan of which the motion between two times is a mean.
    pub(crate) fn cells(&self, times: [f64; 2]) -> core::ops::Range<usize> {
        let [first, last] = self.span(times).map(|distance| self.cell_at(distance));
        first..last + 1
    }

    /// Place at `distance`, with the places of the run, and the distance for each unit of the piece's parameter there.
    pub(crate) fn place_at(&self, distance: f64, places: &[PathPlace]) -> (PathPlace, f64) {
        let index = self.cell_at(distance);
        let mark = &self.marks[index];
        let p = places[index].p + (distance - mark.distance) / mark.scale;
        let place = PathPlace {
            p: p.clamp(0.0, 1.0),
            ..places[index]
        };
        (place, mark.scale)
    }
}
