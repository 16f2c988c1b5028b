//! Homing: a machine without absolute encoders finds out where its motors are.
//!
//! Each motor turns towards a switch or a hard stop that lies at a known joint angle:
//!
//! ```text
//! settle ─> search ─> back off ─> latch ─> pull off ─> next stage, or done
//!            fast                  slow
//! ```
//!
//! The motors of one stage do each part together and wait for each other; stages follow one
//! another. Where the switch closes in the slow approach is the motor's reference. A drive that tells its torque
//! feels a hard stop; where its joint is measured then is the reference. Against a hard
//! stop that nobody feels, the motor runs for the largest travel instead, and is at the stop then.
//! The motors come to rest off their switches, at angles that are known in advance, so the way from
//! there to the start pose is that of any [recovery](trirrr_protocol::message::Command::Recover).

mod coefficients;
mod cycle;
mod input;
mod parameters;

pub use coefficients::{HomingAxis, HomingCoefficients};
pub(crate) use cycle::Cycle;
pub use parameters::{Contact, HomingMotor, HomingParameters, HomingTimes};

use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointSetpoint, Pose};
use trirrr_protocol::message::FaultCode;

/// Result of a tick of homing.
pub(crate) enum Progress<N: Number> {
    /// The motors move, or wait.
    Moving(JointSetpoint<N>),
    /// All stand at the angles of [`Plan::from`].
    Done,
    /// All stand, after it was given up.
    Stopped,
    /// It has failed, and is to be abandoned.
    Failed {
        /// Reason of the failure.
        code: FaultCode,
        /// Motor at which it failed, from 0.
        motor: u8,
        /// Angle that the motor was allowed to move by, rad.
        limit: N,
    },
}

/// Parts of homing that the background has to know.
pub(crate) struct Plan<N: Number> {
    /// Angles at which the motors stand when homing is done.
    pub(crate) from: [N::Angle; 3],
    /// Pose that the way from there leads to.
    pub(crate) to: Pose<N>,
    /// Number of ticks of that way.
    pub(crate) ticks: u32,
    /// The greatest rate of each motor,
    pub(crate) rates: [N; 3],
    /// and its acceleration.
    pub(crate) accelerations: [N; 3],
}
