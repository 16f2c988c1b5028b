//! Why the plant has no motion, or none that means anything.

use trirrr_core::status::Status;
use trirrr_drives::stepper::TooManySteps;

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
        /// Why.
        reason: String,
    },
    /// The service gave no more ticks before the job was over.
    #[error("no more ticks: the service has ended")]
    Service,
    /// A stepper is to go faster than its driver can.
    #[error("motor {}: {reason}", motor + 1)]
    TooManySteps {
        /// The motor, from 0.
        motor: usize,
        /// The steps.
        reason: TooManySteps,
    },
}

impl From<Status> for Refusal {
    fn from(status: Status) -> Self {
        Self::Pose(status)
    }
}
