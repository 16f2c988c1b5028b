//! Moves of a plan, and the tick and tolerances that they keep.

use crate::path::PathPlace;
use trirrr_core::setpoint::{Ends, Quintics, Segment};

/// Tick and tolerances of the moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Seconds per tick.
    pub period_s: f64,
    /// Largest distance of D from the path, m.
    pub tolerance_m: f64,
    /// Largest deviation of alpha from that on the path, rad.
    pub tolerance_rad: f64,
    /// Distance between neighbouring positions in the number type that the moves are played in, m.
    pub resolution_m: f64,
    /// The same of alpha, rad.
    pub resolution_rad: f64,
    /// Ticks that every move takes at least, 1 or more: a queue of so many moves has to last for a hold.
    pub ticks_min: u32,
    /// Ticks of the shortest move, where the acceleration changes: at a start, a stop, a change of the feed. 1 or more.
    pub ticks_shortest: u32,
}

impl Sampling {
    /// Ticks of the shortest move of a run whose accelerations ask for `least_s` at least.
    pub(crate) fn shortest(&self, least_s: f64) -> f64 {
        let least = (least_s / self.period_s).round();
        least.max(f64::from(self.ticks_shortest))
    }

    /// Speed that the rounding of both ends of a move of `duration_s` adds at most, m/s.
    pub(crate) fn rounded_speed(&self, duration_s: f64) -> f64 {
        3.0 * self.resolution_m / duration_s
    }
}

/// One move of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedMove {
    /// Pose, velocity and acceleration at both ends, m, rad and s.
    pub ends: Ends<f64, Quintics>,
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// Place on the path at its start.
    pub place: PathPlace,
    /// Index of the piece that holds its middle.
    pub piece: usize,
}

impl PlannedMove {
    /// The motion of the move, in ticks of `period_s`.
    pub fn segment(&self, period_s: f64) -> Segment<f64, Quintics> {
        Segment::new(&self.ends, self.ticks, period_s)
    }
}
