//! Drives as a machine hears them.

use super::Transmit;
use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;

/// State of a drive, by its last frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum DriveState {
    /// No frame from the drive yet, or none within the timeout.
    #[default]
    Silent,
    /// Off, ready to be switched on.
    Off,
    /// On its way on, or busy with a task of its own, such as a calibration.
    Preparing,
    /// On: it follows its commands.
    On,
    /// It has to be calibrated or referenced before it can be switched on.
    Uncalibrated,
    /// It reports an error, and is off.
    Fault,
}

/// One drive, by its last frames. Values are those of the joint: gear, direction and zero are accounted for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct DriveReading<N: Number> {
    /// State of the drive.
    pub state: DriveState,
    /// The drive's own code of an error, 0 for none.
    pub error: u32,
    /// Angle of the joint, in (-pi, pi].
    pub angle: N::Angle,
    /// Its rate.
    pub rate: N,
    /// Torque of the motor on the joint; 0 of a drive that tells none.
    pub torque: N,
    /// Temperature of the drive in degrees Celsius; -2^31 of a drive that tells none.
    pub temperature_c: i32,
    /// Supply of the drive in mV; 0 of a drive that tells none.
    pub supply_mv: u32,
    /// Ticks since the drive told its angle, at most 65535.
    pub age: u16,
    /// Ticks since the drive told its state, at most 65535.
    pub state_age: u16,
    /// Times that the drive has restarted, as far as its positions tell, modulo 256. Its angle may be whole turns of the rotor off
    /// since.
    pub restarts: u8,
}

/// All drives in one tick, asked for by `Drives`. Only a machine whose scene has `[feedback]` sends them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct DriveSample<N: Number> {
    /// Ticks since the machine was switched on, modulo 2^32: that of the [`Telemetry`](super::Telemetry) beside it.
    pub tick: u32,
    /// The drives, by motor.
    pub drives: [DriveReading<N>; 3],
}

/// Reason why a machine was not enabled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum NotEnabled<N: Number> {
    /// A drive is silent, in error, not calibrated, or was not on in time.
    Drive {
        /// The motor, from 0.
        motor: u8,
        /// State of its drive.
        state: DriveState,
        /// The drive's own code of an error, 0 for none.
        error: u32,
    },
    /// A joint moved while the machine looked where it is.
    Moves {
        /// The motor, from 0.
        motor: u8,
        /// Angle by which it moved, rad.
        value: N,
        /// Most that is allowed, rad.
        limit: N,
    },
    /// The joint angles belong to no pose with the elbows and on the side of det A that the scene's start has.
    NoPose,
    /// The joint angles belong to more than one such pose.
    ManyPoses,
    /// The pose is nearer to a singularity than the limits allow.
    Singular {
        /// The distance that is too small.
        what: Bounded,
        /// Leg of a serial singularity, from 0.
        leg: Option<u8>,
        /// Its value.
        value: N,
        /// Least that is allowed.
        limit: N,
    },
    /// Drives have restarted, or were silent, while the machine stayed on. Their joints are taken to be nearest to where they
    /// were, and may be whole turns of the rotor elsewhere. A `ClearFault` that follows acknowledges the angles.
    Restarted {
        /// Angle at which the joint of each such drive is taken to be, in (-pi, pi]; none of a drive that has not restarted.
        angles: [Option<N::Angle>; 3],
    },
}

impl<N: Number> NotEnabled<N> {
    /// Returns true if a `ClearFault` has to come before the next `Enable`: it clears the error of a drive, and acknowledges
    /// angles after a restart.
    pub fn wants_acknowledgement(&self) -> bool {
        match self {
            Self::Drive { error, .. } => *error != 0,
            Self::Restarted { .. } => true,
            Self::Moves { .. } | Self::NoPose | Self::ManyPoses | Self::Singular { .. } => false,
        }
    }
}

impl<N: Number> DriveReading<N> {
    /// Temperature of a drive that tells none.
    pub const NO_TEMPERATURE: i32 = i32::MIN;

    /// Drive of which nothing was heard, with its joint at `angle`.
    pub fn unheard(angle: N::Angle) -> Self {
        Self {
            state: DriveState::Silent,
            error: 0,
            angle,
            rate: N::ZERO,
            torque: N::ZERO,
            temperature_c: Self::NO_TEMPERATURE,
            supply_mv: 0,
            age: u16::MAX,
            state_age: u16::MAX,
            restarts: 0,
        }
    }
}
