//! The planned motion as a function of time.
//!
//! The plan of a run has an acceleration that is constant in each cell and jumps between them. With a limit of jerk the
//! distance is its mean over a short time, and that once more, so that the acceleration goes evenly from one to the next.

use crate::path::PathPlace;
use crate::run::Run;

/// Time, distance and pace at the start of a cell.
#[derive(Clone, Copy, Debug)]
struct Mark {
    time: f64,
    distance: f64,
    /// Integral of the distance by time, and that of the integral.
    sums: [f64; 2],
    pace: f64,
    acceleration: f64,
    /// Distance for each unit of the piece's parameter.
    scale: f64,
}

impl Mark {
    fn sums_after(&self, t: f64) -> [f64; 2] {
        let [sum, twice] = self.sums;
        let Self {
            distance,
            pace,
            acceleration,
            ..
        } = *self;
        [
            sum + (distance + (pace / 2.0 + acceleration * t / 6.0) * t) * t,
            twice + (sum + (distance / 2.0 + (pace / 6.0 + acceleration * t / 24.0) * t) * t) * t,
        ]
    }
}

/// A run in time.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    /// Time over which the distance is a mean.
    mean_s: f64,
    /// Starts of the cells, and the end.
    marks: Vec<Mark>,
}

impl Timeline {
    pub(crate) fn of(run: &Run) -> Self {
        let mut marks = Vec::with_capacity(run.places.len());
        let (mut time, mut distance, mut sums, mut scale) = (0.0, 0.0, [0.0; 2], 1.0);
        for (index, cell) in run.cells.iter().enumerate() {
            if index > 0 {
                // The pace in s is continuous where the pace in p is not.
                scale /= cell.joint.sqrt();
            }
            let mark = Mark {
                time,
                distance,
                sums,
                pace: scale * run.squares[index].sqrt(),
                acceleration: scale * run.acceleration(index),
                scale,
            };
            marks.push(mark);
            let duration = run.cell_duration_s(index);
            sums = mark.sums_after(duration);
            time += duration;
            distance += scale * cell.length;
        }
        marks.push(Mark {
            time,
            distance,
            sums,
            pace: 0.0,
            acceleration: 0.0,
            scale,
        });
        let mean_s = run.mean_s();
        Self { mean_s, marks }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.marks[self.marks.len() - 1].time + 2.0 * self.mean_s
    }

    /// The distance at `time`: 0 before the start, the whole after the end.
    pub(crate) fn distance_at(&self, time: f64) -> f64 {
        if self.mean_s > 0.0 {
            let [now, before, first] =
                [0.0, 1.0, 2.0].map(|means| self.sum_at(time - means * self.mean_s));
            return ((now - before) - (before - first)) / (self.mean_s * self.mean_s);
        }
        let next = self.marks.partition_point(|mark| mark.time <= time);
        let Some(mark) = next.checked_sub(1).map(|index| &self.marks[index]) else {
            return 0.0;
        };
        if next == self.marks.len() {
            return mark.distance;
        }
        let t = time - mark.time;
        let distance = mark.distance + (mark.pace + 0.5 * mark.acceleration * t) * t;
        distance.min(self.marks[next].distance)
    }

    /// Second integral of the distance of the plan itself until `time`.
    fn sum_at(&self, time: f64) -> f64 {
        let next = self.marks.partition_point(|mark| mark.time <= time);
        let mark = next.checked_sub(1).map(|index| &self.marks[index]);
        mark.map_or(0.0, |mark| mark.sums_after(time - mark.time)[1])
    }

    /// Time at which the plan is at `distance`, or about it.
    pub(crate) fn time_at(&self, distance: f64) -> f64 {
        self.mean_s + self.planned_time_at(distance)
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

    /// Time at which the plan is at place `index` of the run.
    pub(crate) fn time_of(&self, index: usize) -> f64 {
        self.marks[index].time + self.mean_s
    }

    /// Index of the cell that holds `distance`.
    pub(crate) fn cell_at(&self, distance: f64) -> usize {
        let next = self.marks.partition_point(|mark| mark.distance <= distance);
        next.saturating_sub(1).min(self.marks.len() - 2)
    }

    /// Place at `distance`, with the places of the run.
    pub(crate) fn place_at(&self, distance: f64, places: &[PathPlace]) -> PathPlace {
        let index = self.cell_at(distance);
        let mark = &self.marks[index];
        let p = places[index].p + (distance - mark.distance) / mark.scale;
        PathPlace {
            p: p.clamp(0.0, 1.0),
            ..places[index]
        }
    }
}
