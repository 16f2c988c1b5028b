//! Drives as a machine hears them.

use super::Transmit;
use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;

/// State of a drive, as it was heard last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum DriveState {
    /// Nothing was heard of it, or not for the timeout.
    #[default]
    Silent,
    /// Off; ready to be switched on.
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

/// One drive, as it was heard last. Values are those of the joint: gear, direction and zero are accounted for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct DriveReading<N: Number> {
    /// State of the drive.
    pub state: DriveState,
    /// The drive's own code of an error, 0 for none.
    pub error: u32,
    /// Angle of the joint, in (-pi, pi],
    pub angle: N::Angle,
    /// its rate,
    pub rate: N,
    /// and the torque of the motor on the joint; 0 of a drive that tells none.
    pub torque: N,
    /// Temperature of the drive in degrees Celsius; [`DriveReading::NO_TEMPERATURE`] of a drive that tells none.
    pub temperature_c: i32,
    /// Supply of the drive in mV; 0 of a drive that tells none.
    pub supply_mv: u32,
    /// Ticks since the drive told its angle, up to the most that the type holds,
    pub age: u16,
    /// and since it told its state.
    pub state_age: u16,
    /// Times that the drive has restarted, as far as its positions tell, modulo 256. Its angle may be whole turns of the rotor off
    /// since.
    pub restarts: u8,
}

/// All drives in one tick.
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
    /// A drive is silent, in error, not calibrated, or has not switched on in time.
    Drive {
        /// Motor, from 0.
        motor: u8,
        /// State of its drive.
        state: DriveState,
        /// The drive's own code of an error, 0 for none.
        error: u32,
    },
    /// A joint moves while the machine looks where it is.
    Moves {
        /// Motor, from 0.
        motor: u8,
        /// Angle by which it moved, rad,
        value: N,
        /// and the most allowed.
        limit: N,
    },
    /// The joint angles belong to no pose with the elbows and on the side of det A that the scene's start has.
    NoPose,
    /// The joint angles belong to more than one such pose.
    ManyPoses,
    /// The pose is nearer to a singularity than the limits allow.
    Singular {
        /// The distance.
        what: Bounded,
        /// Leg, from 0, of a serial singularity.
        leg: Option<u8>,
        /// Its value,
        value: N,
        /// and the least allowed.
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
