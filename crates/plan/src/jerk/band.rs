//! Linear equations of a matrix with five diagonals.

/// Symmetric matrix with five diagonals: each row from its diagonal on.
pub(super) type Band = Vec<[f64; 3]>;

/// Solves `matrix` s = `right` by Cholesky's method.
pub(super) fn solved(mut matrix: Band, right: &[f64]) -> Vec<f64> {
    let count = right.len();
    let mut solution = right.to_vec();
    for row in 0..count {
        let [pivot, next, last] = matrix[row];
        for (ahead, factor) in [(1, next / pivot), (2, last / pivot)] {
            if row + ahead >= count || factor == 0.0 {
                continue;
            }
            solution[row + ahead] -= factor * solution[row];
            let entries = if ahead == 1 {
                [next, last]
            } else {
                [last, 0.0]
            };
            matrix[row + ahead][0] -= factor * entries[0];
            matrix[row + ahead][1] -= factor * entries[1];
        }
    }
    for row in (0..count).rev() {
        let [pivot, next, last] = matrix[row];
        let ahead = |at: usize| solution.get(at).copied().unwrap_or(0.0);
        let rest = solution[row] - next * ahead(row + 1) - last * ahead(row + 2);
        solution[row] = rest / pivot;
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_banded_system_is_solved() {
        let matrix = vec![
            [4.0, 1.0, 0.5],
            [5.0, -1.0, 0.25],
            [6.0, 2.0, 0.0],
            [3.0, 0.0, 0.0],
        ];
        let x = [1.0, -2.0, 0.5, 3.0];
        let entry = |i: usize, j: usize| {
            let (row, ahead) = (i.min(j), i.abs_diff(j));
            matrix[row].get(ahead).copied().unwrap_or(0.0)
        };
        let right: Vec<f64> = (0..4)
            .map(|i| (0..4).map(|j| entry(i, j) * x[j]).sum())
            .collect();
        let found = solved(matrix.clone(), &right);
        for (found, x) in found.into_iter().zip(x) {
            assert!((found - x).abs() < 1e-14);
        }
    }
}
