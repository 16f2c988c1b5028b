//! Cells of a run: where they begin, and how they are divided.

use crate::bound::{Possible, least_time};
use crate::cell::{Cell, Measured, Obstacle, Planner};
use crate::passes::{controllable, duration, fastest};
use crate::path::{PathPiece, PathPlace, PathRefusal};
use crate::piece::{Piece, joint, length};
use crate::run::Run;
use core::ops::Range;
use trirrr_core::model::Model;
use trirrr_service::admission::TaylorModel;

/// Halvings of a cell that does not pass.
const HALVINGS: u32 = 20;

/// Measured cells of a run.
pub(crate) struct Grid<'a> {
    pieces: &'a [PathPiece],
    places: Vec<PathPlace>,
    cells: Vec<Cell<f64>>,
    possible: Vec<Possible<f64>>,
}

/// Measures cells on one piece after the other.
struct Measuring<'a, M: Model<N = f64>> {
    planner: &'a Planner<M>,
    pieces: &'a [PathPiece],
    easings: &'a [Easing],
    /// Sign of det A.
    side: Option<bool>,
    /// Bounds of any motion are asked for, too.
    bounded: bool,
    /// The piece that was measured last, in models.
    piece: Option<(usize, Piece<TaylorModel<f64>>)>,
}

/// A stretch of a piece beside another with a lower feed, which goes for it, too: the motion is a mean over both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Easing {
    pub(crate) piece: usize,
    /// p at its start and its end.
    pub(crate) ends: [f64; 2],
    feed_m_s: f64,
}

impl Easing {
    fn holds(&self, [from, to]: [f64; 2]) -> bool {
        self.ends[0] <= from && to <= self.ends[1]
    }
}

/// The easings of `run`, of which the motion is a mean over `window_s` at most.
pub(crate) fn easings(run: &Run, pieces: &[PathPiece], window_s: f64) -> Vec<Easing> {
    let feed = |piece: usize| pieces[piece].feed_m_s.unwrap_or(f64::INFINITY);
    let mut easings = Vec::new();
    for piece in run.pieces.clone() {
        let before = piece
            .checked_sub(1)
            .filter(|before| run.pieces.contains(before));
        let after = Some(piece + 1).filter(|after| run.pieces.contains(after));
        for (other, p) in [(before, 0.0), (after, 1.0)] {
            let slow = other.map_or(f64::INFINITY, feed);
            let way = pieces[piece].piece.at(p).first;
            let part = slow * window_s / libm::hypot(way.x, way.y);
            if slow < feed(piece) && part > 0.0 {
                let part = part.min(1.0);
                easings.push(Easing {
                    piece,
                    ends: if p == 0.0 {
                        [0.0, part]
                    } else {
                        [1.0 - part, 1.0]
                    },
                    feed_m_s: slow,
                });
            }
        }
    }
    easings
}

impl<M: Model<N = f64>> Measuring<'_, M> {
    /// Measures the stretch from `ends` of piece `index`.
    fn cell(&mut self, index: usize, ends: [f64; 2]) -> Result<Measured<f64>, Obstacle> {
        let piece = match self.piece {
            Some((last, piece)) if last == index => piece,
            _ => self.pieces[index].piece.models(),
        };
        self.piece = Some((index, piece));
        let first = self.easings.partition_point(|easing| easing.piece < index);
        let of_piece = self.easings[first..]
            .iter()
            .take_while(|easing| easing.piece == index);
        let eased = of_piece.filter(|easing| easing.holds(ends));
        let feeds = eased.map(|easing| easing.feed_m_s);
        let feed = feeds.chain(self.pieces[index].feed_m_s).reduce(f64::min);
        self.planner.measure(&piece, ends, feed, &mut self.side)
    }
}

impl<'a> Grid<'a> {
    /// Measures the first cells of `range`: one for each piece, or about `count` of few pieces. Only a `bounded` grid can
    /// be [planned](Self::plan).
    pub(crate) fn measure<M: Model<N = f64>>(
        planner: &Planner<M>,
        pieces: &'a [PathPiece],
        range: Range<usize>,
        count: usize,
        bounded: bool,
    ) -> Result<Self, PathRefusal> {
        Self::between(planner, pieces, marks(pieces, &range, count), bounded)
    }

    /// Measures the cells between the marks on each piece of a run; `bounded` as in [`measure`](Self::measure).
    pub(crate) fn between<M: Model<N = f64>>(
        planner: &Planner<M>,
        pieces: &'a [PathPiece],
        marks: Vec<(usize, Vec<f64>)>,
        bounded: bool,
    ) -> Result<Self, PathRefusal> {
        let mut grid = Self::empty(pieces, 0);
        let mut measuring = Measuring {
            planner,
            pieces,
            easings: &[],
            side: None,
            bounded,
            piece: None,
        };
        let mut last = None;
        for (piece, marks) in marks {
            let first = grid.cells.len();
            for ends in marks.windows(2) {
                grid.divide(&mut measuring, piece, [ends[0], ends[1]], HALVINGS)?;
            }
            if last.replace(piece).is_some() {
                let scale = joint(&pieces[piece - 1].piece, &pieces[piece].piece);
                grid.cells[first].join(scale.unwrap_or(1.0));
            }
        }
        grid.end(last.unwrap_or(0));
        Ok(grid)
    }

