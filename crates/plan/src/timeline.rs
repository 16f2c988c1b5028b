//! The planned motion as a function of time.
//!
//! The plan of a run has an acceleration that is constant in each cell and jumps between them.

use crate::course::{PathPlace, Run};

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

/// A run in time.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    /// Starts of the cells, and the end.
    marks: Vec<Mark>,
}

impl Timeline {
    pub(crate) fn of(run: &Run) -> Self {
        let mut marks = Vec::with_capacity(run.places.len());
        let (mut time, mut distance, mut scale) = (0.0, 0.0, 1.0);
        for (index, cell) in run.cells.iter().enumerate() {
            if index > 0 {
                // The pace in s is continuous where the pace in p is not.
                scale /= cell.joint.sqrt();
            }
            marks.push(Mark {
                time,
                distance,
                pace: scale * run.squares[index].sqrt(),
                acceleration: scale * run.acceleration(index),
                scale,
            });
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
        Self { marks }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.marks[self.marks.len() - 1].time
    }

    /// The distance at `time`: 0 before the start, the whole after the end.
    pub(crate) fn distance_at(&self, time: f64) -> f64 {
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

    /// Time at which the plan is at `distance`.
    pub(crate) fn time_at(&self, distance: f64) -> f64 {
        let next = self.marks.partition_point(|mark| mark.distance <= distance);
        match next.checked_sub(1).map(|index| &self.marks[index]) {
            None => 0.0,
            Some(mark) if next == self.marks.len() => mark.time,
            Some(mark) => {
                let ahead = distance - mark.distance;
                let pace_sq = mark.pace * mark.pace + 2.0 * mark.acceleration * ahead;
                mark.time + 2.0 * ahead / (mark.pace + pace_sq.max(0.0).sqrt())
            }
        }
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
