//! Motion of the platform from angles of the motors: poses by forward kinematics, then one smooth filter for everything.
//!
//! A Gaussian of width sigma is convolved with poses and torques alike; rates and accelerations are convolutions with its
//! derivatives. So the acceleration is that of the smoothed pose, and torques are smoothed as accelerations are: what the filter takes
//! away is missing on both sides of the equation.

use super::telemetry::JointSample;
use crate::closure::{LoopClosure, close};
use crate::columns::ColumnFault;
use crate::parameter::KinematicVector;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Pose, Setpoint};

/// Reach of the filter, in sigmas.
const REACH: f64 = 4.0;

/// Longest gap between two samples, in usual distances.
const LONGEST_GAP: f64 = 4.5;

/// Smoothed state at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmoothState {
    pub(crate) t: f64,
    pub(crate) setpoint: Setpoint<f64>,
    pub(crate) torques: [f64; 3],
}

/// Samples on an even grid without a gap: pose and torques.
struct EvenPart {
    start: f64,
    values: Vec<[f64; 6]>,
}

/// Usual distance of samples, s: the median.
pub(crate) fn period_of(samples: &[JointSample]) -> f64 {
    let mut steps: Vec<f64> = samples
        .windows(2)
        .map(|pair| pair[1].t - pair[0].t)
        .collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// Poses of the samples, each from the one before; the first from `start`.
///
/// # Errors
/// The first line whose angles fit no pose near the one before.
pub(crate) fn poses(
    values: &KinematicVector,
    start: [f64; 3],
    samples: &[JointSample],
) -> Result<Vec<[f64; 3]>, ColumnFault> {
    let mut before: Option<LoopClosure> = None;
    let each = samples.iter().map(|sample| {
        let guess = before.map_or(start, |before| before.pose);
        let found = close(values, &sample.angles_rad, guess);
        let is_same = |found: &LoopClosure| before.is_none_or(|before| before.side == found.side);
        let found = found.filter(is_same).ok_or_else(|| {
            let [a, b, c] = sample.angles_rad;
            let reason = format!(
                "the scene's machine has no pose near the one before at the angles {a}, {b}, {c} rad; is the table one of this scene?"
            );
            ColumnFault::of_line(sample.line, reason)
        })?;
        before = Some(found);
        Ok(found.pose)
    });
    each.collect()
}

/// Samples between gaps, on an even grid by linear interpolation.
fn even_parts(samples: &[JointSample], poses: &[[f64; 3]], period: f64) -> Vec<EvenPart> {
    let value = |index: usize| {
        let ([x, y, alpha], [a, b, c]) = (poses[index], samples[index].torques_nm);
        [x, y, alpha, a, b, c]
    };
    let mut parts = Vec::new();
    let mut first = 0;
    for last in 0..samples.len() {
        let is_end = last + 1 == samples.len()
            || samples[last + 1].t - samples[last].t > LONGEST_GAP * period;
        if !is_end {
            continue;
        }
        let (start, end) = (samples[first].t, samples[last].t);
        let mut at = first;
        let count = ((end - start) / period + 1e-6).floor() as usize;
        let values = (0..=count).map(|step| {
            let t = start + step as f64 * period;
            while at + 1 < last && samples[at + 1].t <= t {
                at += 1;
            }
            let next = (at + 1).min(last);
            let span = samples[next].t - samples[at].t;
            let part = if span > 0.0 {
                ((t - samples[at].t) / span).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let (low, high) = (value(at), value(next));
            std::array::from_fn(|index| low[index] + part * (high[index] - low[index]))
        });
        let values = values.collect();
        parts.push(EvenPart { start, values });
        first = last + 1;
    }
    parts
}

/// Weights of the smoothed value and its first two derivatives.
struct Kernel {
    half: usize,
    weights: [Vec<f64>; 3],
}

impl Kernel {
    fn new(sigma: f64, period: f64) -> Self {
        let half = (REACH * sigma / period).ceil().max(2.0) as usize;
        let offsets = (0..=2 * half).map(|index| (index as f64 - half as f64) * period);
        let offsets: Vec<f64> = offsets.collect();
        let bell = |t: f64| (-0.5 * (t / sigma).powi(2)).exp();
        let plain: Vec<f64> = offsets.iter().map(|t| bell(*t)).collect();
        let sum: f64 = plain.iter().sum();
        let plain: Vec<f64> = plain.iter().map(|weight| weight / sum).collect();
        // A value at t + s weighs as the bell at s: the derivatives change their sign once and twice. Moments are made exact for the sum.
        let first: Vec<f64> = offsets.iter().zip(&plain).map(|(t, w)| t * w).collect();
        let slope: f64 = offsets.iter().zip(&first).map(|(t, w)| t * w).sum();
        let first = first.iter().map(|weight| weight / slope).collect();
        let second: Vec<f64> = offsets
            .iter()
            .zip(&plain)
            .map(|(t, w)| (t * t - slope) * w)
            .collect();
        let curvature: f64 = offsets
            .iter()
            .zip(&second)
            .map(|(t, w)| 0.5 * t * t * w)
            .sum();
        let second = second.iter().map(|weight| weight / curvature).collect();
        Self {
            half,
            weights: [plain, first, second],
        }
    }

    fn apply(&self, values: &[[f64; 6]], middle: usize, derivative: usize) -> [f64; 6] {
        let window = &values[middle - self.half..=middle + self.half];
        let mut sum = [0.0; 6];
        for (value, weight) in window.iter().zip(&self.weights[derivative]) {
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += weight * value;
            }
        }
        sum
    }
}

/// Smoothed states of all instants that the filter covers.
pub(crate) fn smooth(
    samples: &[JointSample],
    poses: &[[f64; 3]],
    sigma: f64,
    period: f64,
) -> Vec<SmoothState> {
    let kernel = Kernel::new(sigma, period);
    let mut states = Vec::new();
    for part in even_parts(samples, poses, period) {
        let count = part.values.len();
        for middle in kernel.half..count.saturating_sub(kernel.half) {
            let [plain, first, second] =
                [0, 1, 2].map(|derivative| kernel.apply(&part.values, middle, derivative));
            let triple = |of: [f64; 6]| Vector3::new(of[0], of[1], of[2]);
            states.push(SmoothState {
                t: part.start + middle as f64 * period,
                setpoint: Setpoint {
                    pose: Pose::from_f64(plain[0], plain[1], plain[2]),
                    velocity: triple(first),
                    acceleration: triple(second),
                },
                torques: [plain[3], plain[4], plain[5]],
            });
        }
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_parabola_are_exact_over_a_gap() {
        let period = 0.002;
        let at = |t: f64| [0.1 + 0.3 * t - 0.2 * t * t, 0.5 * t * t, -t];
        let times = (0..400).map(|index| f64::from(index) * period);
        let times: Vec<f64> = times.filter(|t| !(0.3..0.35).contains(t)).collect();
        let samples: Vec<JointSample> = times
            .iter()
            .map(|t| JointSample {
                line: 1,
                t: *t,
                angles_rad: [0.0; 3],
                torques_nm: [*t; 3],
            })
            .collect();
        let poses: Vec<[f64; 3]> = times.iter().map(|t| at(*t)).collect();
        assert!((period_of(&samples) - period).abs() < 1e-12);
        let states = smooth(&samples, &poses, 0.01, period);
        assert!(states.len() > 250);
        for state in states {
            assert!(!(0.262..0.388).contains(&state.t), "{}", state.t);
            let (v, a) = (state.setpoint.velocity, state.setpoint.acceleration);
            assert!((v.x - (0.3 - 0.4 * state.t)).abs() < 1e-9, "{v}");
            assert!((a.x + 0.4).abs() < 1e-7 && (a.y - 1.0).abs() < 1e-7, "{a}");
            assert!((v.z + 1.0).abs() < 1e-9 && (state.torques[1] - state.t).abs() < 1e-9);
        }
    }
}