    fn empty(pieces: &'a [PathPiece], count: usize) -> Self {
        Self {
            pieces,
            places: Vec::with_capacity(count + 1),
            cells: Vec::with_capacity(count),
            possible: Vec::with_capacity(count),
        }
    }

    fn end(&mut self, piece: usize) {
        self.places.push(PathPlace { piece, p: 1.0 });
    }

    /// The grid of `run` with each cell cut at its `cuts`, values of p in order. Cells without one are not measured again.
    pub(crate) fn split<M: Model<N = f64>>(
        planner: &Planner<M>,
        pieces: &'a [PathPiece],
        run: Run,
        cuts: &[Vec<f64>],
        easings: &[Easing],
    ) -> Result<Self, PathRefusal> {
        let count = cuts.iter().map(|cuts| cuts.len() + 1).sum();
        let mut grid = Self::empty(pieces, count);
        let mut measuring = Measuring {
            planner,
            pieces,
            easings,
            side: None,
            bounded: true,
            piece: None,
        };
        let cells = run.cells.into_iter().zip(run.possible);
        for (((cell, possible), place), cuts) in cells.zip(&run.places).zip(cuts) {
            if cuts.is_empty() {
                grid.places.push(*place);
                grid.cells.push(cell);
                grid.possible.push(possible);
                continue;
            }
            let first = grid.cells.len();
            let mut from = place.p;
            for &to in cuts.iter().chain(&[place.p + cell.length()]) {
                grid.divide(&mut measuring, place.piece, [from, to], HALVINGS)?;
                from = to;
            }
            for part in &mut grid.cells[first..] {
                part.limit_as(&cell);
            }
            grid.cells[first].join(cell.joint);
        }
        grid.end(run.pieces.end - 1);
        Ok(grid)
    }

    /// Measures the cell from `ends`, or its halves where it does not pass.
    fn divide<M: Model<N = f64>>(
        &mut self,
        measuring: &mut Measuring<'_, M>,
        piece: usize,
        [from, to]: [f64; 2],
        halvings: u32,
    ) -> Result<(), PathRefusal> {
        let place = PathPlace { piece, p: from };
        match measuring.cell(piece, [from, to]) {
            Ok(measured) => {
                self.places.push(place);
                let mut cell = measured.cell();
                cell.is_paced = measuring.planner.is_paced();
                self.cells.push(cell);
                if measuring.bounded {
                    self.possible.push(measured.possible());
                }
            }
            Err(obstacle) if halvings == 0 => {
                return Err(PathRefusal::at(place, self.pieces, obstacle));
            }
            Err(_) => {
                let middle = 0.5 * (from + to);
                self.divide(measuring, piece, [from, middle], halvings - 1)?;
                self.divide(measuring, piece, [middle, to], halvings - 1)?;
            }
        }
        Ok(())
    }

    /// Estimates the duration of the plan with room for holds at the rate `ramp`.
    pub(crate) fn estimate(mut self, ramp: f64) -> f64 {
        for cell in &mut self.cells {
            cell.flatten();
            cell.reserve(ramp);
        }
        let mut squares = vec![0.0; self.places.len()];
        controllable(&self.cells, 0.0, &mut squares);
        fastest(&self.cells, 0.0, &mut squares);
        duration(&self.cells, &squares)
    }

    /// The plan on this grid, and a lower bound of the time in each cell.
    pub(crate) fn plan(self, pieces: Range<usize>) -> (Run, Vec<f64>) {
        let Self {
            places,
            cells,
            possible,
            ..
        } = self;
        let (mut times, mut squares_max) = (vec![0.0; places.len()], vec![0.0; places.len()]);
        let least_s = least_time(&cells, &possible, [0.0, 0.0], &mut times, &mut squares_max);
        let mut run = Run {
            pieces,
            jerk: None,
            duration_s: 0.0,
            least_s,
            squares: vec![0.0; places.len()],
            places,
            cells,
            possible,
            squares_max,
        };
        run.replan();
        (run, times)
    }
}

/// Marks on each piece of a run, about `count` cells in all: equally far apart, but nearer together towards the
/// ends at rest, where the pace changes most.
fn marks(pieces: &[PathPiece], range: &Range<usize>, count: usize) -> Vec<(usize, Vec<f64>)> {
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
            let sin = libm::sin(core::f64::consts::FRAC_PI_2 * next as f64 / count as f64);
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
