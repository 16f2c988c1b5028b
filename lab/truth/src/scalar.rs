//! Numbers of the independent model: precise ([`DoubleDouble`]), with derivatives ([`Dual`]), or quick (`f64`).
//!
//! [`DoubleDouble`]: crate::double_double::DoubleDouble
//! [`Dual`]: crate::dual::Dual

use crate::double_double::DoubleDouble;
use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number of some precision.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number `x`, exactly; with derivatives, a constant.
    fn constant(x: f64) -> Self;
    /// The nearest `f64`.
    fn value(self) -> f64;
    /// Returns whether products with the number may be left out: it and its derivatives are zero.
    fn is_zero(self) -> bool;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in rad.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the vector (x, y) in rad.
    fn atan2(y: Self, x: Self) -> Self;
}

impl Scalar for DoubleDouble {
    fn constant(x: f64) -> Self {
        Self::new(x)
    }

    fn value(self) -> f64 {
        DoubleDouble::value(self)
    }

    fn is_zero(self) -> bool {
        DoubleDouble::value(self) == 0.0
    }

    fn sqrt(self) -> Self {
        DoubleDouble::sqrt(self)
    }

    fn sin_cos(self) -> (Self, Self) {
        DoubleDouble::sin_cos(self)
    }

    fn atan2(y: Self, x: Self) -> Self {
        DoubleDouble::atan2(y, x)
    }
}

impl Scalar for f64 {
    fn constant(x: f64) -> Self {
        x
    }

    fn value(self) -> f64 {
        self
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }

    fn atan2(y: Self, x: Self) -> Self {
        f64::atan2(y, x)
    }
}

/// A vector in the plane.
pub type Plane<S> = [S; 2];

/// a . b.
pub fn dot<S: Scalar>(a: Plane<S>, b: Plane<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// a x b.
pub fn cross<S: Scalar>(a: Plane<S>, b: Plane<S>) -> S {
    a[0] * b[1] - a[1] * b[0]
}

/// a + b.
pub fn sum<S: Scalar>(a: Plane<S>, b: Plane<S>) -> Plane<S> {
    [a[0] + b[0], a[1] + b[1]]
}

/// a - b.
pub fn difference<S: Scalar>(a: Plane<S>, b: Plane<S>) -> Plane<S> {
    [a[0] - b[0], a[1] - b[1]]
}

/// factor v.
pub fn scaled<S: Scalar>(v: Plane<S>, factor: S) -> Plane<S> {
    [v[0] * factor, v[1] * factor]
}

/// v turned by `angle`.
pub fn turned<S: Scalar>(v: Plane<S>, angle: S) -> Plane<S> {
    let (sin, cos) = angle.sin_cos();
    [v[0] * cos - v[1] * sin, v[1] * cos + v[0] * sin]
}

/// Solves a x = b by Gaussian elimination with partial pivoting.
///
/// # Panics
/// When `a` is exactly singular.
pub fn solve<S: Scalar>(mut a: Vec<Vec<S>>, mut b: Vec<S>) -> Vec<S> {
    let size = b.len();
    for column in 0..size {
        let pivot = (column..size)
            .max_by(|&i, &j| {
                let size = |row: usize| a[row][column].value().abs();
                size(i).total_cmp(&size(j))
            })
            .expect("a row is left");
        assert!(
            a[pivot][column].value() != 0.0,
            "singular in column {column}"
        );
        a.swap(column, pivot);
        b.swap(column, pivot);
        let (above, below) = a.split_at_mut(column + 1);
        let pivot_row = &above[column];
        let inverse = S::constant(1.0) / pivot_row[column];
        for (offset, row) in below.iter_mut().enumerate() {
            if row[column].is_zero() {
                continue;
            }
            let factor = row[column] * inverse;
            for (entry, &above) in row.iter_mut().zip(pivot_row).skip(column) {
                if !above.is_zero() {
                    *entry = *entry - factor * above;
                }
            }
            b[column + 1 + offset] = b[column + 1 + offset] - factor * b[column];
        }
    }
    for row in (0..size).rev() {
        let known = (row + 1..size).fold(b[row], |known, column| {
            if a[row][column].is_zero() {
                known
            } else {
                known - a[row][column] * b[column]
            }
        });
        b[row] = known / a[row][row];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_where_pivoting_is_needed() {
        // A zero on the diagonal, and an entry that would swamp the others as a pivot.
        let a = [[0.0, 2.0, 1.0], [1e-30, 1.0, 1.0], [3.0, -1.0, 2.0]];
        let x = [1.5, -0.25, 4.0];
        let lift = |row: &[f64; 3]| row.map(DoubleDouble::constant).to_vec();
        let b = a
            .iter()
            .map(|row| {
                row.iter()
                    .zip(x)
                    .fold(DoubleDouble::constant(0.0), |sum, (&a, x)| {
                        sum + DoubleDouble::constant(a) * DoubleDouble::constant(x)
                    })
            })
            .collect();
        let solution = solve(a.iter().map(lift).collect(), b);
        for (found, x) in solution.into_iter().zip(x) {
            assert!((found - DoubleDouble::constant(x)).value().abs() < 1e-28);
        }
    }
}
