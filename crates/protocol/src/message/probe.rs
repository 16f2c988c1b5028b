//! Runs with a probe.

use super::Transmit;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;

/// Run of the last [`Probe`](super::Command::Probe) since the machine was switched on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum ProbeRun<N: Number> {
    /// The run is under way, and the contact has not changed.
    Armed,
    /// The contact has changed.
    Touched(ProbeContact<N>),
    /// The run has ended, and the contact has not changed.
    NotTouched,
}

/// Contact of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct ProbeContact<N: Number> {
    /// Tick at whose end the contact was felt, as telemetry counts them.
    pub tick: u32,
    /// Pose to which the platform was commanded in that tick.
    pub pose: Pose<N>,
    /// Pose of the platform by the angles that the drives told then; none where they tell nothing.
    pub measured: Option<Pose<N>>,
}
