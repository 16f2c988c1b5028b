//! The plan within limits of jerk.
//!
//! The passes find the fastest motion whose acceleration may jump. Here it is made slower until the acceleration of each
//! motor changes from the middle of a cell to the middle of the next by no more than the limit of jerk allows in the time
//! between. With x at the marks as unknowns the time is convex and the limits of the passes are linear. The time between
//! two middles is convex in x: what it allows is no convex set, and the motion found is the fastest nearby.
//!
//! An interior-point method from a motion that is slow everywhere: steps of Newton's method on the time less a barrier of
//! each limit. Each limit concerns three marks at most, so the matrix has five diagonals.

mod band;
mod problem;
mod slack;
#[cfg(test)]
mod tests;

pub(crate) use problem::limit;

use crate::cell::Planner;
use crate::course::{PathPiece, PathPlace, PathRefusal, Run};
use crate::grid::Grid;
use crate::passes::ends_of;
use crate::rows::{Cell, Limited};
use trirrr_core::model::Model;

/// Acceleration of the three motors in the middle of a cell, as coefficients of a and x.
pub(crate) type Turning = [[f64; 2]; 3];

/// Limits of jerk over the cells of a run.
#[derive(Clone, Debug)]
pub(crate) struct JerkLimits {
    /// rad/s^3.
    pub(crate) limits: [f64; 3],
    /// For each cell.
    pub(crate) turning: Vec<Turning>,
    /// Jump of the accelerations at the start of each cell where pieces join, as a coefficient of x.
    pub(crate) jumps: Vec<[f64; 3]>,
    /// Time over which moves spread such a jump, s.
    pub(crate) step_s: f64,
    /// Time over which the motion is a mean of the plan, s: about that of a cell.
    pub(crate) cell_s: f64,
}

/// Longest cell, s: as long as the time over which the motion is a mean of the plan.
const CELL_S: f64 = 0.003;

/// Fewest cells of a run.
const CELLS_MIN: f64 = 32.0;

/// Part of the limits that a plan uses; the rest is for what moves differ from it.
const SHARE: f64 = 0.97;

/// Most grids on which the cells become short in the time of the motion that keeps the limits.
const GRIDS: u32 = 8;

/// Part by which a cell may take longer than the others.
const LONGER: f64 = 0.2;

/// The plan `run` within the limits of jerk, on cells that take equally long. Moves spread a jump where pieces
/// join over steps of `step_s`.
///
/// # Errors
/// An obstacle that is found in such a cell.
pub(crate) fn refined<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    run: &Run,
    step_s: f64,
) -> Result<Run, PathRefusal> {
    let mut refined = run.clone();
    for _ in 0..GRIDS {
        let cell_s = CELL_S.min(refined.duration_s / CELLS_MIN);
        let grid = Grid::between(planner, pieces, marks(&refined, cell_s), true)?;
        (refined, _) = grid.plan(run.pieces.clone());
        for cell in &mut refined.cells {
            cell.reserve(planner.ramp());
        }
        let (cells, places) = (&refined.cells, &refined.places);
        refined.jerk = JerkLimits::of(planner, pieces, cells, places, [cell_s, step_s]);
        refined.replan();
        let long = |index| refined.cell_duration_s(index) > (1.0 + LONGER) * cell_s;
        if !(0..refined.cells.len()).any(long) {
            break;
        }
    }
    // Finer cells may bound more.
    refined.least_s = refined.least_s.max(run.least_s);
    Ok(refined)
}

/// Part of a limit from which on it acts.
const ACTING: f64 = 0.95;

impl JerkLimits {
    /// The limit of jerk that acts at an end of cell `index` of `run`, if one does.
    pub(crate) fn acting(&self, run: &Run, index: usize) -> Option<Limited> {
        let acceleration = |index: usize, motor: usize| {
            let [of_a, of_x] = self.turning[index][motor];
            let [y, z] = ends_of(&run.cells, &run.squares, index);
            of_a * run.acceleration(index) + of_x * 0.5 * (y + z)
        };
        let part = |mark: usize, motor: usize| {
            let (mut change, mut time, mut share) = (0.0, 0.0, 1.0f64);
            let ends = [(mark.checked_sub(1), -1.0), (Some(mark), 1.0)];
            for (cell, sign) in ends {
                if let Some(cell) = cell.filter(|cell| *cell < run.cells.len()) {
                    change += sign * acceleration(cell, motor);
                    time += 0.5 * run.cell_duration_s(cell);
                    share = share.min(run.cells[cell].share);
                }
            }
            change.abs() / (share * self.limits[motor] * time)
        };
        let acts = |motor: &usize| {
            let parts = [index, index + 1].map(|mark| part(mark, *motor));
            parts.iter().any(|part| *part > ACTING)
        };
        (0..3).find(acts).map(Limited::Jerk)
    }
}

/// Marks on each piece of `run`, evenly in its time and no more than `cell_s` apart.
fn marks(run: &Run, cell_s: f64) -> Vec<(usize, Vec<f64>)> {
    let cell = |index: &usize| run.places[*index].piece;
    let cells: Vec<usize> = (0..run.cells.len()).collect();
    let on_piece = |cells: &[usize]| {
        let durations = cells.iter().map(|&index| run.cell_duration_s(index));
        let total: f64 = durations.sum();
        let count = (total / cell_s).ceil().max(1.0);
        let step_s = total / count;
        let mut marks = vec![0.0];
        let mut before = 0.0;
        for &index in cells {
            let duration = run.cell_duration_s(index);
            let (pace, acceleration) = (run.squares[index].sqrt(), run.acceleration(index));
            while marks.len() < count as usize && marks.len() as f64 * step_s <= before + duration {
                let t = marks.len() as f64 * step_s - before;
                marks.push(run.places[index].p + (pace + 0.5 * acceleration * t) * t);
            }
            before += duration;
        }
        marks.push(1.0);
        (cell(&cells[0]), marks)
    };
    cells
        .chunk_by(|a, b| cell(a) == cell(b))
        .map(on_piece)
        .collect()
}

impl JerkLimits {
    /// The limits of `planner` over `cells` that begin at `places`; none where it has none.
    pub(crate) fn of<M: Model<N = f64>>(
        planner: &Planner<M>,
        pieces: &[PathPiece],
        cells: &[Cell<f64>],
        places: &[PathPlace],
        [cell_s, step_s]: [f64; 2],
    ) -> Option<Self> {
        let limits = planner.jerk()?.map(|limit| SHARE * limit);
        let at = |piece: usize, p: f64| planner.turning(&pieces[piece].piece.models(), p);
        let turning =
            |(cell, place): (&Cell<f64>, &PathPlace)| at(place.piece, place.p + 0.5 * cell.length);
        let turning: Option<_> = cells.iter().zip(places).map(turning).collect();
        let jump = |index: usize| {
            let place = places[index];
            if index == 0 || places[index - 1].piece == place.piece {
                return Some([0.0; 3]);
            }
            let [before, after] = [at(place.piece - 1, 1.0)?, at(place.piece, place.p)?];
            let jump = |motor: usize| after[motor][1] - before[motor][1] / cells[index].joint;
            Some([jump(0), jump(1), jump(2)])
        };
        let jumps: Option<_> = (0..cells.len()).map(jump).collect();
        Some(Self {
            limits,
            turning: turning?,
            jumps: jumps?,
            cell_s,
            step_s,
        })
    }
}
