//! Violations of bounds and faults: the quantity, its bound, and the place.

use super::Transmit;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::status::Status;
use trirrr_core::units::Units;

/// A quantity that has a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Bounded {
    /// Distance from the base joint to the platform joint, against the reach of the leg.
    Reach,
    /// [Distance](trirrr_core::singularity) from the serial singularity.
    SerialDistance,
    /// [Distance](trirrr_core::singularity) from the parallel singularity.
    ParallelDistance,
    /// Joint rate.
    Rate,
    /// Joint acceleration.
    Acceleration,
    /// Torque at the joint.
    Torque,
    /// Mechanical power of a motor.
    Power,
    /// A result, against the range of the number type.
    Range,
    /// Joint jerk.
    Jerk,
    /// Jump of the joint acceleration where a move meets the one before or after it, or rest.
    AccelerationJump,
}

impl Bounded {
    /// Returns the exponents of length, time and mass of its values.
    pub fn dimension(self) -> [i32; 3] {
        match self {
            Self::Reach => [1, 0, 0],
            Self::SerialDistance | Self::ParallelDistance | Self::Range => [0, 0, 0],
            Self::Rate => [0, -1, 0],
            Self::Acceleration | Self::AccelerationJump => [0, -2, 0],
            Self::Jerk => [0, -3, 0],
            Self::Torque => [2, -2, 1],
            Self::Power => [2, -3, 1],
        }
    }
}

/// First limit along a move that it breaks, or that it is not proven to keep. The move is judged by bounds: at each
/// instant of a short interval the true value lies within `error` of `value`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Violation<N: Number> {
    /// The quantity beyond its bound.
    pub what: Bounded,
    /// The leg or motor, from 0; none for the platform.
    pub index: Option<u8>,
    /// Time: fraction of the move's duration, 0 to 1.
    pub at: N,
    /// The value in the middle of the interval.
    pub value: N,
    /// Bound of the distance of the true value from `value`, rounding included; none where nothing is known.
    pub error: Option<N>,
    /// The bound.
    pub limit: N,
    /// `true`: all values within `error` of `value` break the bound. `false`: none is proven to break it, and not all
    /// are proven to keep it.
    pub certain: bool,
    /// `true`: only a hold, a stop or a resume there breaks the bound; at normal speed it is kept.
    pub ramp: bool,
    /// The shortest duration that would pass, where the move is only too fast.
    pub shortest: Option<LeastDuration>,
}

/// The shortest duration that would pass, in ticks, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LeastDuration {
    /// It passes; one tick less does not.
    pub enough: u32,
    /// Longest duration that was tried and breaks a limit for certain; 0 if there was none. From rest to rest all
    /// shorter ones break it, too. Between the two no duration is proven to do either.
    pub too_short: u32,
}

impl<N: Number> Violation<N> {
    /// Returns the same violation in SI units; its values are in `units`.
    pub fn in_si(&self, units: &Units) -> Violation<f64> {
        let [length, time, mass] = self.what.dimension();
        self.scaled(units.of(length, time, mass))
    }

    /// Returns the same violation in SI units; one unit of its values is `unit` there.
    pub fn scaled(&self, unit: f64) -> Violation<f64> {
        Violation {
            what: self.what,
            index: self.index,
            at: self.at.to_f64(),
            value: self.value.to_f64() * unit,
            error: self.error.map(|error| error.to_f64() * unit),
            limit: self.limit.to_f64() * unit,
            certain: self.certain,
            ramp: self.ramp,
            shortest: self.shortest,
        }
    }
}

/// A latched fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Fault<N: Number> {
    /// The cause.
    pub code: FaultCode,
    /// The leg or motor, from 0; none where the cause has none.
    pub index: Option<u8>,
    /// The value; 0 where there is none.
    pub value: N,
    /// The broken limit; 0 where there is none.
    pub limit: N,
    /// The tick in which it happened.
    pub tick: u32,
}

