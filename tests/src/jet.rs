//! Numbers that carry three derivatives by time: power series to the third order.

use crate::scalar::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Coefficients of 1, t, t^2 and t^3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet([f64; 4]);

impl Jet {
    /// From a value and its derivatives.
    pub fn from_derivatives([value, first, second, third]: [f64; 4]) -> Self {
        Self([value, first, second / 2.0, third / 6.0])
    }

    /// The value and its derivatives.
    pub fn derivatives(self) -> [f64; 4] {
        let [value, first, second, third] = self.0;
        [value, first, 2.0 * second, 6.0 * third]
    }

    /// f of the series, from f and its three derivatives at the value.
    fn map(self, [f, first, second, third]: [f64; 4]) -> Self {
        let [_, a, b, c] = self.0;
        Self([
            f,
            first * a,
            first * b + second * a * a / 2.0,
            first * c + second * a * b + third * a * a * a / 6.0,
        ])
    }

    /// Integral of the series from `start`: its last coefficient is lost.
    fn integral(self, start: f64) -> Self {
        let [a, b, c, _] = self.0;
        Self([start, a, b / 2.0, c / 3.0])
    }

    fn derivative(self) -> Self {
        let [_, a, b, c] = self.0;
        Self([a, 2.0 * b, 3.0 * c, 0.0])
    }

    fn each(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self([0, 1, 2, 3].map(|index: usize| of(self.0[index], other.0[index])))
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut product = [0.0; 4];
        for (i, a) in self.0.into_iter().enumerate() {
            for (j, b) in other.0.into_iter().enumerate().take(4 - i) {
                product[i + j] += a * b;
            }
        }
        Self(product)
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let x = other.0[0];
        let inverse = 1.0 / x;
        let second = inverse * inverse * inverse;
        self * other.map([
            inverse,
            -inverse * inverse,
            2.0 * second,
            -6.0 * second * inverse,
        ])
    }
}

impl Scalar for Jet {
    fn constant(x: f64) -> Self {
        Self([x, 0.0, 0.0, 0.0])
    }

    fn value(self) -> f64 {
        self.0[0]
    }

    fn is_zero(self) -> bool {
        self.0 == [0.0; 4]
    }

    fn sqrt(self) -> Self {
        let x = self.0[0];
        let root = x.sqrt();
        let first = 0.5 / root;
        self.map([root, first, -0.5 * first / x, 0.75 * first / (x * x)])
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sin_cos();
        (
            self.map([sin, cos, -sin, -cos]),
            self.map([cos, -sin, -cos, sin]),
        )
    }

    /// The integral of (x y' - y x') / (x^2 + y^2).
    fn atan2(y: Self, x: Self) -> Self {
        let slope = (x * y.derivative() - y * x.derivative()) / (x * x + y * y);
        slope.integral(y.0[0].atan2(x.0[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation along a path, against differences whose error is about 1e-7 at this step.
    #[test]
    fn derivatives_are_those_of_finite_differences() {
        fn all<S: Scalar>(x: S, y: S) -> S {
            let (sin, cos) = (x * y).sin_cos();
            S::atan2(sin - y, cos + x) / (x + y.sqrt()) - -cos
        }
        let along = |t: f64| all(0.7 + t - 0.3 * t * t * t, 1.3 - 0.5 * t + t * t);
        let jet = all(
            Jet::from_derivatives([0.7, 1.0, 0.0, -1.8]),
            Jet::from_derivatives([1.3, -0.5, 2.0, 0.0]),
        );
        let third = |h: f64| {
            let [a, b, c, d] = [-2.0 * h, -h, h, 2.0 * h].map(along);
            (d - 2.0 * c + 2.0 * b - a) / (2.0 * h * h * h)
        };
        let differences = [
            along(0.0),
            (along(1e-5) - along(-1e-5)) / 2e-5,
            (along(1e-4) - 2.0 * along(0.0) + along(-1e-4)) / 1e-8,
            (4.0 * third(2e-3) - third(4e-3)) / 3.0,
        ];
        for (exact, difference) in jet.derivatives().into_iter().zip(differences) {
            assert!((exact - difference).abs() < 1e-5, "{exact} {difference}");
        }
    }
}
