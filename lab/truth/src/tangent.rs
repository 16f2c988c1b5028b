//! Numbers that carry one derivative, over numbers of any kind: nested, they carry derivatives of higher order.

use crate::scalar::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its derivative along one direction.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<S> {
    /// The value.
    pub value: S,
    /// Its derivative.
    pub slope: S,
}

impl<S: Scalar> Tangent<S> {
    /// Number that does not change along the direction.
    pub fn still(value: S) -> Self {
        let slope = S::constant(0.0);
        Self { value, slope }
    }
}

impl<S: Scalar> Add for Tangent<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl<S: Scalar> Sub for Tangent<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slope: self.slope - other.slope,
        }
    }
}

impl<S: Scalar> Neg for Tangent<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slope: -self.slope,
        }
    }
}

impl<S: Scalar> Mul for Tangent<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: match (self.slope.is_zero(), other.slope.is_zero()) {
                (true, true) => S::constant(0.0),
                (true, false) => self.value * other.slope,
                (false, true) => self.slope * other.value,
                (false, false) => self.slope * other.value + self.value * other.slope,
            },
        }
    }
}

impl<S: Scalar> Div for Tangent<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}

impl<S: Scalar> Scalar for Tangent<S> {
    fn constant(x: f64) -> Self {
        Self::still(S::constant(x))
    }

    fn value(self) -> f64 {
        self.value.value()
    }

    fn is_zero(self) -> bool {
        self.value.is_zero() && self.slope.is_zero()
    }

    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self {
            value,
            slope: self.slope / (value + value),
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (
            Self {
                value: sin,
                slope: cos * self.slope,
            },
            Self {
                value: cos,
                slope: -(sin * self.slope),
            },
        )
    }

    fn atan2(y: Self, x: Self) -> Self {
        let square = x.value * x.value + y.value * y.value;
        Self {
            value: S::atan2(y.value, x.value),
            slope: (x.value * y.slope - y.value * x.slope) / square,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::double_double::DoubleDouble;

    /// Number with three derivatives, each along x: a polynomial of Taylor.
    type Third = Tangent<Tangent<Tangent<DoubleDouble>>>;

    fn variable(x: f64) -> Third {
        let one = |value: DoubleDouble| Tangent {
            value,
            slope: DoubleDouble::new(1.0),
        };
        let second = Tangent {
            value: one(DoubleDouble::new(x)),
            slope: Tangent::constant(1.0),
        };
        Tangent {
            value: second,
            slope: Tangent::constant(1.0),
        }
    }

    #[test]
    fn nested_derivatives_are_those_of_the_functions() {
        let x = variable(0.7);
        let third = |it: Third| it.slope.slope.slope.value();
        let (sin, cos) = 0.7f64.sin_cos();
        assert!((third(x.sin_cos().0) + cos).abs() < 1e-15);
        assert!((third(x.sin_cos().1) - sin).abs() < 1e-15);
        assert!((third(x * x * x) - 6.0).abs() < 1e-14);
        assert!((third(x.sqrt()) - 0.375 * 0.7f64.powf(-2.5)).abs() < 1e-14);
        let one = Third::constant(1.0);
        assert!((third(one / x) + 6.0 / 0.7f64.powi(4)).abs() < 1e-12);
        // atan''' = (6 x^2 - 2) / (1 + x^2)^3.
        let expected = (6.0 * 0.49 - 2.0) / 1.49f64.powi(3);
        assert!((third(Third::atan2(x, one)) - expected).abs() < 1e-14);
    }

    #[test]
    fn a_number_that_stands_still_has_no_derivative() {
        let still = Tangent::still(DoubleDouble::new(2.0));
        assert!((still * still).slope.is_zero() && !still.is_zero());
        assert!(Tangent::<DoubleDouble>::constant(0.0).is_zero());
    }
}
