//! A lower bound of the time that any motion takes along the path within the limits.
//!
//! In a cell, with t from -1 to 1 and every coefficient somewhere in its Taylor model, a row of limits
//! says a <= P(t) - Q(t) x or a >= P(t) - Q(t) x. As dx/dt = length a, a quadratic in t whose slope is
//! nowhere below that bound stays above every motion that begins below it (comparison of ordinary
//! differential equations). Two rows with a <= P - Q x and a >= P' - Q' x leave x <= (P - P') / (Q - Q').
//! Both hold for every motion, not only for those with constant acceleration in a cell.
//!
//! A power limit leaves less of a torque the greater x is: |torque| <= power / (|theta'| sqrt(x)). A curve that is nowhere below y stays above
//! every motion if its slope is nowhere below what the limit leaves at y, since it leaves no more where x is greater.

use crate::cell::Cell;
use crate::extreme::{greater, lesser, unbounded};
use crate::passes::{next_joint, time_between};
use crate::rows::{ModelRow, PowerLimit, Rows};
use heapless::Vec;
use trirrr_core::number::Arithmetic;
use trirrr_service::admission::{Enclose, ModelLine, TaylorModel};

/// Most rows with an acceleration.
const ROWS: usize = 6;

/// a <= limit - square x, or a >= that.
#[derive(Clone, Copy, Debug)]
struct Side<T> {
    limit: T,
    square: T,
}

/// |a - base + square x| <= size power / (rate sqrt(x)).
#[derive(Clone, Copy, Debug)]
struct PowerSides<B> {
    base: ModelLine<B>,
    size: ModelLine<B>,
    square: ModelLine<B>,
    /// The limit over the least |theta'|: the greatest torque at x = 1.
    torque: B,
}

/// Bounds of any motion through a cell.
#[derive(Clone, Debug)]
pub struct Possible<B> {
    powers: Vec<PowerSides<B>, 3>,
    above: Vec<Side<ModelLine<B>>, ROWS>,
    below: Vec<Side<ModelLine<B>>, ROWS>,
    /// Above every x that some a keeps within the limits.
    cap: Above<B>,
    /// Greatest x that some a keeps within the limits, at the start and at the end.
    ends: [B; 2],
}

/// A line above x in a cell, by its values at both ends, and a bulge by which x may exceed it in between.
#[derive(Clone, Copy, Debug)]
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
/// x <= `end`. `times` and `squares` are room for one value more than there are cells; `possible` has one for each. `squares` is left with an upper
/// bound of x at each place, `times` with a lower bound of the time in the cell that begins there.
pub fn least_time<B: Arithmetic>(
    cells: &[Cell<B>],
    possible: &[Possible<B>],
    [start, end]: [B; 2],
    times: &mut [B],
    squares: &mut [B],
) -> B {
    let count = cells.len();
    // Bounds from before, until the cell behind has used them.
    let forward = times;
    forward[0] = start;
    for (index, (cell, possible)) in cells.iter().zip(possible).enumerate() {
        let joint = next_joint(cells, index);
        let [at_start, at_end] = possible.ends;
        let x = lesser(forward[index], at_start);
        forward[index] = x;
        let reached = possible.from(x, cell.length);
        let reached = reached.map_or(at_end, |above| above.end);
        forward[index + 1] = lesser(reached, at_end) * joint;
    }
    squares[count] = lesser(forward[count], end);
    forward[count] = B::ZERO;
    let mut total = B::ZERO;
    for (index, (cell, possible)) in cells.iter().zip(possible).enumerate().rev() {
        let joint = next_joint(cells, index);
        let [at_start, at_end] = possible.ends;
        let after = lesser(squares[index + 1].div(joint), at_end);
        let to = possible.to(after, cell.length);
        let before = lesser(
            to.map_or(at_start, |above| lesser(above.start, at_start)),
            forward[index],
        );
        squares[index] = before;
        let mut time = possible.cap.time(cell.length);
        for above in [possible.from(before, cell.length), to]
            .into_iter()
            .flatten()
        {
            time = greater(time, above.time(cell.length));
        }
        forward[index] = time;
        total += time;
    }
    total - total * (B::UNIT_ROUNDOFF * B::from_f64(8.0 * count as f64))
}

