//! Plans of whole paths, with memory from the heap: grids, stops at corners, refinement.

use crate::bound::least_time;
use crate::cell::{Cell, Limited, Obstacle, Planner};
use crate::passes::{ObstacleAt, acting, controllable, duration, ends_of, fastest, time_between};
use crate::piece::Piece;
use core::ops::Range;
use nalgebra::Vector3;
use trirrr_core::model::Model;
use trirrr_core::setpoint::Pose;
use trirrr_service::admission::TaylorModel;

/// Accuracy of a plan and the work allowed for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Refine the grid until the plan takes at most this part more time than its lower bound.
    pub gap: f64,
    /// Most cells of the grid between two stops; the plan is what it is then.
    pub cells_max: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self {
            gap: 0.005,
            cells_max: 1 << 14,
        }
    }
}

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPlace {
    /// Index of the piece.
    pub piece: usize,
    /// Parameter of the piece, 0 to 1.
    pub p: f64,
}

/// A piece of a path with what goes for it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// The geometry.
    pub piece: Piece<f64>,
    /// Greatest speed of D, m/s, if it is limited.
    pub feed_m_s: Option<f64>,
    /// Number of the piece in the user's path, from 0.
    pub source: usize,
}

/// Refusal of a path: no motion along it keeps the limits, or none was found to be proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathRefusal {
    /// The first place found.
    pub place: PathPlace,
    /// Pose there.
    pub pose: Pose<f64>,
    /// The reason.
    pub obstacle: Obstacle,
}

impl PathRefusal {
    /// Refuses the path of `pieces` at `place`.
    pub(crate) fn at(place: PathPlace, pieces: &[PathPiece], obstacle: Obstacle) -> Self {
        Self {
            place,
            pose: pieces[place.piece].piece.at(place.p).pose,
            obstacle,
        }
    }
}

/// Plan of a stretch from rest to rest without a stop between.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its pieces.
    pub pieces: Range<usize>,
    /// Starts of its cells, and its end.
    pub places: Vec<PathPlace>,
    /// The cells.
    pub cells: Vec<Cell<f64>>,
    /// Square of the pace dp/dt at each place, by the parameter of the piece that begins or goes on there; the last
    /// one by the piece that ends.
    pub squares: Vec<f64>,
    /// Upper bound of the square of any motion's pace at each place.
    pub squares_max: Vec<f64>,
    /// Duration.
    pub duration_s: f64,
    /// Lower bound of the duration of any motion along the run.
    pub least_s: f64,
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

impl Run {
    /// Lowers the limits that [`replan`](Self::replan) uses in the `cells` to `share` of what it uses now; of several
    /// shares the least counts.
    pub fn tighten(&mut self, cells: Range<usize>, share: f64) {
        for cell in &mut self.cells[cells] {
            cell.tighten(share);
        }
    }

    /// Plans again with the limits as they are in the cells.
    ///
    /// # Errors
    /// The first place where the machine cannot stand, or the first where next to nothing is left of the limits.
    pub fn replan(&mut self, pieces: &[PathPiece]) -> Result<(), PathRefusal> {
        for (cell, place) in self.cells.iter_mut().zip(&self.places) {
            if cell.apply_tightening() < SHARE_LEAST {
                return Err(PathRefusal::at(*place, pieces, Obstacle::Refused));
            }
        }
        controllable(&self.cells, 0.0, &mut self.squares).map_err(
            |ObstacleAt { cell, obstacle }| PathRefusal::at(self.places[cell], pieces, obstacle),
        )?;
        fastest(&self.cells, 0.0, &mut self.squares);
        self.duration_s = duration(&self.cells, &self.squares);
        Ok(())
    }

    /// Duration of cell `index`.
    pub fn cell_duration_s(&self, index: usize) -> f64 {
        let [start, end] = ends_of(&self.cells, &self.squares, index);
        time_between(self.cells[index].length, start, end)
    }

    /// Rate of change of the pace in cell `index`, by its piece's parameter.
    pub fn acceleration(&self, index: usize) -> f64 {
        let [start, end] = ends_of(&self.cells, &self.squares, index);
        (end - start) / (2.0 * self.cells[index].length)
    }

    /// The limit that is nearest in cell `index`.
    pub fn acting(&self, index: usize) -> Option<Limited> {
        acting(&self.cells, &self.squares, index)
    }
}

/// Sine of the angle between two tangents above which the path has a corner. Rounding of a path's numbers stays
/// below it.
const CORNER: f64 = 1e-9;

/// Least part of the limits that moves are made with: a thousandth of the pace that the limits allow.
const SHARE_LEAST: f64 = 1e-6;

/// Halvings of a cell that does not pass.
const HALVINGS: u32 = 20;

/// Plans the path of `pieces`. The motion begins and ends at rest, and stops at corners.
///
/// # Errors
/// The first obstacle on the path.
pub fn plan<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    effort: Effort,
) -> Result<Plan, PathRefusal> {
    let mut runs = Vec::new();
    let mut first = 0;
    for next in 1..=pieces.len() {
        if next == pieces.len() || joint(&pieces[next - 1].piece, &pieces[next].piece).is_none() {
            runs.push(plan_run(planner, pieces, first..next, effort)?);
            first = next;
        }
    }
    Ok(Plan { runs })
}

