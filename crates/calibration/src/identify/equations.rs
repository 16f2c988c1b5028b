//! Equations for the torques of joints that slide.

use super::bodies::{BODY_COUNT, BodyGroup, BodyVector};
use super::motion::SmoothState;
use super::regressor::UnitMachines;
use super::result::IdentificationSetup;

/// Blocks of time in which residuals belong together.
pub(super) const BLOCKS: usize = 40;

/// Reach of the filter around a joint that reverses, in its widths.
const AROUND_REVERSAL: f64 = 3.0;

/// An equation for the torque of a motor at an instant.
pub(super) struct TorqueEquation {
    pub(super) t: f64,
    pub(super) motor: usize,
    pub(super) slopes: [f64; BODY_COUNT],
    /// Measured torque less that of the wrench.
    pub(super) torque: f64,
    pub(super) block: usize,
}

/// Equations of joints that slide.
pub(super) fn equations(
    machines: &UnitMachines,
    states: &[SmoothState],
    setup: &IdentificationSetup,
    width_s: f64,
) -> Vec<TorqueEquation> {
    let rows: Vec<_> = states
        .iter()
        .map(|state| machines.rows(&state.setpoint))
        .collect();
    let with_joints = setup.free.contains(&BodyGroup::Joints);
    let with_motors = setup.free.contains(&BodyGroup::Motors);
    // Instants at which a joint stands or reverses: its friction is between both signs, and the filter spreads that.
    let stands = |kind: usize, joint: usize| -> Vec<f64> {
        let each = states.iter().zip(&rows).filter_map(|(state, rows)| {
            let rate = rows.as_ref()?.rates[kind][joint];
            (rate.abs() < setup.sliding_rad_s).then_some(state.t)
        });
        each.collect()
    };
    let is_near = |times: &[f64], t: f64| {
        let reach = AROUND_REVERSAL * width_s;
        let first = times.partition_point(|time| *time < t - reach);
        times.get(first).is_some_and(|time| *time <= t + reach)
    };
    let motors = [0, 1, 2].map(|joint| stands(0, joint));
    let others: Vec<Vec<f64>> = match with_joints {
        true => (1..3)
            .flat_map(|kind| (0..3).map(move |joint| (kind, joint)))
            .map(|(kind, joint)| stands(kind, joint))
            .collect(),
        false => Vec::new(),
    };
    let (begin, end) = match (states.first(), states.last()) {
        (Some(first), Some(last)) => (first.t, last.t),
        _ => return Vec::new(),
    };
    let block = |t: f64| ((t - begin) / (end - begin).max(1e-9) * BLOCKS as f64) as usize;
    let mut equations = Vec::new();
    for (state, rows) in states.iter().zip(&rows) {
        let Some(rows) = rows else {
            continue;
        };
        if others.iter().any(|times| is_near(times, state.t)) {
            continue;
        }
        for (motor, reversals) in motors.iter().enumerate() {
            if with_motors && is_near(reversals, state.t) {
                continue;
            }
            equations.push(TorqueEquation {
                t: state.t,
                motor,
                slopes: rows.slopes[motor],
                torque: state.torques[motor] - rows.known[motor],
                block: block(state.t).min(BLOCKS - 1),
            });
        }
    }
    equations
}

impl TorqueEquation {
    pub(super) fn by(&self, values: &BodyVector) -> f64 {
        let parts = self.slopes.iter().zip(&values.0);
        parts.map(|(slope, value)| slope * value).sum()
    }
}

pub(super) fn rms(equations: &[&TorqueEquation], values: &BodyVector) -> f64 {
    let squares = equations.iter().map(|equation| {
        let off = equation.torque - equation.by(values);
        off * off
    });
    (squares.sum::<f64>() / equations.len().max(1) as f64).sqrt()
}
