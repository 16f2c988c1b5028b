//! Natural cubic splines.

use core::ops::{Add, Div, Mul, Sub};

/// A number or a vector.
pub trait SplineValue:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> + Div<f64, Output = Self>
{
}

impl<V> SplineValue for V where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V> + Div<f64, Output = V>
{
}

/// The natural cubic spline through `values`, which lie `spans` apart: for each span the coefficients c1, c2, c3 of
/// value + c1 p + c2 p^2 + c3 p^3, p from 0 to 1. The second derivative by the distance is continuous, and zero at both ends.
pub fn natural_spline<V: SplineValue>(spans: &[f64], values: &[V]) -> Vec<[V; 3]> {
    let Some(first) = values.first() else {
        return Vec::new();
    };
    let zero = *first * 0.0;
    let slope = |i: usize| (values[i + 1] - values[i]) / spans[i];
    // Second derivatives by elimination in one sweep and back.
    let count = values.len();
    let mut seconds = vec![zero; count];
    let mut factors = vec![0.0; count];
    for i in 1..count - 1 {
        let (before, after) = (spans[i - 1], spans[i]);
        let pivot = 2.0 * (before + after) - before * factors[i - 1];
        factors[i] = after / pivot;
        seconds[i] = ((slope(i) - slope(i - 1)) * 6.0 - seconds[i - 1] * before) / pivot;
    }
    for i in (1..count - 1).rev() {
        seconds[i] = seconds[i] - seconds[i + 1] * factors[i];
    }
    let coefficients = |i: usize| {
        let (h, a, b) = (spans[i], seconds[i], seconds[i + 1]);
        let tangent = slope(i) - (a * 2.0 + b) * (h / 6.0);
        [tangent * h, a * (0.5 * h * h), (b - a) * (h * h / 6.0)]
    };
    (0..count - 1).map(coefficients).collect()
}