/// Cause of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FaultCode {
    /// The tick's result was beyond a limit; the drives did not get it.
    Limit(Bounded),
    /// The setpoint had no motion: a leg does not reach it.
    Unreachable,
    /// The setpoint had no motion: a leg is stretched or folded.
    SerialSingular,
    /// The setpoint had no motion: the torques are not defined.
    ParallelSingular,
    /// The setpoint had no motion: a result beyond the range of the number type.
    OutOfRange,
    /// A tick was not done when the next was due. The value is its latency over the period, at most 2; the limit is 1.
    Overrun,
    /// A drive does not follow its command.
    Drive(DriveFault),
    /// The board reports a fault; the value is its own code. 1: the board restarted after a failure, and its identity
    /// has the cause.
    Board,
    /// The motor has moved by the limit in rad, and its switch has not closed or its drive has not stalled.
    HomingNotFound,
    /// The motor has backed off by the limit in rad, and its switch is still closed.
    HomingNotReleased,
    /// The switch was closed before the search, and is still closed after the motor has moved away by the limit in
    /// rad.
    HomingClosedAtStart,
    /// A joint was farther from its command than it may be, for longer than it may be: angle and limit in rad.
    FollowingError,
    /// Something pushes the platform: the estimated force at D and the limit, in N.
    Contact,
    /// Something turns the platform: the estimated moment about D and the limit, in N m.
    ContactMoment,
    /// The emergency stop was pressed, or its wire is broken.
    EmergencyStop,
    /// The motor has reached its limit switch, or the wire of that is broken.
    LimitSwitch,
}

/// Reason why a drive does not follow its command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum DriveFault {
    /// More microsteps in a tick than the stepper's driver accepts. The value is a multiple of what it accepts; the
    /// limit is 1.
    StepRate,
    /// A command beyond the range of the drive's frame.
    Range,
    /// The commands of the tick before have not gone out on the bus.
    BusBusy,
    /// The bus controller has switched off after too many errors.
    BusOff,
    /// The drive reports an error of its own; the value is its code.
    Reported,
    /// The drive has told nothing for too long: the value is the time over the timeout, the limit 1.
    Silent,
    /// The drive is not on, though it should be.
    NotOn,
    /// The drive signals that its motor does not follow.
    Stalled,
    /// The drive has restarted, or its position has jumped by half a turn of the rotor or more from one message to the next.
    Restarted,
}

impl FaultCode {
    /// Returns true for a push or a turn at the tool.
    pub fn is_contact(self) -> bool {
        matches!(self, Self::Contact | Self::ContactMoment)
    }

    /// The code and the leg of a setpoint without a motion.
    pub fn of(status: Status) -> (Self, Option<u8>) {
        match status {
            Status::Unreachable { leg } => (Self::Unreachable, Some(leg as u8)),
            Status::SerialSingular { leg } => (Self::SerialSingular, Some(leg as u8)),
            Status::ParallelSingular => (Self::ParallelSingular, None),
            Status::OutOfRange => (Self::OutOfRange, None),
        }
    }

    /// The quantity that is at its bound in this fault, if it is one of the machine's own.
    pub fn bounded(self) -> Option<Bounded> {
        match self {
            Self::Limit(what) => Some(what),
            Self::Unreachable => Some(Bounded::Reach),
            Self::SerialSingular => Some(Bounded::SerialDistance),
            Self::ParallelSingular => Some(Bounded::ParallelDistance),
            Self::OutOfRange => Some(Bounded::Range),
            Self::Overrun
            | Self::Drive(_)
            | Self::Board
            | Self::HomingNotFound
            | Self::HomingNotReleased
            | Self::HomingClosedAtStart
            | Self::FollowingError
            | Self::Contact
            | Self::ContactMoment
            | Self::EmergencyStop
            | Self::LimitSwitch => None,
        }
    }
}
