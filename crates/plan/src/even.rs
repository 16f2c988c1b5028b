//! The plan within limits of jerk, on cells that take equally long.

use crate::cell::Planner;
use crate::grid::Grid;
use crate::jerk::JerkLimits;
use crate::path::{PathPiece, PathRefusal};
use crate::run::Run;
use trirrr_core::model::Model;

/// Longest cell, s: as long as the time over which the motion is a mean of the plan.
const CELL_S: f64 = 0.003;

/// Fewest cells of a run.
const CELLS_MIN: f64 = 32.0;

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
