//! The plan of a stretch of a path, from rest to rest.

use crate::bound::Possible;
use crate::cell::{Cell, Limited};
use crate::jerk::{self, JerkLimits};
use crate::passes::{acting, controllable, duration, ends_of, fastest, time_between};
use crate::path::PathPlace;
use core::ops::Range;

/// Plan of a stretch from rest to rest without a stop between.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its pieces.
    pub pieces: Range<usize>,
    /// Starts of its cells, and its end.
    pub places: Vec<PathPlace>,
    /// The cells.
    pub cells: Vec<Cell<f64>>,
    /// Bounds of any motion through each cell.
    pub(crate) possible: Vec<Possible<f64>>,
    /// Square of the pace dp/dt at each place, by the parameter of the piece that begins or goes on there; the last
    /// one by the piece that ends.
    pub squares: Vec<f64>,
    /// Upper bound of the square of any motion's pace at each place.
    pub squares_max: Vec<f64>,
    /// Limits of jerk that [`replan`](Self::replan) keeps.
    pub(crate) jerk: Option<JerkLimits>,
    /// Duration.
    pub duration_s: f64,
    /// Lower bound of the duration of any motion along the run.
    pub least_s: f64,
}

/// Part of a limit from which on it acts.
const ACTING: f64 = 0.95;

impl Run {
    /// Lowers the limits that [`replan`](Self::replan) uses in the `cells` to `share` of what it uses now; of several
    /// shares the least counts.
    pub fn tighten(&mut self, cells: Range<usize>, share: f64) {
        for cell in &mut self.cells[cells] {
            cell.tighten(share);
        }
    }

    /// The same, because of `why`.
    pub(crate) fn tighten_for(&mut self, cells: Range<usize>, share: f64, why: Limited) {
        for cell in &mut self.cells[cells] {
            cell.tighten_for(share, why);
        }
    }

    /// Cells of which a part lies between two places.
    pub(crate) fn cells_between(&self, [from, to]: [PathPlace; 2]) -> Range<usize> {
        let key = |place: &PathPlace| (place.piece, place.p);
        let count = self.cells.len();
        let first = self.places[..count].partition_point(|place| key(place) <= key(&from));
        let last = self.places[..count].partition_point(|place| key(place) < key(&to));
        first.saturating_sub(1)..last.max(first)
    }

    /// Plans again with the limits as they are in the cells.
    pub fn replan(&mut self) {
        for cell in &mut self.cells {
            cell.apply_tightening();
        }
        controllable(&self.cells, 0.0, &mut self.squares);
        fastest(&self.cells, 0.0, &mut self.squares);
        if let Some(limits) = &self.jerk {
            jerk::limit(&self.cells, limits, &mut self.squares);
        }
        self.duration_s = duration(&self.cells, &self.squares);
    }

    /// Time over which the motion is a mean of a mean of the plan, s.
    pub(crate) fn mean_s(&self) -> f64 {
        self.jerk.as_ref().map_or(0.0, |jerk| jerk.cell_s)
    }

    /// Square of the pace at both ends of cell `index`, by its piece's parameter.
    pub(crate) fn ends_of(&self, index: usize) -> [f64; 2] {
        ends_of(&self.cells, &self.squares, index)
    }

    /// Duration of cell `index`.
    pub fn cell_duration_s(&self, index: usize) -> f64 {
        let [start, end] = self.ends_of(index);
        time_between(self.cells[index].length, start, end)
    }

    /// Rate of change of the pace in cell `index`, by its piece's parameter.
    pub fn acceleration(&self, index: usize) -> f64 {
        let [start, end] = self.ends_of(index);
        (end - start) / (2.0 * self.cells[index].length)
    }

    /// The limit that is nearest in cell `index`; where moves leave a part of all limits unused, what that is for.
    pub fn acting(&self, index: usize) -> Option<Limited> {
        self.cells[index]
            .lowered_for()
            .or_else(|| self.acting_jerk(index))
            .or_else(|| acting(&self.cells, &self.squares, index))
    }

    /// The limit of jerk that acts at an end of cell `index`, if one does.
    fn acting_jerk(&self, index: usize) -> Option<Limited> {
        let jerk = self.jerk.as_ref()?;
        let acceleration = |index: usize, motor: usize| {
            let [of_a, of_x] = jerk.turning[index][motor];
            let [y, z] = self.ends_of(index);
            of_a * self.acceleration(index) + of_x * 0.5 * (y + z)
        };
        let part = |mark: usize, motor: usize| {
            let (mut change, mut time, mut share) = (0.0, 0.0, 1.0f64);
            let ends = [(mark.checked_sub(1), -1.0), (Some(mark), 1.0)];
            for (cell, sign) in ends {
                if let Some(cell) = cell.filter(|cell| *cell < self.cells.len()) {
                    change += sign * acceleration(cell, motor);
                    time += 0.5 * self.cell_duration_s(cell);
                    share = share.min(self.cells[cell].share);
                }
            }
            change.abs() / (share * jerk.limits[motor] * time)
        };
        let acts = |motor: &usize| {
            let parts = [index, index + 1].map(|mark| part(mark, *motor));
            parts.iter().any(|part| *part > ACTING)
        };
        (0..3).find(acts).map(Limited::Jerk)
    }
}