impl<B: Arithmetic> Possible<B> {
    /// What the limits leave possible in a cell of `length`.
    pub(crate) fn of<N: Enclose<Bound = B>>(limits: &Rows<TaylorModel<N>, B>, length: B) -> Self {
        let rows = &limits.rows[..];
        let mut above: Vec<Side<TaylorModel<N>>, ROWS> = Vec::new();
        let mut below: Vec<Side<TaylorModel<N>>, ROWS> = Vec::new();
        let sides = rows.iter().filter_map(sides);
        for [most, least] in sides {
            // There is room for each.
            let _ = above.push(most);
            let _ = below.push(least);
        }
        let lines = |sides: &[Side<TaylorModel<N>>]| {
            let line = |side: &Side<TaylorModel<N>>| Side {
                limit: side.limit.line(),
                square: side.square.line(),
            };
            sides.iter().map(line).collect()
        };
        let (cap, ends) = cap(rows, &above, &below, length);
        Self {
            cap,
            ends,
            above: lines(&above),
            below: lines(&below),
            powers: limits
                .powers
                .iter()
                .filter_map(PowerSides::of::<N>)
                .collect(),
        }
    }

    /// The least of the curves above all motions from x <= `start`.
    fn from(&self, start: B, length: B) -> Option<Above<B>> {
        let curves = self.above.iter();
        let curves = curves.map(|side| curve(start, length, side.limit, side.square));
        let powers = self.powers.iter();
        lowest(curves.chain(powers.map(|power| power.from(start, length))))
    }

    /// The least of the curves above all motions to x <= `end`: those of the time that runs backwards.
    fn to(&self, end: B, length: B) -> Option<Above<B>> {
        let curves = self.below.iter().map(|side| {
            let limit = ModelLine {
                constant: -side.limit.constant,
                ..side.limit
            };
            let square = ModelLine {
                constant: -side.square.constant,
                ..side.square
            };
            curve(end, length, limit, square).map(Above::mirrored)
        });
        let powers = self.powers.iter();
        let powers = powers.map(|power| power.reversed().from(end, length).map(Above::mirrored));
        lowest(curves.chain(powers))
    }
}

impl<B: Arithmetic> PowerSides<B> {
    /// None where the coefficient of a or theta' may vanish in the cell.
    fn of<N: Enclose<Bound = B>>(power: &PowerLimit<TaylorModel<N>, B>) -> Option<Self> {
        let coefficient = power.torque.acceleration?;
        let inverse = TaylorModel::<N>::ONE.div(coefficient);
        let size = if coefficient > TaylorModel::ZERO {
            inverse
        } else if coefficient < TaylorModel::ZERO {
            -inverse
        } else {
            return None;
        };
        let torque = power.limit.div(power.least_rate);
        let is_known = torque > B::ZERO && torque < unbounded();
        is_known.then(|| Self {
            base: (-(power.torque.rest * inverse)).line(),
            size: size.line(),
            square: (power.torque.square * inverse).line(),
            torque: torque + torque * (B::UNIT_ROUNDOFF * B::from_f64(16.0)),
        })
    }

    /// The same in time that runs backwards.
    fn reversed(&self) -> Self {
        let turned = |line: ModelLine<B>| ModelLine {
            constant: -line.constant,
            ..line
        };
        Self {
            base: turned(self.base),
            size: ModelLine {
                slope: -self.size.slope,
                ..self.size
            },
            square: turned(self.square),
            torque: self.torque,
        }
    }

    /// A curve above all motions from x <= `start`, if there is one.
    fn from(&self, start: B, length: B) -> Option<Above<B>> {
        let mut least = start;
        for _ in 0..2 {
            if !(least > B::ZERO) {
                return None;
            }
            let torque = self.torque.div(least.sqrt());
            let curve = curve(start, length, self.limit(torque), self.square)?;
            let lowest = lesser(curve.start, curve.end) - curve.bulge;
            if lowest >= least {
                return Some(curve);
            }
            // The next curve lies above this one, and so above its least value; its bulge may be greater.
            least = lowest - B::HALF * B::HALF * curve.bulge;
        }
        None
    }

