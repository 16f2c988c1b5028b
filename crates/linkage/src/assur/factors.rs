//! Factors of a square matrix, with the sign of the determinant and the condition.

use nalgebra::{DMatrix, DVector, Dyn, LU};

/// LU factors with partial pivoting, nalgebra's.
pub(super) struct Factors {
    lu: LU<f64, Dyn, Dyn>,
    /// The largest absolute column sum of the matrix.
    norm: f64,
}

fn one_norm(matrix: &DMatrix<f64>) -> f64 {
    let sums = matrix.column_iter().map(|column| column.abs().sum());
    sums.fold(0.0, f64::max)
}

impl Factors {
    /// Factors `matrix`; `None` where a pivot is zero or not finite.
    pub(super) fn new(matrix: DMatrix<f64>) -> Option<Self> {
        let norm = one_norm(&matrix);
        let lu = matrix.lu();
        let pivots = lu.u().diagonal();
        let good = pivots
            .iter()
            .all(|pivot| *pivot != 0.0 && pivot.is_finite());
        good.then_some(Self { lu, norm })
    }

    /// Returns x with A x = `b`.
    pub(super) fn solve(&self, b: Vec<f64>) -> Vec<f64> {
        let mut x = DVector::from_vec(b);
        let solved = self.lu.solve_mut(&mut x);
        debug_assert!(solved, "the pivots are not zero");
        x.data.into()
    }

    /// Returns `true` for a positive determinant. The determinant itself may leave the range of
    /// the format.
    pub(super) fn is_positive(&self) -> bool {
        let pivots = self.lu.u().diagonal();
        let negative = pivots.iter().filter(|pivot| **pivot < 0.0).count();
        let swapped: f64 = self.lu.p().determinant();
        (negative % 2 == 1) == (swapped < 0.0)
    }

    /// Returns 1 / (|A| |A^-1|) in the 1-norm: 1 at best, 0 for a singular matrix.
    pub(super) fn reciprocal_condition(&self) -> f64 {
        let inverse = self.lu.try_inverse();
        inverse.map_or(0.0, |inverse| 1.0 / (self.norm * one_norm(&inverse)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(size: usize, rows: &[f64]) -> Option<Factors> {
        Factors::new(DMatrix::from_row_slice(size, size, rows))
    }

    #[test]
    fn solves_with_a_zero_on_the_diagonal() {
        let factors = factor(3, &[0.0, 2.0, 1.0, 4.0, 1.0, 0.0, 2.0, 3.0, 5.0]).unwrap();
        // The right side of x = (1, -2, 3).
        let x = factors.solve(vec![-1.0, 2.0, 11.0]);
        for (found, x) in x.iter().zip([1.0, -2.0, 3.0]) {
            assert!((found - x).abs() < 1e-15, "{found} for {x}");
        }
        // By Sarrus: 0 (5 - 0) - 2 (20 - 0) + 1 (12 - 2) = -30.
        assert!(!factors.is_positive());
    }

    #[test]
    fn a_singular_matrix_has_no_factors_and_the_condition_shows_how_near_one_is() {
        assert!(factor(2, &[1.0, 2.0, 2.0, 4.0]).is_none());
        assert!(factor(1, &[f64::NAN]).is_none());
        // Inverse [[-2, 1], [1.5, -0.5]]: norms 6 and 3.5.
        let factors = factor(2, &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((factors.reciprocal_condition() - 1.0 / 21.0).abs() < 1e-16);
        assert!(!factors.is_positive());
    }
}
