//! The worst of a job.

use crate::analysis::{TimeSpan, ToolError};
use trirrr_core::limits::LimitParameters as Limits;

/// The worst intervals of a job.
#[derive(Clone, Copy, Debug, Default)]
pub struct WorstCase {
    /// Interval with the greatest error of the position, and the error.
    pub distance: Option<(TimeSpan, ToolError)>,
    /// Interval with the greatest error of the angle, and the error.
    pub angle: Option<(TimeSpan, ToolError)>,
    /// Greatest torque of each motor, N m, and its interval.
    pub torques: [Option<Margin>; 3],
    /// Greatest rate of each motor, rad/s, and its interval.
    pub rates: [Option<Margin>; 3],
    /// First interval without a bound of the error at the tool.
    pub not_bounded: Option<TimeSpan>,
    /// First interval without a bound of the torques, in a scene that has torques.
    pub torque_not_bounded: Option<TimeSpan>,
}

/// Greatest size of a quantity of a motor.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    /// Bound of the size.
    pub size: f64,
    /// Limit of the scene, if it gives one.
    pub limit: Option<f64>,
    /// The interval.
    pub span: TimeSpan,
}

impl Margin {
    /// Limit less bound: not negative where the limit is kept for certain.
    pub fn margin(&self) -> Option<f64> {
        self.limit.map(|limit| limit - self.size)
    }
}

impl WorstCase {
    /// Takes the next interval of a job with these `limits`; `torque`: the scene computes torques.
    pub fn note(&mut self, span: &TimeSpan, limits: &Limits, torque: bool) {
        if let Some(tool) = span.tool {
            note_error(&mut self.distance, span, tool, ToolError::distance_m);
            note_error(&mut self.angle, span, tool, |tool| tool.sizes()[2]);
        } else {
            self.not_bounded.get_or_insert(*span);
        }
        if torque && span.torques.is_none() {
            self.torque_not_bounded.get_or_insert(*span);
        }
        note_motors(&mut self.torques, span, span.torques, limits.torque_nm);
        note_motors(&mut self.rates, span, span.rates, limits.rate_rad_s);
    }
}

fn note_error(
    worst: &mut Option<(TimeSpan, ToolError)>,
    span: &TimeSpan,
    tool: ToolError,
    size: impl Fn(&ToolError) -> f64,
) {
    if worst.is_none_or(|(_, before)| size(&tool) > size(&before)) {
        *worst = Some((*span, tool));
    }
}

fn note_motors(
    worst: &mut [Option<Margin>; 3],
    span: &TimeSpan,
    ranges: Option<[[f64; 2]; 3]>,
    limits: Option<[f64; 3]>,
) {
    for (motor, range) in ranges.iter().flatten().enumerate() {
        let size = range[0].abs().max(range[1].abs());
        if worst[motor].is_none_or(|before| size > before.size) {
            worst[motor] = Some(Margin {
                size,
                limit: limits.map(|limits| limits[motor]),
                span: *span,
            });
        }
    }
}
