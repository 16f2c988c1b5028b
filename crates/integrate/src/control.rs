//! Control of the step by the estimated error.

use crate::system::System;

/// The largest of the errors, each relative to what is tolerated of its variable: up to 1 it is
/// accepted. Not a number where an error is none.
pub(crate) fn norm<const N: usize>(
    error: &[f64; N],
    before: &[f64; N],
    after: &[f64; N],
    scales: &[f64; N],
    tolerance: f64,
) -> f64 {
    let mut largest = 0.0;
    for i in 0..N {
        let size = scales[i].max(before[i].abs()).max(after[i].abs());
        let relative = error[i].abs() / (tolerance * size);
        // What is not a number stays: nothing is greater than it.
        if relative > largest || relative.is_nan() {
            largest = relative;
        }
    }
    largest
}

/// First step for a method of order `order` (Hairer, Norsett, Wanner, *Solving Ordinary
/// Differential Equations I*, II.4), from the derivative `slope` at the start and one more.
pub(crate) fn first_step<const N: usize, S: System<N>>(
    system: &S,
    (t, y, slope): (f64, &[f64; N], &[f64; N]),
    end: f64,
    scales: &[f64; N],
    (tolerance, order): (f64, f64),
) -> f64 {
    let rest = end - t;
    let size = norm(y, y, y, scales, tolerance);
    let speed = norm(slope, y, y, scales, tolerance);
    let guess = if size < 1e-5 || speed < 1e-5 {
        1e-6 * rest
    } else {
        0.01 * size / speed
    };
    let guess = guess.min(rest);
    let there: [f64; N] = std::array::from_fn(|i| y[i] + guess * slope[i]);
    let mut later = [0.0; N];
    if system.derivative(t + guess, &there, &mut later).is_err() {
        return guess;
    }
    let change: [f64; N] = std::array::from_fn(|i| later[i] - slope[i]);
    let curvature = norm(&change, y, y, scales, tolerance) / guess;
    let steepest = speed.max(curvature);
    let step = if steepest <= 1e-15 {
        (guess * 1e-3).max(1e-6 * rest)
    } else {
        (0.01 / steepest).powf(1.0 / (order + 1.0))
    };
    // The comparison also turns away what is not a number.
    if step > 0.0 {
        step.min(100.0 * guess).min(rest)
    } else {
        guess
    }
}

/// The step to take now, given the one that the error allows: two equal steps rather than a whole
/// one and a rest. `true` where it reaches the end.
pub(crate) fn fit(step: f64, t: f64, end: f64) -> (f64, bool) {
    let rest = end - t;
    if step >= rest * (1.0 - 1e-9) {
        (rest, true)
    } else if 2.0 * step >= rest {
        (0.5 * rest, false)
    } else {
        (step, false)
    }
}