    /// Greatest a at rest for this torque.
    fn limit(&self, torque: B) -> ModelLine<B> {
        let Self { base, size, .. } = *self;
        let rounding = B::UNIT_ROUNDOFF * B::from_f64(8.0);
        let sizes = base.constant.abs() + base.slope.abs();
        let parts = torque * (size.constant.abs() + size.slope.abs());
        ModelLine {
            constant: base.constant + torque * size.constant,
            slope: base.slope + torque * size.slope,
            error: base.error + torque * size.error + (sizes + parts) * rounding,
        }
    }
}

/// The bounds of a from above and from below; none where the coefficient of a may vanish in the cell.
fn sides<N: Enclose>(row: &ModelRow<N>) -> Option<[Side<TaylorModel<N>>; 2]> {
    let coefficient = row.acceleration?;
    let limit = TaylorModel::point(row.limit);
    let inverse = TaylorModel::ONE.div(coefficient);
    let square = row.square * inverse;
    let side = |limit: TaylorModel<N>| Side {
        limit: (limit - row.rest) * inverse,
        square,
    };
    let (most, least) = (side(limit), side(-limit));
    if coefficient > TaylorModel::ZERO {
        Some([most, least])
    } else if coefficient < TaylorModel::ZERO {
        Some([least, most])
    } else {
        None
    }
}

/// A line above every x that some a keeps within the limits, and the greatest such x at both ends.
fn cap<N: Enclose>(
    rows: &[ModelRow<N>],
    above: &[Side<TaylorModel<N>>],
    below: &[Side<TaylorModel<N>>],
    length: N::Bound,
) -> (Above<N::Bound>, [N::Bound; 2]) {
    let zero = N::Bound::ZERO;
    let far = unbounded();
    let mut cap = Above {
        start: far,
        end: far,
        bulge: zero,
    };
    let mut ends = [far; 2];
    let mut fastest = time_between(length, far, far);
    let mut lower = |bound: TaylorModel<N>| {
        let line = bound.line();
        let (start, end) = (line.at(-N::Bound::ONE), line.at(N::Bound::ONE));
        let above = Above {
            start: greater(start + line.error, zero),
            end: greater(end + line.error, zero),
            bulge: zero,
        };
        ends = [lesser(ends[0], above.start), lesser(ends[1], above.end)];
        let time = above.time(length);
        if time > fastest {
            fastest = time;
            cap = above;
        }
    };
    for row in rows {
        if row.acceleration.is_none() {
            let bound = TaylorModel::point(row.limit).div(row.square);
            if bound.is_finite() {
                lower(bound);
            }
        }
    }
    for [above, below] in nearest(above, below) {
        let square = above.square - below.square;
        if square > TaylorModel::ZERO {
            lower((above.limit - below.limit).div(square));
        }
    }
    (cap, ends)
}

/// Pairs of sides that leave the least x at the start, in the middle and at the end of a cell, by their lines alone.
fn nearest<'a, N: Enclose>(
    above: &'a [Side<TaylorModel<N>>],
    below: &'a [Side<TaylorModel<N>>],
) -> Vec<[&'a Side<TaylorModel<N>>; 2], 3> {
    let one = N::Bound::ONE;
    let places = [-one, N::Bound::ZERO, one];
    let mut least: [Option<(N::Bound, [usize; 2])>; 3] = [None; 3];
    for (i, most) in above.iter().enumerate() {
        for (j, other) in below.iter().enumerate() {
            let limits = [most.limit.line(), other.limit.line()];
            let squares = [most.square.line(), other.square.line()];
            for (place, least) in places.into_iter().zip(&mut least) {
                let square = squares[0].at(place) - squares[1].at(place);
                let x = (limits[0].at(place) - limits[1].at(place)).div(square);
                if square > N::Bound::ZERO && least.is_none_or(|(known, _)| x < known) {
                    *least = Some((x, [i, j]));
                }
            }
        }
    }
    let mut pairs: Vec<[usize; 2], 3> = Vec::new();
    for (_, pair) in least.into_iter().flatten() {
        if !pairs.contains(&pair) {
            // There is room for each place.
            let _ = pairs.push(pair);
        }
    }
    let sides = |[i, j]: [usize; 2]| [&above[i], &below[j]];
    pairs.into_iter().map(sides).collect()
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
