//! Linear programs in x at the two ends of a cell.
//!
//! Within a cell the acceleration a along the path is constant, so x is linear in p: y at the start of
//! the cell, z at its end, a = (z - y) / (2 length). A [`Row`] is then bounded over the whole cell by
//! inequalities linear in y and z. Each coefficient is c + s t, t from -1 to 1, to within its error e.
//! The quantity is largest at an end of the cell, but for the product s t of the coefficient of x with
//! the change of x, which adds at most |s| |z - y| / 2.

use crate::cell::{Cell, Limited, Row};
use crate::extreme::{greater, lesser};
use heapless::Vec;
use trirrr_core::number::Arithmetic;
use trirrr_service::admission::{Enclose, TaylorModel};

/// Most inequalities: for each row two signs, two ends, two signs of z - y; as many for power.
const INEQUALITIES: usize = 8 * (crate::cell::ROWS + 3);

/// start y + end z <= limit.
#[derive(Clone, Copy, Debug)]
struct Inequality<B> {
    start: B,
    end: B,
    limit: B,
    what: Limited,
}

/// Inequalities of one cell.
pub(crate) struct Program<B> {
    inequalities: Vec<Inequality<B>, INEQUALITIES>,
}

/// A bound of z: at_rest + slope y.
#[derive(Clone, Copy)]
struct EndBound<B> {
    at_rest: B,
    slope: B,
}

impl<B: Arithmetic> EndBound<B> {
    fn at(&self, y: B) -> B {
        self.at_rest + self.slope * y
    }
}

impl<B: Arithmetic> Program<B> {
    /// The limits of `cell` for x up to `greatest`. The power is bounded by that x; the root in a hold's
    /// share, by its tangent there. With 0, both are left out.
    pub(crate) fn of<N: Enclose<Bound = B>>(cell: &Cell<N>, greatest: B) -> Self {
        let mut program = Self {
            inequalities: Vec::new(),
        };
        for row in &cell.rows {
            program.add(row, cell, row.limit, greatest);
        }
        let root = greatest.sqrt();
        for power in &cell.powers {
            let limit = power.limit.div(power.rate * root);
            if greatest > B::ZERO && limit.is_finite() {
                program.add(&power.torque, cell, limit, greatest);
            }
        }
        program
    }

    fn add<N: Enclose<Bound = B>>(&mut self, row: &Row<N>, cell: &Cell<N>, limit: B, greatest: B) {
        let zero = B::ZERO;
        // sqrt(x) <= half_root (1 + x / greatest): a hold adds |acceleration| r sqrt(x).
        let half_root = B::HALF * cell.ramp * greatest.sqrt();
        let per_greatest = match greatest > zero {
            true => half_root.div(greatest),
            false => zero,
        };
        let signs: &[B] = match row.acceleration {
            Some(_) => &[B::ONE, -B::ONE],
            None => &[B::ONE],
        };
        let acceleration = row.acceleration.unwrap_or(TaylorModel::ZERO).line();
        let (square, rest) = (row.square.line(), row.rest.line());
        let per_length = B::HALF.div(cell.length);
        // What |z - y| adds at most: errors, and x at the other end.
        let change = acceleration.error * per_length
            + B::HALF * (square.slope.abs() + per_greatest * acceleration.slope.abs())
            + square.error;
        // Where x alone is limited, |z - y| is at most the greater of the two, which the limit bounds. A coefficient of z
        // that is tiny beside that of y would make noise of z.
        let part = change.div(square.constant - square.slope.abs());
        let is_level = row.acceleration.is_none() && part >= zero && part < B::ratio(1, 1 << 14);
        let (change, limit) = match is_level {
            true => (zero, limit - limit * (part + part)),
            false => (change, limit),
        };
        // Of the limit, what holds the pose is not for motion: a part of the rest can be left unused.
        let unused = (B::ONE - cell.share) * greater(limit - row.rest.magnitude(), zero);
        let limit = limit - unused;
        // The inequality itself is computed with a few roundings.
        let limit = limit - limit * (B::UNIT_ROUNDOFF * B::from_f64(64.0)) - rest.error;
        for &sign in signs {
            for end in [-B::ONE, B::ONE] {
                let slope = sign * acceleration.at(end) * per_length;
                let hold = acceleration.at(end).abs() + acceleration.error;
                let square = sign * square.at(end) + square.error + hold * per_greatest;
                let (at_start, at_end) = match end < zero {
                    true => (square, zero),
                    false => (zero, square),
                };
                let limit = limit - sign * rest.at(end) - hold * half_root;
                for change in [change, -change] {
                    let inequality = Inequality {
                        start: at_start - slope - change,
                        end: at_end + slope + change,
                        limit,
                        what: row.what,
                    };
                    // There is room for each.
                    let _ = self.inequalities.push(inequality);
                }
            }
        }
    }

