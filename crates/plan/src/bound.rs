//! A lower bound of the time that any motion takes along the path within the limits.
//!
//! In a cell, with t from -1 to 1 and every coefficient somewhere in its Taylor model, a row of limits
//! says a <= P(t) - Q(t) x or a >= P(t) - Q(t) x. As dx/dt = length a, a quadratic in t whose slope is
//! nowhere below that bound stays above every motion that begins below it (comparison of ordinary
//! differential equations). Two rows with a <= P - Q x and a >= P' - Q' x leave x <= (P - P') / (Q - Q').
//! Both hold for every motion, not only for those with constant acceleration in a cell.

use crate::cell::{Cell, Row};
use crate::extreme::{greater, lesser, unbounded};
use crate::passes::{next_joint, time_between};
use heapless::Vec;
use trirrr_core::number::Arithmetic;
use trirrr_service::admission::{Enclose, ModelLine, TaylorModel};

/// Most rows with an acceleration.
const ROWS: usize = 6;

/// a <= limit - square x, or a >= that.
#[derive(Clone, Copy)]
struct Side<N: Enclose> {
    limit: TaylorModel<N>,
    square: TaylorModel<N>,
}

/// What a cell leaves possible.
struct Possible<N: Enclose> {
    above: Vec<Side<N>, ROWS>,
    below: Vec<Side<N>, ROWS>,
}

/// A line above x in a cell, by its values at both ends, and a bulge by which x may exceed it in between.
#[derive(Clone, Copy)]
struct Above<B> {
    start: B,
    end: B,
    bulge: B,
}

impl<B: Arithmetic> Above<B> {
    /// Least time over the cell.
    fn time(&self, length: B) -> B {
        let shifted = time_between(length, self.start + self.bulge, self.end + self.bulge);
        // The bulge b (1 - t^2) lies below the lines 2 b (1 + t) and 2 b (1 - t).
        let four = (self.bulge + self.bulge) + (self.bulge + self.bulge);
        let from_start = time_between(length, self.start, self.end + four);
        let to_end = time_between(length, self.start + four, self.end);
        greater(shifted, greater(from_start, to_end))
    }

    fn mirrored(self) -> Self {
        Self {
            start: self.end,
            end: self.start,
            ..self
        }
    }
}

/// Returns a lower bound of the time of any motion through `cells` that begins with x <= `start` and ends with
/// x <= `end`. `forward` and `backward` are room for one value more than there are cells; they are left with upper
/// bounds of x at each place, from before and from behind.
pub fn least_time<N: Enclose>(
    cells: &[Cell<N>],
    [start, end]: [N::Bound; 2],
    forward: &mut [N::Bound],
    backward: &mut [N::Bound],
) -> N::Bound {
    let count = cells.len();
    forward[0] = start;
    for (index, cell) in cells.iter().enumerate() {
        let possible = Possible::of(cell);
        let joint = next_joint(cells, index);
        let cap = possible.cap(cell);
        let x = lesser(forward[index], cap.start);
        forward[index] = x;
        let reached = possible
            .from(x, cell.length)
            .map_or(cap.end, |above| above.end);
        forward[index + 1] = lesser(reached, cap.end) * joint;
    }
    forward[count] = lesser(forward[count], end);
    backward[count] = forward[count];
    let mut total = N::Bound::ZERO;
    for (index, cell) in cells.iter().enumerate().rev() {
        let possible = Possible::of(cell);
        let joint = next_joint(cells, index);
        let cap = possible.cap(cell);
        let after = lesser(
            lesser(backward[index + 1], forward[index + 1]).div(joint),
            cap.end,
        );
        let to = possible.to(after, cell.length);
        backward[index] = lesser(to.map_or(cap.start, |above| above.start), cap.start);
        let before = lesser(backward[index], forward[index]);
        let mut time = cap.time(cell.length);
        for above in [possible.from(before, cell.length), to]
            .into_iter()
            .flatten()
        {
            time = greater(time, above.time(cell.length));
        }
        total += time;
    }
    total - total * (N::Bound::UNIT_ROUNDOFF * N::Bound::from_f64(8.0 * count as f64))
}

impl<N: Enclose> Possible<N> {
    fn of(cell: &Cell<N>) -> Self {
        let mut possible = Self {
            above: Vec::new(),
            below: Vec::new(),
        };
        for row in &cell.rows {
            possible.add(row);
        }
        possible
    }

