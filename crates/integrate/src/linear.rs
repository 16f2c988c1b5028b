//! Small systems of linear equations, real and complex, without allocation.

use nalgebra::Complex;
use std::ops::{Div, Mul, Sub};

/// Entry of a matrix.
pub(crate) trait Entry:
    Copy + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const ONE: Self;
    /// A size to compare pivots by.
    fn size(self) -> f64;
}

impl Entry for f64 {
    const ONE: Self = 1.0;
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Entry for Complex<f64> {
    const ONE: Self = Complex::new(1.0, 0.0);
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
}

/// A matrix factored by Gaussian elimination with row pivoting; the diagonal is inverted.
#[derive(Clone, Debug)]
pub(crate) struct Factors<T, const N: usize> {
    entries: [[T; N]; N],
    rows: [usize; N],
}

impl<T: Entry, const N: usize> Factors<T, N> {
    /// Of the matrix with these entries; `None` where it is singular or not finite.
    pub(crate) fn of(mut entries: [[T; N]; N]) -> Option<Self> {
        let mut rows: [usize; N] = std::array::from_fn(|i| i);
        for column in 0..N {
            let mut pivot = column;
            for row in column + 1..N {
                if entries[row][column].size() > entries[pivot][column].size() {
                    pivot = row;
                }
            }
            let size = entries[pivot][column].size();
            if size == 0.0 || !size.is_finite() {
                return None;
            }
            entries.swap(column, pivot);
            rows.swap(column, pivot);
            let inverse = T::ONE / entries[column][column];
            entries[column][column] = inverse;
            let upper = entries[column];
            for lower in &mut entries[column + 1..] {
                let factor = lower[column] * inverse;
                lower[column] = factor;
                for i in column + 1..N {
                    lower[i] = lower[i] - factor * upper[i];
                }
            }
        }
        Some(Self { entries, rows })
    }

    /// The solution for the right-hand side `b`.
    pub(crate) fn solve(&self, b: &[T; N]) -> [T; N] {
        let mut x: [T; N] = std::array::from_fn(|i| b[self.rows[i]]);
        for row in 1..N {
            for i in 0..row {
                x[row] = x[row] - self.entries[row][i] * x[i];
            }
        }
        for row in (0..N).rev() {
            for i in row + 1..N {
                x[row] = x[row] - self.entries[row][i] * x[i];
            }
            x[row] = x[row] * self.entries[row][row];
        }
        x
    }
}
