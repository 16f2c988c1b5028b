//! The fastest motion nearby that keeps limits of jerk, by an interior-point method.

use super::JerkLimits;
use super::band::{Band, solved};
use crate::program::{Inequality, inequalities};
use crate::rows::Cell;

/// A jump that moves spread over steps of a time changes by at most 3/4 of itself in one step.
const SPREAD: f64 = 4.0 / 3.0;

/// Part of the time that the barriers may cost in the end.
const ACCURACY: f64 = 1e-4;
/// Factor from one weight of the barriers to the next.
const WEAKER: f64 = 0.1;
/// Steps with one weight.
const STEPS: u32 = 40;
/// Halvings of a step, and of the pace at the start.
const HALVINGS: u32 = 50;

/// Lowers `squares`, as the passes leave them, until the limits are kept.
pub(crate) fn limit(cells: &[Cell<f64>], jerk: &JerkLimits, squares: &mut [f64]) {
    let Some(problem) = Problem::new(cells, jerk, squares) else {
        return;
    };
    if let Some(parts) = problem.solve() {
        for (square, part) in squares.iter_mut().zip(parts) {
            *square *= part;
        }
    }
}

/// Unknowns are the parts of the squares of the passes at the marks, 0 to 1; those at both ends are nothing.
pub(super) struct Problem<'a> {
    pub(super) cells: Vec<ProblemCell>,
    /// Limits start y + end z <= limit of a cell.
    pub(super) linear: Vec<(usize, Inequality<f64>)>,
    pub(super) jerk: &'a JerkLimits,
}

pub(super) struct ProblemCell {
    pub(super) length: f64,
    pub(super) share: f64,
    /// x at both ends by the passes.
    pub(super) ends: [f64; 2],
}

impl<'a> Problem<'a> {
    fn new(cells: &[Cell<f64>], jerk: &'a JerkLimits, squares: &[f64]) -> Option<Self> {
        let count = cells.len();
        let mut problem = Self {
            cells: Vec::with_capacity(count),
            linear: Vec::new(),
            jerk,
        };
        for (index, cell) in cells.iter().enumerate() {
            let joint = cells.get(index + 1).map_or(1.0, |next| next.joint);
            let ends = [squares[index], squares[index + 1] / joint];
            let inner = [index > 0, index + 1 < count];
            if ends
                .iter()
                .zip(inner)
                .any(|(end, inner)| inner && !(*end > 0.0))
            {
                return None;
            }
            problem.cells.push(ProblemCell {
                length: cell.length,
                share: cell.share,
                ends,
            });
            // What no motion below that of the passes breaks is left out.
            let [y, z] = ends;
            for (limit, jump) in jerk.limits.into_iter().zip(jerk.jumps[index]) {
                let jump = Inequality {
                    start: jump.abs(),
                    end: 0.0,
                    limit: limit * SPREAD * jerk.step_s * cell.share,
                };
                if jump.start * y > jump.limit {
                    problem.linear.push((index, jump));
                }
            }
            inequalities(cell, y.max(z), |each, _| {
                if each.start.max(0.0) * y + each.end.max(0.0) * z > each.limit {
                    problem.linear.push((index, each));
                }
            });
        }
        (count > 1).then_some(problem)
    }

    /// The parts; none if no motion was found.
    fn solve(&self) -> Option<Vec<f64>> {
        let count = self.cells.len();
        let mut parts = vec![0.5; count + 1];
        let mut halvings = 0;
        while !self.slacks(&parts, |slack| slack.value > 0.0) {
            parts.iter_mut().for_each(|part| *part *= 0.5);
            halvings += 1;
            if halvings > HALVINGS {
                return None;
            }
        }
        let mut barriers = 0.0;
        self.slacks(&parts, |_| {
            barriers += 1.0;
            true
        });
        let (mut cost, mut most) = (1.0, self.time(&parts));
        while cost > ACCURACY {
            cost *= WEAKER;
            let weight = cost * most / barriers;
            for _ in 0..STEPS {
                let (slopes, matrix) = self.expansion(&parts, weight);
                let step = solved(matrix, &slopes);
                let decrease: f64 = step
                    .iter()
                    .zip(&slopes)
                    .map(|(step, slope)| step * slope)
                    .sum();
                if !(decrease > 0.01) || !self.advance(&mut parts, &step, decrease, weight) {
                    break;
                }
            }
            most = self.time(&parts);
        }
        Some(parts)
    }