/// Scale of x from the end of `before` to the start of `after`; none at a corner.
pub(crate) fn joint(before: &Piece<f64>, after: &Piece<f64>) -> Option<f64> {
    let (a, b) = (before.at(1.0).first, after.at(0.0).first);
    let (length_a, length_b) = (length(a), length(b));
    let scale = length_a / length_b;
    (length(a / length_a - b / length_b) <= CORNER).then_some(scale * scale)
}

/// Length of a tangent, with a metre counting as much as a radian.
fn length(v: Vector3<f64>) -> f64 {
    v.dot(&v).sqrt()
}

fn plan_run<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    range: Range<usize>,
    effort: Effort,
) -> Result<Run, PathRefusal> {
    let mut count = (8 * range.len()).max(64);
    loop {
        let mut run = plan_on_grid(planner, pieces, range.clone(), count)?;
        // The bound knows nothing of the reserve for holds: the two are compared without one.
        let near = run.duration_s <= run.least_s * (1.0 + effort.gap);
        if near || 2 * count > effort.cells_max {
            for cell in &mut run.cells {
                cell.reserve(planner.ramp());
            }
            run.replan(pieces)?;
            return Ok(run);
        }
        count *= 2;
    }
}

fn plan_on_grid<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    range: Range<usize>,
    count: usize,
) -> Result<Run, PathRefusal> {
    let (mut places, mut cells) = (Vec::new(), Vec::new());
    let mut side = None;
    for (piece, marks) in grid(pieces, &range, count) {
        let models = pieces[piece].piece.over::<TaylorModel<f64>>();
        let feed = pieces[piece].feed_m_s;
        let first = cells.len();
        for ends in marks.windows(2) {
            let mut measure = |ends| planner.measure(&models, ends, feed, &mut side);
            let ends = [ends[0], ends[1]];
            divide(&mut measure, ends, HALVINGS, &mut |from, cell| {
                places.push(PathPlace { piece, p: from });
                cells.push(cell);
            })
            .map_err(|(p, obstacle)| PathRefusal::at(PathPlace { piece, p }, pieces, obstacle))?;
        }
        if piece > range.start {
            let scale = joint(&pieces[piece - 1].piece, &pieces[piece].piece);
            cells[first].join(scale.unwrap_or(1.0));
        }
    }
    places.push(PathPlace {
        piece: range.end - 1,
        p: 1.0,
    });
    let (mut forward, mut backward) = (vec![0.0; places.len()], vec![0.0; places.len()]);
    let least_s = least_time(&cells, [0.0, 0.0], &mut forward, &mut backward);
    let mut run = Run {
        pieces: range,
        duration_s: 0.0,
        least_s,
        squares: vec![0.0; places.len()],
        places,
        cells,
        squares_max: forward
            .iter()
            .zip(&backward)
            .map(|(a, b)| a.min(*b))
            .collect(),
    };
    run.replan(pieces)?;
    Ok(run)
}

/// Marks on each piece of a run, about `count` cells in all: equally far apart, but nearer together towards the
/// ends at rest, where the pace changes most.
fn grid(pieces: &[PathPiece], range: &Range<usize>, count: usize) -> Vec<(usize, Vec<f64>)> {
    let sizes: Vec<f64> = pieces[range.clone()]
        .iter()
        .map(|each| each.piece.size(length))
        .collect();
    let total: f64 = sizes.iter().sum();
    let mut marks = Vec::new();
    let mut next = 1;
    let mut before = 0.0;
    for (piece, size) in range.clone().zip(sizes) {
        let end = before + size / total;
        let mut on_piece = vec![0.0];
        while next < count {
            let sin = (core::f64::consts::FRAC_PI_2 * next as f64 / count as f64).sin();
            let p = (sin * sin - before) / (end - before);
            if !(p < 1.0) {
                break;
            }
            // A sliver beside a joint would bound nothing better.
            if p > on_piece[on_piece.len() - 1] + 1e-9 && p < 1.0 - 1e-9 {
                on_piece.push(p);
            }
            next += 1;
        }
        on_piece.push(1.0);
        marks.push((piece, on_piece));
        before = end;
    }
    marks
}

/// Measures the cell from `ends`, or its halves where it does not pass.
fn divide(
    measure: &mut impl FnMut([f64; 2]) -> Result<Cell<f64>, Obstacle>,
    [from, to]: [f64; 2],
    halvings: u32,
    take: &mut impl FnMut(f64, Cell<f64>),
) -> Result<(), (f64, Obstacle)> {
    match measure([from, to]) {
        Ok(cell) => take(from, cell),
        Err(obstacle) if halvings == 0 => return Err((from, obstacle)),
        Err(_) => {
            let middle = 0.5 * (from + to);
            divide(measure, [from, middle], halvings - 1, take)?;
            divide(measure, [middle, to], halvings - 1, take)?;
        }
    }
    Ok(())
}
