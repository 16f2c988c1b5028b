//! Least squares of torques along the directions that the motion sees.

use super::bodies::{BodyVector, body_name, is_positive};
use super::equations::{BLOCKS, TorqueEquation};
use super::expected::exchanges;
use crate::sight::{Sight, columns_of, in_words};
use nalgebra::{DMatrix, DVector};
use trirrr_core::machine::Parameters;

/// Equations that are linear in scaled free parameters.
pub(super) struct LinearProblem {
    pub(super) nominal: BodyVector,
    pub(super) free: Vec<usize>,
    pub(super) scales: Vec<f64>,
    /// Equations that are worth one.
    pub(super) shared: f64,
    /// Parameters that are held at 0.
    pub(super) held: Vec<usize>,
}

pub(super) struct Solved {
    pub(super) values: BodyVector,
    pub(super) sight: Sight,
    /// Covariance along the seen directions.
    pub(super) covariance: DMatrix<f64>,
}

impl LinearProblem {
    /// Solves, and holds at 0 what would be negative, one after the other.
    pub(super) fn without_negatives(mut self, equations: &[&TorqueEquation]) -> (Self, Solved) {
        loop {
            let solved = self.solve(equations);
            let worst = self
                .free
                .iter()
                .copied()
                .filter(|index| is_positive(*index) && solved.values.0[*index] < 0.0)
                .max_by(|one, other| {
                    let part = |index: &usize| {
                        let place = self.free.iter().position(|it| it == index);
                        -solved.values.0[*index] / place.map_or(1.0, |place| self.scales[place])
                    };
                    part(one).total_cmp(&part(other))
                });
            match worst {
                Some(index) if !self.held.contains(&index) => {
                    self.nominal.0[index] = 0.0;
                    self.held.push(index);
                }
                _ => return (self, solved),
            }
        }
    }

    pub(super) fn solve(&self, equations: &[&TorqueEquation]) -> Solved {
        let count = equations.len();
        let scaled = DMatrix::from_fn(count, self.free.len(), |row, column| {
            let index = self.free[column];
            match self.held.contains(&index) {
                true => 0.0,
                false => equations[row].slopes[index] * self.scales[column],
            }
        });
        let missing = DVector::from_iterator(
            count,
            equations
                .iter()
                .map(|equation| equation.torque - equation.by(&self.nominal)),
        );
        // Noise by the fit along everything that is not blind; then directions by their ratio to that noise.
        let rough = along(&scaled, &missing, &not_blind(&scaled));
        let freedom = (count as f64 - self.free.len() as f64).max(1.0);
        let left = (&missing - &scaled * &rough).norm_squared() / freedom;
        let size = missing.norm_squared() / count as f64;
        let noise = left.max(1e-18 * size).sqrt().max(1e-15);
        let sight = Sight::of(&(&scaled / (noise * self.shared.sqrt())));
        let found = along(&scaled, &missing, &sight.seen);
        let mut values = self.nominal;
        for ((index, scale), part) in self.free.iter().zip(&self.scales).zip(found.iter()) {
            values.0[*index] += scale * part;
        }
        for index in &self.held {
            values.0[*index] = 0.0;
        }
        let off = &missing - &scaled * &found;
        let covariance = in_blocks(&(&scaled * &sight.seen), &off, equations);
        Solved {
            values,
            sight,
            covariance,
        }
    }

    /// Blind and weak directions in words.
    pub(super) fn words(&self, sight: &Sight, machine: &Parameters) -> [Vec<String>; 2] {
        let known = exchanges(machine, &self.free, &self.scales);
        let name = |index: usize| body_name(self.free[index]);
        let kept = |word: &String| !self.held.iter().any(|index| *word == body_name(*index));
        [&sight.blind, &sight.weak].map(|directions| {
            let words = in_words(directions, &known, name);
            words.into_iter().filter(kept).collect()
        })
    }
}

/// Directions that the equations see at all.
pub(super) fn not_blind(scaled: &DMatrix<f64>) -> DMatrix<f64> {
    let sight = Sight::of(scaled);
    let columns = [&sight.seen, &sight.weak].map(|directions| directions.column_iter());
    let columns = columns.into_iter().flatten();
    let columns: Vec<DVector<f64>> = columns.map(|column| column.clone_owned()).collect();
    columns_of(scaled.ncols(), &columns)
}

/// Least squares along directions.
pub(super) fn along(
    scaled: &DMatrix<f64>,
    missing: &DVector<f64>,
    seen: &DMatrix<f64>,
) -> DVector<f64> {
    let slopes = scaled * seen;
    let information = slopes.transpose() * &slopes;
    let right = slopes.transpose() * missing;
    let found = information
        .clone()
        .cholesky()
        .map(|factors| factors.solve(&right));
    match found {
        Some(found) => seen * found,
        None => DVector::zeros(scaled.ncols()),
    }
}

/// Covariance along directions: residuals of a block of time may hang together in any way, those of different blocks do not.
pub(super) fn in_blocks(
    slopes: &DMatrix<f64>,
    off: &DVector<f64>,
    equations: &[&TorqueEquation],
) -> DMatrix<f64> {
    let size = slopes.ncols();
    let information = slopes.transpose() * slopes;
    let Some(inverse) = information.try_inverse() else {
        return DMatrix::zeros(size, size);
    };
    let mut sums = vec![DVector::<f64>::zeros(size); BLOCKS];
    for (row, equation) in equations.iter().enumerate() {
        sums[equation.block] += slopes.row(row).transpose() * off[row];
    }
    let used = sums.iter().filter(|sum| sum.norm() > 0.0).count() as f64;
    let mut middle = DMatrix::zeros(size, size);
    for sum in &sums {
        middle += sum * sum.transpose();
    }
    let few = used / (used - 1.0).max(1.0);
    let spent = equations.len() as f64 / (equations.len() as f64 - size as f64).max(1.0);
    // The residuals of few blocks are smaller than the errors: as much smaller as directions are fitted to them.
    let fitted = used / (used - size as f64).max(1.0);
    &inverse * middle * &inverse * (few * spent * fitted)
}
