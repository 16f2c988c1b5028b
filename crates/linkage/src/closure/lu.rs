//! Small systems of linear equations: LU with partial pivoting.

use trirrr_core::number::Number;

/// A square matrix, by rows.
pub(super) type Matrix<N, const D: usize> = [[N; D]; D];

/// The factors of a matrix A: P A = L U.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lu<N, const D: usize> {
    /// U on and above the diagonal, L below it; the diagonal of L is 1.
    factors: Matrix<N, D>,
    /// The row of A that has become each row.
    rows: [usize; D],
}

/// The largest absolute column sum.
fn one_norm<N: Number, const D: usize>(matrix: &Matrix<N, D>) -> N {
    let mut largest = N::ZERO;
    for column in 0..D {
        let mut sum = N::ZERO;
        for row in matrix {
            sum += row[column].abs();
        }
        if sum > largest {
            largest = sum;
        }
    }
    largest
}

impl<N: Number, const D: usize> Lu<N, D> {
    /// Factors `matrix`; `None` when a pivot is zero or not a number.
    pub(super) fn new(matrix: &Matrix<N, D>) -> Option<Self> {
        let mut factors = *matrix;
        let mut rows: [usize; D] = core::array::from_fn(|row| row);
        for column in 0..D {
            let mut pivot = column;
            for row in column + 1..D {
                if factors[row][column].abs() > factors[pivot][column].abs() {
                    pivot = row;
                }
            }
            let size = factors[pivot][column];
            if !(size.abs() > N::ZERO && size.is_finite()) {
                return None;
            }
            factors.swap(pivot, column);
            rows.swap(pivot, column);
            let pivot_row = factors[column];
            for row in factors.iter_mut().skip(column + 1) {
                let multiple = row[column].div(size);
                row[column] = multiple;
                for k in column + 1..D {
                    row[k] -= multiple * pivot_row[k];
                }
            }
        }
        Some(Self { factors, rows })
    }

    /// x with A x = `b`.
    pub(super) fn solve(&self, b: &[N; D]) -> [N; D] {
        let mut x: [N; D] = core::array::from_fn(|row| b[self.rows[row]]);
        for row in 1..D {
            for k in 0..row {
                let known = x[k];
                x[row] -= self.factors[row][k] * known;
            }
        }
        for row in (0..D).rev() {
            for k in row + 1..D {
                let known = x[k];
                x[row] -= self.factors[row][k] * known;
            }
            x[row] = x[row].div(self.factors[row][row]);
        }
        x
    }

    /// The condition number |A| |A^-1| in the 1-norm of `matrix`, the matrix that was factored;
    /// the inverse is formed for it.
    pub(super) fn condition(&self, matrix: &Matrix<N, D>) -> N {
        let mut inverse_norm = N::ZERO;
        for column in 0..D {
            let mut unit = [N::ZERO; D];
            unit[column] = N::ONE;
            let mut sum = N::ZERO;
            for entry in self.solve(&unit) {
                sum += entry.abs();
            }
            if sum > inverse_norm {
                inverse_norm = sum;
            }
        }
        one_norm(matrix) * inverse_norm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_with_a_zero_on_the_diagonal() {
        let matrix = [[0.0, 2.0, 1.0], [4.0, 1.0, 0.0], [2.0, 3.0, 5.0]];
        let x = [1.0, -2.0, 3.0];
        let b = matrix.map(|row: [f64; 3]| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        let found = Lu::new(&matrix).unwrap().solve(&b);
        for (found, x) in found.iter().zip(x) {
            assert!((found - x).abs() < 1e-15, "{found} for {x}");
        }
    }

    #[test]
    fn condition_of_a_known_inverse() {
        // Inverse [[-2, 1], [1.5, -0.5]]: norms 6 and 3.5.
        let matrix: Matrix<f64, 2> = [[1.0, 2.0], [3.0, 4.0]];
        let condition = Lu::new(&matrix).unwrap().condition(&matrix);
        assert!((condition - 21.0).abs() < 1e-13, "{condition}");
        let identity: Matrix<f32, 2> = [[1.0, 0.0], [0.0, 1.0]];
        assert_eq!(Lu::new(&identity).unwrap().condition(&identity), 1.0);
    }

    #[test]
    fn refuses_singular_and_not_finite() {
        assert_eq!(Lu::new(&[[1.0, 2.0], [2.0, 4.0]]), None);
        assert_eq!(Lu::new(&[[0.0f32, 0.0], [0.0, 1.0]]), None);
        assert_eq!(Lu::new(&[[f64::NAN, 0.0], [0.0, 1.0]]), None);
        assert_eq!(Lu::new(&[[f64::INFINITY, 0.0], [0.0, 1.0]]), None);
    }
}
