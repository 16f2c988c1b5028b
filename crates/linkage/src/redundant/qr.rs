//! QR factorisation (Householder, column pivoting) of a matrix with one row for each leg and at
//! most as many columns. In any number type of the core, which is why no library does it.

use trirrr_core::number::Number;

/// H = I - beta v v^T.
#[derive(Clone, Copy)]
struct Reflection<N, const ROWS: usize> {
    v: [N; ROWS],
    beta: N,
}

/// Factors Q \[R; 0\] of a matrix, with the columns in the order of elimination.
pub(super) struct Qr<N, const ROWS: usize> {
    reflections: [Reflection<N, ROWS>; ROWS],
    /// Column `j` of R, in the order of elimination.
    r: [[N; ROWS]; ROWS],
    /// Index of the column eliminated in each step.
    order: [usize; ROWS],
    columns: usize,
}

pub(super) fn dot<N: Number, const ROWS: usize>(a: &[N; ROWS], b: &[N; ROWS]) -> N {
    let mut sum = N::ZERO;
    for (&a, &b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

impl<N: Number, const ROWS: usize> Reflection<N, ROWS> {
    fn apply(&self, x: &mut [N; ROWS]) {
        let along = self.beta * dot(&self.v, x);
        for (x, &v) in x.iter_mut().zip(&self.v) {
            *x -= along * v;
        }
    }
}

impl<N: Number, const ROWS: usize> Qr<N, ROWS> {
    /// Qr the first `columns` of `matrix`, which is given by columns.
    pub(super) fn new(mut matrix: [[N; ROWS]; ROWS], columns: usize) -> Self {
        let none = Reflection {
            v: [N::ZERO; ROWS],
            beta: N::ZERO,
        };
        let mut reflections = [none; ROWS];
        let mut order = core::array::from_fn(|column| column);
        for step in 0..columns {
            let mut largest = (step, -N::ONE);
            for (column, entries) in matrix.iter().enumerate().take(columns).skip(step) {
                let mut left = N::ZERO;
                for &entry in &entries[step..] {
                    left += entry * entry;
                }
                if left > largest.1 {
                    largest = (column, left);
                }
            }
            matrix.swap(step, largest.0);
            order.swap(step, largest.0);
            let length = largest.1.sqrt();
            // A column that is zero is left as it is: R has a zero there.
            if !(length > N::ZERO) {
                continue;
            }
            let first = matrix[step][step];
            let signed = if first < N::ZERO { -length } else { length };
            let mut v = [N::ZERO; ROWS];
            v[step..].copy_from_slice(&matrix[step][step..]);
            v[step] = first + signed;
            let reflection = Reflection {
                v,
                beta: N::ONE.div(signed * v[step]),
            };
            for column in &mut matrix[step..columns] {
                reflection.apply(column);
            }
            reflections[step] = reflection;
        }
        Self {
            reflections,
            r: matrix,
            order,
            columns,
        }
    }

    /// Q^T x.
    pub(super) fn in_q(&self, mut x: [N; ROWS]) -> [N; ROWS] {
        for reflection in &self.reflections[..self.columns] {
            reflection.apply(&mut x);
        }
        x
    }

    /// Q x.
    pub(super) fn of_q(&self, mut x: [N; ROWS]) -> [N; ROWS] {
        for reflection in self.reflections[..self.columns].iter().rev() {
            reflection.apply(&mut x);
        }
        x
    }

    /// The product of the diagonal of R: for a square root of the determinant of M^T M.
    pub(super) fn volume(&self) -> N {
        let mut product = N::ONE;
        for step in 0..self.columns {
            product *= self.r[step][step].abs();
        }
        product
    }

    /// Returns the solution of least norm of M^T x = w, for an M of full rank.
    pub(super) fn least_norm(&self, w: &[N; ROWS]) -> [N; ROWS] {
        let mut y = [N::ZERO; ROWS];
        for step in 0..self.columns {
            let mut left = w[self.order[step]];
            for (&r, &y) in self.r[step][..step].iter().zip(&y) {
                left -= r * y;
            }
            y[step] = left.div(self.r[step][step]);
        }
        self.of_q(y)
    }

    /// Returns the z that minimises |M z - x|. It has no part along directions in which M is zero
    /// to rounding.
    pub(super) fn least_squares(&self, x: [N; ROWS]) -> [N; ROWS] {
        let y = self.in_q(x);
        let mut z = [N::ZERO; ROWS];
        if self.columns == 0 {
            return z;
        }
        let rows = N::from_f64(ROWS as f64);
        let least = rows * (N::UNIT_ROUNDOFF * self.r[0][0].abs());
        for step in (0..self.columns).rev() {
            let diagonal = self.r[step][step];
            if !(diagonal.abs() > least) {
                continue;
            }
            let mut left = y[step];
            for after in step + 1..self.columns {
                left -= self.r[after][step] * z[self.order[after]];
            }
            z[self.order[step]] = left.div(diagonal);
        }
        z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: [[f64; 4]; 4] = [
        [1.0, 2.0, -1.0, 0.5],
        [0.0, 3.0, 1.0, -2.0],
        [2.0, -1.0, 0.25, 1.0],
        [0.0; 4],
    ];

    #[test]
    fn least_norm_solves_and_lies_in_the_columns() {
        let factors = Qr::new(M, 3);
        let w = [0.3, -1.2, 2.5, 0.0];
        let x = factors.least_norm(&w);
        for (column, w) in M.iter().zip(w).take(3) {
            assert!((dot(column, &x) - w).abs() < 1e-15);
        }
        // Across from the null space, which is the last column of Q.
        let null = factors.of_q([0.0, 0.0, 0.0, 1.0]);
        assert!(dot(&null, &x).abs() < 1e-15 && (dot(&null, &null) - 1.0).abs() < 1e-15);
        for column in &M[..3] {
            assert!(dot(column, &null).abs() < 1e-15);
        }
    }

    #[test]
    fn least_squares_leaves_what_is_across() {
        let factors = Qr::new(M, 2);
        let x = [1.0, -0.5, 0.25, 3.0];
        let z = factors.least_squares(x);
        let left: [f64; 4] =
            core::array::from_fn(|row| x[row] - M[0][row] * z[0] - M[1][row] * z[1]);
        assert!(dot(&left, &M[0]).abs() < 1e-14 && dot(&left, &M[1]).abs() < 1e-14);
        // A column that is there twice, and one that is zero, get a finite answer.
        for twice in [[M[0], M[0], M[3], M[3]], [M[3], M[0], M[3], M[3]]] {
            let z = Qr::new(twice, 2).least_squares(x);
            let sum = z[0] + z[1];
            let alone = dot(&M[0], &x) / dot(&M[0], &M[0]);
            assert!(z.iter().all(|z| z.is_finite()));
            assert!((if twice[0] == M[3] { z[1] } else { sum } - alone).abs() < 1e-14);
        }
    }

    #[test]
    fn volume_is_that_of_the_columns() {
        // |a x b| of two columns, by the sum of the squares of their minors.
        let (a, b) = (M[0], M[1]);
        let mut sum = 0.0;
        for i in 0..4 {
            for j in i + 1..4 {
                let minor: f64 = a[i] * b[j] - a[j] * b[i];
                sum += minor * minor;
            }
        }
        let volume = Qr::new(M, 2).volume();
        assert!((volume - sum.sqrt()).abs() < 1e-14, "{volume}");
    }
}
