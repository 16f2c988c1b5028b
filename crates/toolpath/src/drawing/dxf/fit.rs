//! Splines of fit points alone: the cubic curve through them whose curvature has no steps.

use super::curves::Outline;

/// Points nearer than this part of the curve's size are one.
const NEAR: f64 = 1e-9;

/// Curve through points: chords are its parameter, its ends are free, or have a direction.
pub(super) struct FitCurve {
    points: Vec<[f64; 2]>,
    /// Derivatives at the points.
    slopes: Vec<[f64; 2]>,
}

impl FitCurve {
    /// Curve through `points`. A closed one comes back to its start in the direction in which it left.
    pub(super) fn new(
        points: impl Iterator<Item = [f64; 2]>,
        is_closed: bool,
        ends: [Option<[f64; 2]>; 2],
    ) -> Self {
        let mut points: Vec<[f64; 2]> = points.collect();
        let size = points
            .iter()
            .flatten()
            .fold(0.0_f64, |size, value| size.max(value.abs()));
        points.dedup_by(|one, other| distance(*one, *other) <= NEAR * size);
        let meets =
            |points: &[[f64; 2]]| distance(points[0], points[points.len() - 1]) <= NEAR * size;
        if is_closed && points.len() > 2 {
            if meets(&points) {
                points.pop();
            }
            let slopes = closed_slopes(&points);
            let (start, slope) = (points[0], slopes[0]);
            points.push(start);
            return Self {
                points,
                slopes: slopes.into_iter().chain([slope]).collect(),
            };
        }
        let slopes = match points.len() {
            0..2 => vec![[0.0; 2]; points.len()],
            _ => open_slopes(&points, ends),
        };
        Self { points, slopes }
    }

    pub(super) fn start(&self) -> [f64; 2] {
        self.points.first().copied().unwrap_or_default()
    }

    /// Adds the curve to a chain that ends at its start.
    pub(super) fn add_to(&self, chain: &mut Outline) {
        for (points, slopes) in self.points.windows(2).zip(self.slopes.windows(2)) {
            let third = distance(points[0], points[1]) / 3.0;
            chain.bezier([
                [0, 1].map(|axis| points[0][axis] + third * slopes[0][axis]),
                [0, 1].map(|axis| points[1][axis] - third * slopes[1][axis]),
                points[1],
            ]);
        }
    }
}

/// SlopeRow of a system with three diagonals: before, own, behind, and the right side.
type SlopeRow = ([f64; 3], [f64; 2]);

/// Condition at a point between two chords: the second derivative has no step.
fn between(before: [f64; 2], at: [f64; 2], behind: [f64; 2]) -> SlopeRow {
    let (h, k) = (distance(before, at), distance(at, behind));
    let side = [0, 1]
        .map(|axis| 3.0 * (k * (at[axis] - before[axis]) / h + h * (behind[axis] - at[axis]) / k));
    ([k, 2.0 * (h + k), h], side)
}

fn open_slopes(points: &[[f64; 2]], [first, last]: [Option<[f64; 2]>; 2]) -> Vec<[f64; 2]> {
    // A free end has no curvature.
    let free = |a: [f64; 2], b: [f64; 2]| {
        let h = distance(a, b);
        [0, 1].map(|axis| 3.0 * (b[axis] - a[axis]) / h)
    };
    let count = points.len();
    let start = match first.and_then(unit) {
        Some(slope) => ([0.0, 1.0, 0.0], slope),
        None => ([0.0, 2.0, 1.0], free(points[0], points[1])),
    };
    let end = match last.and_then(unit) {
        Some(slope) => ([0.0, 1.0, 0.0], slope),
        None => ([1.0, 2.0, 0.0], free(points[count - 2], points[count - 1])),
    };
    let inner = points
        .windows(3)
        .map(|three| between(three[0], three[1], three[2]));
    solve(std::iter::once(start).chain(inner).chain([end]).collect())
}

fn closed_slopes(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let count = points.len();
    let mut rows: Vec<SlopeRow> = (0..count)
        .map(|index| {
            let before = points[(index + count - 1) % count];
            between(before, points[index], points[(index + 1) % count])
        })
        .collect();
    // The two corners of the matrix are taken off as a product (Sherman and Morrison).
    let (upper, lower) = (rows[0].0[0], rows[count - 1].0[2]);
    let gamma = -rows[0].0[1];
    rows[0].0[1] -= gamma;
    rows[count - 1].0[1] -= upper * lower / gamma;
    let mut product = rows.clone();
    for (index, row) in product.iter_mut().enumerate() {
        let value = match index {
            0 => gamma,
            index if index + 1 == count => lower,
            _ => 0.0,
        };
        row.1 = [value; 2];
    }
    let (plain, product) = (solve(rows), solve(product));
    let part = upper / gamma;
    let share = [0, 1].map(|axis| {
        let last = count - 1;
        (plain[0][axis] + part * plain[last][axis])
            / (1.0 + product[0][axis] + part * product[last][axis])
    });
    plain
        .iter()
        .zip(&product)
        .map(|(plain, product)| [0, 1].map(|axis| plain[axis] - share[axis] * product[axis]))
        .collect()
}

/// Solves a system with three diagonals, the middle of which is the greatest.
fn solve(mut rows: Vec<SlopeRow>) -> Vec<[f64; 2]> {
    for index in 1..rows.len() {
        let ([_, own, behind], side) = rows[index - 1];
        let part = rows[index].0[0] / own;
        rows[index].0[1] -= part * behind;
        for (own, before) in rows[index].1.iter_mut().zip(side) {
            *own -= part * before;
        }
    }
    let mut found = vec![[0.0; 2]; rows.len()];
    let mut behind_value = [0.0; 2];
    for (index, ([_, own, behind], side)) in rows.iter().enumerate().rev() {
        behind_value = [0, 1].map(|axis| (side[axis] - behind * behind_value[axis]) / own);
        found[index] = behind_value;
    }
    found
}

fn unit(direction: [f64; 2]) -> Option<[f64; 2]> {
    let size = libm::hypot(direction[0], direction[1]);
    (size > 0.0).then(|| direction.map(|value| value / size))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}