    /// A row whose coefficient of a may vanish in the cell bounds no a.
    fn add(&mut self, row: &Row<N>) {
        let Some(coefficient) = row.acceleration else {
            return;
        };
        let limit = TaylorModel::point(row.limit);
        let inverse = TaylorModel::ONE.div(coefficient);
        let square = row.square * inverse;
        let side = |limit: TaylorModel<N>| Side {
            limit: (limit - row.rest) * inverse,
            square,
        };
        let (most, least) = (side(limit), side(-limit));
        let (above, below) = if coefficient > TaylorModel::ZERO {
            (most, least)
        } else if coefficient < TaylorModel::ZERO {
            (least, most)
        } else {
            return;
        };
        // There is room for each.
        let _ = self.above.push(above);
        let _ = self.below.push(below);
    }

    /// A line above every x that some a keeps within the limits.
    fn cap(&self, cell: &Cell<N>) -> Above<N::Bound> {
        let zero = N::Bound::ZERO;
        let far = unbounded();
        let mut cap = Above {
            start: far,
            end: far,
            bulge: zero,
        };
        let mut fastest = time_between(cell.length, far, far);
        let mut lower = |bound: TaylorModel<N>| {
            let line = bound.line();
            let (start, end) = (line.at(-N::Bound::ONE), line.at(N::Bound::ONE));
            let above = Above {
                start: greater(start + line.error, zero),
                end: greater(end + line.error, zero),
                bulge: zero,
            };
            let time = above.time(cell.length);
            if time > fastest {
                fastest = time;
                cap = above;
            }
        };
        for row in &cell.rows {
            if row.acceleration.is_none() {
                let bound = TaylorModel::point(row.limit).div(row.square);
                if bound.is_finite() {
                    lower(bound);
                }
            }
        }
        for above in &self.above {
            for below in &self.below {
                let square = above.square - below.square;
                if square > TaylorModel::ZERO {
                    lower((above.limit - below.limit).div(square));
                }
            }
        }
        cap
    }

    /// The least of the curves above all motions from x <= `start`.
    fn from(&self, start: N::Bound, length: N::Bound) -> Option<Above<N::Bound>> {
        let curves = self
            .above
            .iter()
            .map(|side| curve(start, length, side.limit.line(), side.square.line()));
        lowest(curves)
    }

    /// The least of the curves above all motions to x <= `end`: those of the time that runs backwards.
    fn to(&self, end: N::Bound, length: N::Bound) -> Option<Above<N::Bound>> {
        let curves = self.below.iter().map(|side| {
            let (limit, square) = (side.limit.line(), side.square.line());
            let limit = ModelLine {
                constant: -limit.constant,
                ..limit
            };
            let square = ModelLine {
                constant: -square.constant,
                ..square
            };
            curve(end, length, limit, square).map(Above::mirrored)
        });
        lowest(curves)
    }
}

fn lowest<B: Arithmetic>(curves: impl Iterator<Item = Option<Above<B>>>) -> Option<Above<B>> {
    let higher = |a: Above<B>, b: Above<B>| {
        if b.start + b.end < a.start + a.end {
            b
        } else {
            a
        }
    };
    curves.flatten().reduce(higher)
}

/// A curve above every x with x(-1) <= `start` and dx/dt <= `length` (P(t) - Q(t) x): with d the rise over the cell,
///
/// ```text
/// X(t) = start + (1 + t) d / 2 + c (t^2 - 1),   2 c = length (P1 - Q1 start) - q d / 2,   q = length Q0
/// ```
///
/// makes dX/dt - length (P - Q X) free of the linear term. The rest is not negative for the d returned. None where
/// the cell is too long for this to hold.
fn curve<B: Arithmetic>(
    start: B,
    length: B,
    limit: ModelLine<B>,
    square: ModelLine<B>,
) -> Option<Above<B>> {
    let half = B::HALF;
    let q = length * square.constant;
    if !(q.abs() < half) {
        return None;
    }
    // The first estimate leaves out what is of the second order.
    let base = length * (limit.constant + limit.error - square.constant * start);
    let rise = (base + base).div(B::ONE + q);
    let linear = length * (limit.slope - square.slope * start);
    // Twice the rise bounds the rise with all terms; checked below.
    let reach = rise.abs() + rise.abs() + length * (limit.slope.abs() + limit.error);
    let bulge = half * (linear.abs() + half * q.abs() * reach);
    let spread = reach + bulge;
    let rest =
        q.abs() * bulge + length * (square.slope.abs() * spread + square.error * (start + spread));
    let rise = (base + base + rest + rest).div(B::ONE + q);
    let rise = rise + (rise.abs() + reach) * (B::UNIT_ROUNDOFF * B::from_f64(16.0));
    if !(rise.abs() <= reach) {
        return None;
    }
    Some(Above {
        start,
        end: greater(start + rise, B::ZERO),
        bulge,
    })
}
