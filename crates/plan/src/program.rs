//! Linear programs in x at the two ends of a cell.
//!
//! Within a cell the acceleration a along the path is constant, so x is linear in p: y at the start of
//! the cell, z at its end, a = (z - y) / (2 length). A [`Row`] is then bounded over the whole cell by
//! inequalities linear in y and z. Each coefficient is c + s t, t from -1 to 1, to within its error e.
//! The quantity is largest at an end of the cell, but for the product s t of the coefficient of x with
//! the change of x, which adds at most |s| |z - y| / 2.

use crate::cell::{Cell, Limited};
use crate::extreme::{greater, lesser, unbounded};
use crate::rows::{ROWS, Row};
use heapless::Vec;
use trirrr_core::number::Arithmetic;
use trirrr_service::admission::ModelLine;

/// Most inequalities: for each row two signs, two ends, two signs of z - y; as many for power.
const INEQUALITIES: usize = 8 * (ROWS + 3);

/// start y + end z <= limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inequality<B> {
    pub(crate) start: B,
    pub(crate) end: B,
    pub(crate) limit: B,
}

/// Inequalities of one cell, solved for z.
pub(crate) struct Program<B> {
    least: Vec<EndBound<B>, INEQUALITIES>,
    greatest: Vec<EndBound<B>, INEQUALITIES>,
    /// Greatest y of the inequalities without z.
    start_cap: B,
    /// Rest is within the limits.
    stands: bool,
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
    pub(crate) fn of(cell: &Cell<B>, greatest: B) -> Self {
        let mut program = Self {
            least: Vec::new(),
            greatest: Vec::new(),
            start_cap: unbounded(),
            stands: true,
        };
        inequalities(cell, greatest, |each, _| program.add(each));
        program
    }

    /// There is room for each.
    fn add(&mut self, each: Inequality<B>) {
        self.stands &= each.limit >= B::ZERO;
        if each.end == B::ZERO {
            if each.start > B::ZERO {
                self.start_cap = lesser(self.start_cap, each.limit.div(each.start));
            }
            return;
        }
        let inverse = B::ONE.div(each.end);
        let bound = EndBound {
            at_rest: each.limit * inverse,
            slope: -(each.start * inverse),
        };
        let _ = match each.end > B::ZERO {
            true => self.greatest.push(bound),
            false => self.least.push(bound),
        };
    }

    /// Returns true if rest is within the limits.
    pub(crate) fn stands(&self) -> bool {
        self.stands
    }

    /// Least and greatest z for this `y`; the least is above the greatest where `y` is too large for every z.
    fn range(&self, y: B, z_cap: B) -> [EndBound<B>; 2] {
        let zero = B::ZERO;
        let flat = |at_rest| EndBound {
            at_rest,
            slope: zero,
        };
        let (mut least, mut low) = (flat(zero), zero);
        for bound in &self.least {
            let z = bound.at(y);
            if z > low {
                (least, low) = (*bound, z);
            }
        }
        let (mut greatest, mut high) = (flat(z_cap), z_cap);
        for bound in &self.greatest {
            let z = bound.at(y);
            if z < high {
                (greatest, high) = (*bound, z);
            }
        }
        [least, greatest]
    }

    /// Greatest y, at most `y_cap`, from which some z from 0 to `z_cap` can be reached. It is 0 at least,
    /// given that the machine can stand in the cell.
    pub(crate) fn greatest_start(&self, y_cap: B, z_cap: B) -> B {
        let zero = B::ZERO;
        let mut y = lesser(y_cap, self.start_cap);
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
        let kept = certain || (low <= high && y <= self.start_cap);
        kept.then_some(if high > low { high } else { low })
    }
}

/// The quantity whose limit is nearest for the motion through `cell` from `y` to `z`.
pub(crate) fn acting<B: Arithmetic>(cell: &Cell<B>, y: B, z: B) -> Option<Limited> {
    let mut nearest: Option<(B, Limited)> = None;
    inequalities(cell, greater(y, z), |each, what| {
        let slack = (each.limit - (each.start * y + each.end * z)).div(each.limit);
        if nearest.is_none_or(|(least, _)| slack < least) {
            nearest = Some((slack, what));
        }
    });
    nearest.map(|(_, what)| what)
}

/// Hands each inequality of `cell` to `take`, for x up to `greatest`.
pub(crate) fn inequalities<B: Arithmetic>(
    cell: &Cell<B>,
    greatest: B,
    mut take: impl FnMut(Inequality<B>, Limited),
) {
    for row in &cell.limits.rows {
        of_row(row, cell, row.limit, greatest, &mut take);
    }
    let root = greatest.sqrt();
    for power in &cell.limits.powers {
        let limit = power.limit.div(power.rate * root);
        if greatest > B::ZERO && limit.is_finite() {
            of_row(&power.torque, cell, limit, greatest, &mut take);
        }
    }
}

fn of_row<B: Arithmetic>(
    row: &Row<ModelLine<B>, B>,
    cell: &Cell<B>,
    limit: B,
    greatest_x: B,
    take: &mut impl FnMut(Inequality<B>, Limited),
) {
    let zero = B::ZERO;
    // sqrt(x) <= half_root (1 + x / greatest): a hold adds |acceleration| r sqrt(x).
    let half_root = B::HALF * cell.ramp * greatest_x.sqrt();
    let per_greatest = match greatest_x > zero {
        true => half_root.div(greatest_x),
        false => zero,
    };
    let signs: &[B] = match row.acceleration {
        Some(_) => &[B::ONE, -B::ONE],
        None => &[B::ONE],
    };
    let none = ModelLine {
        constant: zero,
        slope: zero,
        error: zero,
    };
    let acceleration = row.acceleration.unwrap_or(none);
    let (square, rest) = (row.square, row.rest);
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
    // A part of all motions that the limits allow: what holds the pose counts with the same part, so that rest stays.
    let limit = limit * cell.share;
    // The inequality itself is computed with a few roundings.
    let limit = limit - limit * (B::UNIT_ROUNDOFF * B::from_f64(64.0)) - cell.share * rest.error;
    for &sign in signs {
        for end in [-B::ONE, B::ONE] {
            let slope = sign * acceleration.at(end) * per_length;
            let hold = acceleration.at(end).abs() + acceleration.error;
            let square = sign * square.at(end) + square.error + hold * per_greatest;
            let (at_start, at_end) = match end < zero {
                true => (square, zero),
                false => (zero, square),
            };
            let limit = limit - sign * cell.share * rest.at(end) - hold * half_root;
            let mut take = |change: B| {
                let inequality = Inequality {
                    start: at_start - slope - change,
                    end: at_end + slope + change,
                    limit,
                };
                take(inequality, row.what);
            };
            take(change);
            if change != zero {
                take(-change);
            }
        }
    }
}
