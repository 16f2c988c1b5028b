//! Numbers that carry their derivatives against all inputs of a machine: exact condition numbers,
//! also where finite differences would step over a singularity.

use crate::scalar::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Number of inputs of a machine with a state: 13 of each leg, 4 of the platform, 5 of the loads,
/// 9 of the state.
pub const INPUTS: usize = 3 * 13 + 4 + 5 + 9;

/// A value and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    value: f64,
    gradient: [f64; INPUTS],
}

impl Dual {
    /// Input number `index`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; INPUTS];
        gradient[index] = 1.0;
        Self { value, gradient }
    }

    /// sum |dq/dp_j| size_j: how far the value moves when each input p_j moves by its size.
    pub fn sensitivity(&self, sizes: &[f64]) -> f64 {
        assert_eq!(sizes.len(), INPUTS);
        self.gradient
            .iter()
            .zip(sizes)
            .map(|(d, size)| (d * size).abs())
            .sum()
    }

    /// The result of an operation with value `value` and derivatives `a_slope`, `b_slope`.
    fn combine(self, other: Self, value: f64, a_slope: f64, b_slope: f64) -> Self {
        let mut gradient = self.gradient;
        for (a, b) in gradient.iter_mut().zip(other.gradient) {
            *a = *a * a_slope + b * b_slope;
        }
        Self { value, gradient }
    }

    fn map(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            gradient: self.gradient.map(|d| d * slope),
        }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.combine(other, quotient, 1.0 / other.value, -quotient / other.value)
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0; INPUTS],
        }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn is_zero(self) -> bool {
        self.value == 0.0 && self.gradient.iter().all(|&d| d == 0.0)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, 0.5 / root)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.map(sin, cos), self.map(cos, -sin))
    }

    fn atan2(y: Self, x: Self) -> Self {
        let square = x.value * x.value + y.value * y.value;
        let angle = y.value.atan2(x.value);
        y.combine(x, angle, x.value / square, -y.value / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation against central differences, whose error is about 1e-10 at this step.
    #[test]
    fn derivatives_are_those_of_finite_differences() {
        fn all<S: Scalar>(x: S, y: S) -> S {
            let (sin, cos) = (x * y).sin_cos();
            S::atan2(sin - y, cos + x) / (x + y.sqrt()) - -cos
        }
        let (x, y, step) = (0.7, 1.3, 1e-5);
        let at = all(Dual::variable(x, 0), Dual::variable(y, 1));
        let value = |x, y| all(Dual::constant(x), Dual::constant(y)).value();
        let slopes = [
            (value(x + step, y) - value(x - step, y)) / (2.0 * step),
            (value(x, y + step) - value(x, y - step)) / (2.0 * step),
        ];
        for (exact, difference) in at.gradient.iter().zip(slopes) {
            assert!((exact - difference).abs() < 1e-9, "{exact} {difference}");
        }
    }
}
