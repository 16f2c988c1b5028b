//! Limits of the watch over the drives, and what it takes to find a pose.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::forward::Forward;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_core::to_source;

/// Limits of the watch over the drives. Angles in rad, times in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FeedbackParameters {
    /// A drive that tells nothing for longer is silent; positive.
    pub timeout_ticks: u16,
    /// All drives are on within so many ticks, once they are asked for; positive.
    pub enable_ticks: u16,
    /// A joint moves less than this while the machine is enabled, positive.
    pub still_rad: f64,
    /// Greatest following error of a joint that stands, positive,
    pub standing_rad: f64,
    /// and of one that moves.
    pub moving_rad: f64,
    /// A following error beyond its limit is a fault after so many ticks in a row; positive.
    pub window_ticks: u16,
}

/// The same in the number type of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WatchLimits<N> {
    pub(crate) timeout_ticks: u16,
    pub(crate) enable_ticks: u16,
    pub(crate) still: N,
    pub(crate) standing: N,
    pub(crate) moving: N,
    pub(crate) window_ticks: u16,
}

to_source!([N: Number] WatchLimits [N] in trirrr_service::features {
    timeout_ticks: u16,
    enable_ticks: u16,
    still: N,
    standing: N,
    moving: N,
    window_ticks: u16,
});

/// Coefficients of feedback: plain numbers, so that whoever builds an image can write them as constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackCoefficients<N: Number> {
    pub(crate) watch: WatchLimits<N>,
    pub(crate) forward: Forward<N>,
    /// Pose at the start of the job: its elbows and its side of det A are the machine's.
    pub(crate) start: Pose<N>,
    /// det A is positive there.
    pub(crate) side: bool,
}

to_source!([N: Number] FeedbackCoefficients [N] in trirrr_service::coefficients {
    watch: WatchLimits<N>,
    forward: Forward<N>,
    start: Pose<N>,
    side: bool,
});

impl<N: Number> FeedbackCoefficients<N> {
    /// Builds the coefficients of a machine whose job starts at `start`. `geometry` has to be built from the same
    /// `parameters`. `None` if the machine cannot stand at `start`.
    pub fn build(
        feedback: &FeedbackParameters,
        parameters: &Parameters,
        geometry: &Geometry<N>,
        start: Pose<N>,
    ) -> Option<Self> {
        let forward = Forward::build(parameters, geometry);
        let angles = geometry.motor_angles(&geometry.position(&start).ok()?);
        Some(Self {
            watch: WatchLimits {
                timeout_ticks: feedback.timeout_ticks,
                enable_ticks: feedback.enable_ticks,
                still: N::from_f64(feedback.still_rad),
                standing: N::from_f64(feedback.standing_rad),
                moving: N::from_f64(feedback.moving_rad),
                window_ticks: feedback.window_ticks,
            },
            side: forward.side(&angles, &start),
            forward,
            start,
        })
    }
}
