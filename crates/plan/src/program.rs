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

/// The end of a cell that is asked for where the other one is known.
struct EndReach<B> {
    /// Least and greatest value there that go with the other end.
    least: B,
    greatest: B,
    /// Greatest value would be greater if the other end were less.
    gives_way: bool,
    /// Other end is within the limits that it has alone, and rest is within all.
    kept: bool,
    stands: bool,
}

impl<B: Arithmetic> EndReach<B> {
    /// Of the `cap` and the inequalities of `cell` for x up to `greatest_x`; `sides` gives the coefficients of the end asked
    /// for and of the other one, which is `known`.
    ///
    /// A division is needed only where an inequality is nearer than all before.
    #[inline(always)]
    fn of(
        cell: &Cell<B>,
        greatest_x: B,
        [known, cap]: [B; 2],
        sides: impl Fn(&Inequality<B>) -> [B; 2],
    ) -> Self {
        let zero = B::ZERO;
        let mut reached = Self {
            least: zero,
            greatest: cap,
            gives_way: false,
            kept: true,
            stands: true,
        };
        inequalities(cell, greatest_x, |each, what| {
            // A power that is limited at each pace is none at rest.
            let moves = cell.is_paced() && matches!(what, Limited::Power(_));
            reached.stands &= each.limit >= zero || moves;
            let [asked, other] = sides(&each);
            let left = each.limit - other * known;
            if asked > zero {
                if left < asked * reached.greatest {
                    reached.greatest = left.div(asked);
                    reached.gives_way = other > zero;
                }
            } else if asked < zero {
                if left < asked * reached.least {
                    reached.least = left.div(asked);
                }
            } else {
                // The known end may be the greatest there is: a division may have rounded it up.
                let rounded = each.limit * (B::UNIT_ROUNDOFF * B::from_f64(8.0));
                reached.kept &= left + rounded >= zero;
            }
        });
        reached
    }
}

/// Greatest y at the start of `cell`, at most `y_cap`, from which some z from 0 to `z_cap` can be reached, for x up to
/// `greatest_x` as of a [`Program`]. It is 0 at least, given that the machine can stand in the cell; none where it cannot.
pub(crate) fn greatest_start<B: Arithmetic>(
    cell: &Cell<B>,
    greatest_x: B,
    [y_cap, z_cap]: [B; 2],
) -> Option<B> {
    // Mostly the greatest y leads to the greatest z.
    let reached = EndReach::of(cell, greatest_x, [z_cap, y_cap], |each| {
        [each.start, each.end]
    });
    if !reached.stands {
        return None;
    }
    let is_greatest = reached.kept && !reached.gives_way && reached.least <= reached.greatest;
    Some(match is_greatest {
        true => reached.greatest,
        false => Program::of(cell, greatest_x).greatest_start(y_cap, z_cap),
    })
}

/// Greatest z at the end of `cell`, at most `z_cap`, for this `y`, for x up to `greatest_x`; none if no z goes with it, or
/// the machine cannot stand. If some z does for certain, the `certain` y may be the greatest there is, which rounding puts
/// on the wrong side of its z.
pub(crate) fn greatest_end<B: Arithmetic>(
    cell: &Cell<B>,
    greatest_x: B,
    [y, z_cap]: [B; 2],
    certain: bool,
) -> Option<B> {
    let reached = EndReach::of(cell, greatest_x, [y, z_cap], |each| [each.end, each.start]);
    let (low, high) = (reached.least, reached.greatest);
    let kept = certain || (reached.kept && low <= high);
    (kept && reached.stands).then_some(if high > low { high } else { low })
}

/// Inequalities of one cell, solved for z.
struct Program<B> {
    least: Vec<EndBound<B>, INEQUALITIES>,
    greatest: Vec<EndBound<B>, INEQUALITIES>,
    /// Greatest y of the inequalities without z.
    start_cap: B,
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
    #[inline(never)]
    fn of(cell: &Cell<B>, greatest: B) -> Self {
        let mut program = Self {
            least: Vec::new(),
            greatest: Vec::new(),
            start_cap: unbounded(),
        };
        inequalities(cell, greatest, |each, _| program.add(each));
        program
    }