    /// Goes against `step`, as far as the value falls.
    fn advance(&self, parts: &mut Vec<f64>, step: &[f64], decrease: f64, weight: f64) -> bool {
        let before = self.value(parts, weight);
        let mut length = 1.0;
        for _ in 0..HALVINGS {
            let next: Vec<f64> = parts
                .iter()
                .zip(step)
                .map(|(part, step)| part - length * step)
                .collect();
            if self.value(&next, weight) <= before - 0.1 * length * decrease {
                *parts = next;
                return true;
            }
            length *= 0.5;
        }
        false
    }

    fn time(&self, parts: &[f64]) -> f64 {
        (0..self.cells.len())
            .map(|index| self.cell_time(index, parts)[0])
            .sum()
    }

    /// Time over the weight less the logarithms of all slacks; infinite outside of the limits.
    fn value(&self, parts: &[f64], weight: f64) -> f64 {
        let (mut logarithms, mut product) = (0.0, 1.0f64);
        let kept = self.slacks(parts, |slack| {
            product *= slack.value;
            if !(1e-200..1e200).contains(&product) {
                logarithms += libm::log(product);
                product = 1.0;
            }
            slack.value > 0.0
        });
        match kept {
            true => self.time(parts) / weight - logarithms - libm::log(product),
            false => f64::INFINITY,
        }
    }

    /// Slopes and curvature of the value, without the curvature of what the time allows a jerk, which is of the wrong sign.
    fn expansion(&self, parts: &[f64], weight: f64) -> (Vec<f64>, Band) {
        let count = self.cells.len();
        let mut slopes = vec![0.0; count + 1];
        let mut matrix = vec![[0.0; 3]; count + 1];
        for index in 0..count {
            let [_, by_y, by_z, by_yy, by_yz, by_zz] = self.cell_time(index, parts);
            slopes[index] += by_y / weight;
            slopes[index + 1] += by_z / weight;
            matrix[index][0] += by_yy / weight;
            matrix[index][1] += by_yz / weight;
            matrix[index + 1][0] += by_zz / weight;
        }
        self.slacks(parts, |slack| {
            let relative = slack.slopes.map(|slope| slope / slack.value);
            for (from, slope) in relative
                .into_iter()
                .enumerate()
                .filter(|each| each.1 != 0.0)
            {
                slopes[slack.first + from] -= slope;
                for (to, other) in relative.into_iter().enumerate().skip(from) {
                    matrix[slack.first + from][to - from] += slope * other;
                }
            }
            true
        });
        // The ends are at rest.
        for end in [0, count] {
            slopes[end] = 0.0;
            matrix[end] = [1.0, 0.0, 0.0];
        }
        matrix[count - 1][1] = 0.0;
        if let Some(row) = count.checked_sub(2).and_then(|row| matrix.get_mut(row)) {
            row[2] = 0.0;
        }
        (slopes, matrix)
    }

    /// Time of a cell, its slopes by both parts, and its second ones.
    pub(super) fn cell_time(&self, index: usize, parts: &[f64]) -> [f64; 6] {
        let cell = &self.cells[index];
        let [y, z] = [cell.ends[0] * parts[index], cell.ends[1] * parts[index + 1]];
        let (p, q) = (y.sqrt(), z.sqrt());
        let sum = p + q;
        let time = 2.0 * cell.length / sum;
        // Of the roots by the parts; of an end at rest nothing.
        let root = |root: f64, part: f64| match root > 0.0 {
            true => [0.5 * root / part, -0.25 * root / (part * part)],
            false => [0.0; 2],
        };
        let ([p1, p2], [q1, q2]) = (root(p, parts[index]), root(q, parts[index + 1]));
        let (first, second) = (-time / sum, 2.0 * time / (sum * sum));
        [
            time,
            first * p1,
            first * q1,
            second * p1 * p1 + first * p2,
            second * p1 * q1,
            second * q1 * q1 + first * q2,
        ]
    }
}
