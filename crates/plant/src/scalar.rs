//! Numbers of the equations: binary64, or binary64 with derivatives.
//!
//! The equations are written once, over [`Differentiable`]. With [`Dual`] numbers they give their own
//! Jacobian, exact but for rounding.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the equations.
pub trait Differentiable:
    Copy
    + Debug
    + Default
    + PartialEq
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Mul<f64, Output = Self>
    + 'static
{
    /// The value without derivatives.
    fn value(self) -> f64;

    /// A function's `value`, and its partial derivatives by `arguments`: pairs of both.
    fn function<const K: usize>(value: f64, arguments: [(f64, Self); K]) -> Self;

    /// Sine and cosine.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = <f64 as trirrr_core::number::Arithmetic>::sin_cos(self.value());
        (
            Self::function(sin, [(cos, self)]),
            Self::function(cos, [(-sin, self)]),
        )
    }
}

impl Differentiable for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn function<const K: usize>(value: f64, _: [(f64, Self); K]) -> Self {
        value
    }
}

/// Dual number: a value and its derivatives by `N` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Its derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// `values` as variables: each has a derivative of 1 by itself.
    pub fn variables(values: &[f64; N]) -> [Self; N] {
        std::array::from_fn(|i| {
            let mut variable = Self::from(values[i]);
            variable.slopes[i] = 1.0;
            variable
        })
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    #[inline]
    fn from(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; N],
        }
    }
}

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self::from(0.0)
    }
}

impl<const N: usize> Differentiable for Dual<N> {
    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn function<const K: usize>(value: f64, arguments: [(f64, Self); K]) -> Self {
        let mut slopes = [0.0; N];
        for (partial, argument) in &arguments {
            for (slope, own) in slopes.iter_mut().zip(&argument.slopes) {
                *slope += partial * own;
            }
        }
        Self { value, slopes }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::function(-self.value, [(-1.0, self)])
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::function(self.value + other.value, [(1.0, self), (1.0, other)])
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::function(self.value - other.value, [(1.0, self), (-1.0, other)])
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        Self::function(value, [(other.value, self), (self.value, other)])
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self::function(self.value * factor, [(factor, self)])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let value = self.value * inverse;
        Self::function(value, [(inverse, self), (-value * inverse, other)])
    }
}
