//! Plans of whole paths, with memory from the heap: grids, stops at corners, refinement.

pub use crate::path::{PathPiece, PathPlace, PathRefusal};
pub use crate::run::Run;

use crate::cell::Planner;
use crate::grid::Grid;
use core::ops::Range;
use trirrr_core::model::Model;

/// Accuracy of a plan and the work allowed for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Refine the grid until the plan takes at most this part more time than its lower bound.
    pub gap: f64,
    /// Most cells of the grid between two stops, or 32 for each piece if that is more; the plan is what it is then.
    pub cells_max: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self {
            gap: 0.002,
            cells_max: 1 << 14,
        }
    }
}

/// Plan of a path: its runs, one after the other.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The runs.
    pub runs: Vec<Run>,
}

impl Plan {
    /// Duration of all runs.
    pub fn duration_s(&self) -> f64 {
        self.runs.iter().map(|run| run.duration_s).sum()
    }

    /// Lower bound of the duration of any motion that stops where the runs end.
    pub fn least_s(&self) -> f64 {
        self.runs.iter().map(|run| run.least_s).sum()
    }
}

/// Cells of the first grid of a run, if it has few pieces.
const CELLS: usize = 16;
/// Most cells for each piece, where these are more than [`Effort::cells_max`].
const CELLS_PER_PIECE_MAX: usize = 32;
/// Most parts of a cell from one grid to the next.
const PARTS_MAX: f64 = 8.0;
/// Part of the allowed gap that a new grid is made for.
const SAFETY: f64 = 0.8;
/// Part of a gap above which a finer grid has not lowered it.
const PROGRESS: f64 = 0.7;

/// Plans the path of `pieces`. The motion begins and ends at rest, and stops at corners.
///
/// # Errors
/// The first obstacle on the path.
pub fn plan<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    effort: Effort,
) -> Result<Plan, PathRefusal> {
    let plan = |range| plan_run(planner, pieces, range, effort);
    let runs: Result<_, _> = ranges(pieces).into_iter().map(plan).collect();
    Ok(Plan { runs: runs? })
}

/// Estimates the duration of [`plan`] on coarse grids of about so many `cells` for each run. That a limit is kept is not proven; that the machine can stand
/// anywhere on the path is.
///
/// # Errors
/// The first obstacle on the path.
pub(crate) fn estimate<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    cells: usize,
) -> Result<f64, PathRefusal> {
    let mut duration_s = 0.0;
    for range in ranges(pieces) {
        duration_s += Grid::measure(planner, pieces, range, cells, false)?.estimate(planner.ramp());
    }
    Ok(duration_s)
}

/// Pieces from stop to stop.
fn ranges(pieces: &[PathPiece]) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut first = 0;
    for next in 1..=pieces.len() {
        if next == pieces.len() || pieces[next].joint(&pieces[next - 1]).is_none() {
            ranges.push(first..next);
            first = next;
        }
    }
    ranges
}

/// Parts into which cells with these `gaps` are divided so that all gaps together become `allowed` with the fewest
/// cells: a gap goes with the square of a cell's length.
fn parts(gaps: Vec<f64>, allowed: f64) -> Vec<usize> {
    let roots: Vec<f64> = gaps
        .into_iter()
        .map(|gap| libm::cbrt(gap.max(0.0)))
        .collect();
    let scale = (roots.iter().sum::<f64>() / allowed).sqrt();
    let parts = |root: f64| (root * scale).ceil().clamp(1.0, PARTS_MAX) as usize;
    roots.into_iter().map(parts).collect()
}

/// Plans the run of `range` on grids that grow where plan and bound differ.
fn plan_run<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    range: Range<usize>,
    effort: Effort,
) -> Result<Run, PathRefusal> {
    let mut grid = Grid::measure(planner, pieces, range.clone(), CELLS, true)?;
    let cells_max = effort.cells_max.max(CELLS_PER_PIECE_MAX * range.len());
    let mut gap_before = f64::INFINITY;
    loop {
        let (mut run, times) = grid.plan(range.clone());
        // The bound knows nothing of the reserve for holds: the two are compared without one.
        let allowed = effort.gap * run.least_s;
        let gap = run.duration_s - run.least_s;
        let count = run.cells.len();
        // What the bound leaves out, as the power, no grid mends.
        let stuck = gap > PROGRESS * gap_before;
        if gap <= allowed || 2 * count > cells_max || stuck {
            for cell in &mut run.cells {
                cell.reserve(planner.ramp());
            }
            run.replan();
            return Ok(run);
        }
        gap_before = gap;
        let gaps = times
            .iter()
            .zip(0..count)
            .map(|(least, index)| run.cell_duration_s(index) - least);
        let parts = parts(gaps.collect(), SAFETY * allowed);
        let cuts = |(index, parts): (usize, usize)| {
            let (from, length) = (run.places[index].p, run.cells[index].length());
            let cut = |part: usize| from + length * (part as f64 / parts as f64);
            (1..parts).map(cut).collect()
        };
        let cuts: Vec<Vec<f64>> = parts.into_iter().enumerate().map(cuts).collect();
        grid = Grid::split(planner, pieces, run, &cuts, &[])?;
    }
}
