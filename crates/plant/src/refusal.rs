//! Refusals: a plant without a motion, or without one that means anything.

use trirrr_core::status::Status;

/// The plant's own reasons to stop. Legs and motors are numbered from 1 in messages.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// A leg does not reach the platform, or is exactly stretched or folded.
    #[error("{0}")]
    Pose(Status),
    /// The setpoint of the controller has no motion.
    #[error("setpoint: {0}")]
    Setpoint(Status),
    /// The mass matrix is not positive definite: some motion has no inertia.
    #[error("the mass matrix is singular: a motion of the platform has no inertia")]
    NoInertia,
    /// The machine itself is refused by the core.
    #[error("{0}")]
    Machine(String),
    /// The scene asks for something that the plant does not have.
    #[error("{key}: {reason}")]
    Scene {
        /// The key.
        key: String,
        /// Reason of the refusal.
        reason: String,
    },
    /// A drive cannot do what a tick commands.
    #[error("motor {}: {reason}", motor + 1)]
    Drive {
        /// The motor, from 0.
        motor: usize,
        /// Reason of the refusal.
        reason: String,
    },
}

impl From<Status> for Refusal {
    fn from(status: Status) -> Self {
        Self::Pose(status)
    }
}
