//! Contents of a frame from a drive.

use trirrr_protocol::message::DriveState;

/// State of a drive, as a frame tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// This state.
    State(DriveState),
    /// The drive does as it was told: its frames have no state, and it answers.
    Obeys,
}

/// Contents of a frame from a drive, in the units of its rotor. What the frame does not tell is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heard {
    /// State.
    pub state: Option<Told>,
    /// Error code of the drive's own, 0 without an error.
    pub error: Option<u32>,
    /// Position, turns.
    pub position: Option<f32>,
    /// Velocity, turns per second.
    pub velocity: Option<f32>,
    /// Torque of the rotor, N m.
    pub torque: Option<f32>,
    /// Current that makes torque, A.
    pub current: Option<f32>,
    /// Highest temperature that the frame tells, degrees Celsius.
    pub temperature: Option<f32>,
    /// Voltage of the supply, V.
    pub supply: Option<f32>,
}

/// Number, unless it is none: a drive without an estimate says so by a value that is not finite.
#[inline(always)]
pub(super) fn finite(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}