    /// The quantity that is beyond its limit at rest.
    pub(crate) fn standing(&self) -> Option<Limited> {
        let broken = self
            .inequalities
            .iter()
            .find(|each| !(each.limit >= B::ZERO));
        broken.map(|each| each.what)
    }

    /// Least and greatest z for this `y`; the least is above the greatest where `y` is too large for every z.
    fn range(&self, y: B, z_cap: B) -> [EndBound<B>; 2] {
        let zero = B::ZERO;
        let flat = |at_rest| EndBound {
            at_rest,
            slope: zero,
        };
        let (mut least, mut greatest) = (flat(zero), flat(z_cap));
        for each in &self.inequalities {
            if each.end == zero {
                continue;
            }
            let bound = EndBound {
                at_rest: each.limit.div(each.end),
                slope: -each.start.div(each.end),
            };
            if each.end > zero {
                if bound.at(y) < greatest.at(y) {
                    greatest = bound;
                }
            } else if bound.at(y) > least.at(y) {
                least = bound;
            }
        }
        [least, greatest]
    }

    /// Greatest y, at most `y_cap`, from which some z from 0 to `z_cap` can be reached. It is 0 at least,
    /// given that the machine can stand in the cell.
    pub(crate) fn greatest_start(&self, y_cap: B, z_cap: B) -> B {
        let zero = B::ZERO;
        let mut y = y_cap;
        for each in &self.inequalities {
            if each.end == zero && each.start > zero {
                y = lesser(y, each.limit.div(each.start));
            }
        }
        // Newton's method on the gap, a concave function of y that is positive at 0: from the right it
        // falls towards the zero, exactly where the same two lines bound z.
        for _ in 0..64 {
            let [low, high] = self.range(y, z_cap);
            if high.at(y) >= low.at(y) {
                return y;
            }
            // Where the two lines meet, from their values at rest: y may be large beside it.
            let next = (high.at_rest - low.at_rest).div(low.slope - high.slope);
            if !(next < y) {
                return y;
            }
            if !(next > zero) {
                return zero;
            }
            y = next;
        }
        zero
    }

    /// Greatest z, at most `z_cap`, for this `y`; none if no z goes with it. If some z does for certain, the
    /// `certain` y may be the greatest there is, which rounding puts on the wrong side of its z.
    pub(crate) fn greatest_end(&self, y: B, z_cap: B, certain: bool) -> Option<B> {
        let [low, high] = self.range(y, z_cap);
        let (low, high) = (low.at(y), high.at(y));
        let fits = |each: &Inequality<B>| each.end != B::ZERO || each.start * y <= each.limit;
        let kept = certain || (low <= high && self.inequalities.iter().all(fits));
        kept.then_some(if high > low { high } else { low })
    }

    /// The quantity whose limit is nearest for the motion from `y` to `z`.
    pub(crate) fn acting(&self, y: B, z: B) -> Option<Limited> {
        let mut nearest: Option<(B, Limited)> = None;
        for each in &self.inequalities {
            let slack = (each.limit - (each.start * y + each.end * z)).div(each.limit);
            if nearest.is_none_or(|(least, _)| slack < least) {
                nearest = Some((slack, each.what));
            }
        }
        nearest.map(|(_, what)| what)
    }
}