    /// There is room for each.
    fn add(&mut self, each: Inequality<B>) {
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
    fn greatest_start(&self, y_cap: B, z_cap: B) -> B {
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

/// Part that the rows of a cell have in common, for x up to a greatest one.
struct RowTerms<B> {
    /// 1 / (2 length): a over z - y.
    per_length: B,
    /// sqrt(x) <= half_root (1 + x / greatest): a hold adds |acceleration| r sqrt(x).
    half_root: B,
    /// half_root / greatest.
    per_greatest: B,
    share: B,
    is_paced: bool,
}

impl<B: Arithmetic> RowTerms<B> {
    fn of(cell: &Cell<B>, greatest: B) -> Self {
        let zero = B::ZERO;
        let holds = cell.ramp > zero && greatest > zero;
        let half_root = match holds {
            true => B::HALF * cell.ramp * greatest.sqrt(),
            false => zero,
        };
        Self {
            per_length: B::HALF.div(cell.length),
            half_root,
            per_greatest: match holds {
                true => half_root.div(greatest),
                false => zero,
            },
            share: cell.share,
            is_paced: cell.is_paced(),
        }
    }
}

/// Hands each inequality of `cell` to `take`, for x up to `greatest`.
#[inline(always)]
pub(crate) fn inequalities<B: Arithmetic>(
    cell: &Cell<B>,
    greatest: B,
    mut take: impl FnMut(Inequality<B>, Limited),
) {
    let shared = RowTerms::of(cell, greatest);
    for row in &cell.limits.rows {
        shared.of_row(row, row.limit, &mut take);
    }
    if cell.limits.powers.is_empty() {
        return;
    }
    let root = greatest.sqrt();
    for power in &cell.limits.powers {
        let limit = power.limit.div(power.rate * root);
        if greatest > B::ZERO && limit.is_finite() {
            shared.of_row(&power.torque, limit, &mut take);
        }
    }
}

impl<B: Arithmetic> RowTerms<B> {
    fn of_row(
        &self,
        row: &Row<ModelLine<B>, B>,
        limit: B,
        take: &mut impl FnMut(Inequality<B>, Limited),
    ) {
        let zero = B::ZERO;
        let (square, rest) = (row.square, row.rest);
        let Some(acceleration) = row.acceleration else {
            return self.of_square(row, limit, take);
        };
        // What |z - y| adds at most: errors, and x at the other end.
        let change = acceleration.error * self.per_length
            + B::HALF * (square.slope.abs() + self.per_greatest * acceleration.slope.abs())
            + square.error;
        let limit = self.usable(limit) - self.share * rest.error;
        // With the torque g at rest and m beside it, the power is so much at each pace below: w u (g + m u^2).
        let is_paced = self.is_paced && matches!(row.what, Limited::Power(_));
        let left = |limit: B, rest: B| {
            let at_pace = limit - rest;
            if !is_paced || !(rest + rest > limit + limit + limit) {
                return at_pace;
            }
            // It is greatest at a lower pace, where m takes a third of g.
            let part = rest.div(limit);
            lesser(at_pace, -(rest * part * part * B::ratio(4, 27)))
        };
        for end in [-B::ONE, B::ONE] {
            let at_end = acceleration.at(end);
            let size = at_end.abs() + acceleration.error;
            let mut slope = at_end * self.per_length;
            let mut square_there = square.at(end);
            let mut rest_there = self.share * rest.at(end);
            // Errors, and what a hold adds.
            let more = square.error + size * self.per_greatest;
            let limit = limit - size * self.half_root;
            // Above, then below.
            for _ in 0..2 {
                let square = square_there + more;
                let (start, end) = match end < zero {
                    true => (square - slope, slope),
                    false => (-slope, square + slope),
                };
                for change in [change, -change] {
                    let inequality = Inequality {
                        start: start - change,
                        end: end + change,
                        limit: left(limit, rest_there),
                    };
                    take(inequality, row.what);
                }
                (slope, square_there, rest_there) = (-slope, -square_there, -rest_there);
            }
        }
    }

    /// Of a row that limits x alone.
    fn of_square(
        &self,
        row: &Row<ModelLine<B>, B>,
        limit: B,
        take: &mut impl FnMut(Inequality<B>, Limited),
    ) {
        let (zero, square) = (B::ZERO, row.square);
        let change = B::HALF * square.slope.abs() + square.error;
        // |z - y| is at most the greater of the two, which the limit bounds. A coefficient of z that is tiny beside that
        // of y would make noise of z.
        let part = change.div(square.constant - square.slope.abs());
        let is_level = part >= zero && part < B::ratio(1, 1 << 14);
        let limit = match is_level {
            true => limit - limit * (part + part),
            false => limit,
        };
        let limit = self.usable(limit);
        let [start, end] = [-B::ONE, B::ONE].map(|end| square.at(end) + square.error);
        let changes: &[B] = match is_level {
            true => &[zero],
            false => &[change, -change],
        };
        for &change in changes {
            for (start, end) in [(start, zero), (zero, end)] {
                let inequality = Inequality {
                    start: start - change,
                    end: end + change,
                    limit,
                };
                take(inequality, row.what);
            }
        }
    }

    /// The part of `limit` that motions may use: what holds the pose counts with the same part, so that rest stays.
    fn usable(&self, limit: B) -> B {
        let limit = limit * self.share;
        // An inequality itself is computed with a few roundings.
        limit - limit * (B::UNIT_ROUNDOFF * B::from_f64(64.0))
    }
}
