//! Linear systems of a size known at run time: LU with partial pivoting. (The core's are sized at
//! compile time, since it does not allocate.)

/// Factors of a square matrix by rows: P A = L U.
pub(super) struct Factors {
    factors: Vec<Vec<f64>>,
    rows: Vec<usize>,
    /// Whether the rows were swapped an odd number of times.
    odd: bool,
    norm: f64,
}

/// Factors `matrix`; `None` where a pivot is zero or not finite.
pub(super) fn factor(matrix: Vec<Vec<f64>>) -> Option<Factors> {
    let size = matrix.len();
    let norm = norm(&matrix);
    let mut factors = matrix;
    let mut rows: Vec<usize> = (0..size).collect();
    let mut odd = false;
    for column in 0..size {
        let largest = (column..size).max_by(|&a, &b| {
            f64::total_cmp(&factors[a][column].abs(), &factors[b][column].abs())
        })?;
        if largest != column {
            factors.swap(largest, column);
            rows.swap(largest, column);
            odd = !odd;
        }
        let pivot = factors[column][column];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        let pivot_row = factors[column].clone();
        for row in factors.iter_mut().skip(column + 1) {
            let multiple = row[column] / pivot;
            row[column] = multiple;
            for (entry, above) in row.iter_mut().zip(&pivot_row).skip(column + 1) {
                *entry -= multiple * above;
            }
        }
    }
    Some(Factors {
        factors,
        rows,
        odd,
        norm,
    })
}

/// The largest absolute column sum.
fn norm(matrix: &[Vec<f64>]) -> f64 {
    (0..matrix.len())
        .map(|column| matrix.iter().map(|row| row[column].abs()).sum())
        .fold(0.0, f64::max)
}

impl Factors {
    /// x with A x = `b`.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.rows.iter().map(|&row| b[row]).collect();
        for row in 0..x.len() {
            let known: f64 = (0..row).map(|k| self.factors[row][k] * x[k]).sum();
            x[row] -= known;
        }
        for row in (0..x.len()).rev() {
            let known: f64 = (row + 1..x.len())
                .map(|k| self.factors[row][k] * x[k])
                .sum();
            x[row] = (x[row] - known) / self.factors[row][row];
        }
        x
    }

    /// Whether the determinant is positive.
    pub(super) fn is_positive(&self) -> bool {
        let negative = (0..self.rows.len()).filter(|&i| self.factors[i][i] < 0.0);
        (negative.count() % 2 == 1) == self.odd
    }

    /// 1 / (|A| |A^-1|) in the 1-norm: 1 at best, 0 for a singular matrix.
    pub(super) fn reciprocal_condition(&self) -> f64 {
        let size = self.rows.len();
        let inverse_norm = (0..size)
            .map(|column| {
                let unit: Vec<f64> = (0..size).map(|row| f64::from(row == column)).collect();
                self.solve(&unit).iter().map(|entry| entry.abs()).sum()
            })
            .fold(0.0, f64::max);
        1.0 / (self.norm * inverse_norm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_with_a_zero_on_the_diagonal() {
        let rows = [[0.0, 2.0, 1.0], [4.0, 1.0, 0.0], [2.0, 3.0, 5.0]];
        let x = [1.0, -2.0, 3.0];
        let b: Vec<f64> = rows
            .iter()
            .map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum())
            .collect();
        let factors = factor(rows.iter().map(|row| row.to_vec()).collect()).unwrap();
        for (found, x) in factors.solve(&b).iter().zip(x) {
            assert!((found - x).abs() < 1e-15, "{found} for {x}");
        }
        // By Sarrus: 0 (5 - 0) - 2 (20 - 0) + 1 (12 - 2) = -30.
        assert!(!factors.is_positive());
    }

    #[test]
    fn a_singular_matrix_has_no_factors_and_the_condition_shows_how_near_one_is() {
        assert!(factor(vec![vec![1.0, 2.0], vec![2.0, 4.0]]).is_none());
        assert!(factor(vec![vec![f64::NAN]]).is_none());
        // Inverse [[-2, 1], [1.5, -0.5]]: norms 6 and 3.5.
        let factors = factor(vec![vec![1.0, 2.0], vec![3.0, 4.0]]).unwrap();
        assert!((factors.reciprocal_condition() - 1.0 / 21.0).abs() < 1e-16);
        assert!(!factors.is_positive());
    }
}
