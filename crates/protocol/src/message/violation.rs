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
    /// The span from the base joint to the platform joint, against what the leg reaches.
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
    /// A result against the range of the number type.
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

/// Why a move is refused: the first limit on its way that it breaks, or that nothing proves it to keep.
///
/// The move is judged by bounds: at each instant of a short interval the true value lies within `error` of
/// `value`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Violation<N: Number> {
    /// Quantity that went beyond its bound.
    pub what: Bounded,
    /// The leg or motor, from 0, where it belongs to one.
    pub index: Option<u8>,
    /// When: fraction of the move's duration, 0 to 1.
    pub at: N,
    /// The value in the middle of the interval.
    pub value: N,
    /// Bound of the distance of the true value from `value`, rounding included; none where nothing is known.
    pub error: Option<N>,
    /// The bound.
    pub limit: N,
    /// True if all values within `error` of `value` break the bound. False if none is proven to break it, and
    /// not all are proven to keep it.
    pub certain: bool,
    /// True if only a hold, a stop or a resume there breaks the bound. Normal speed keeps it.
    pub ramp: bool,
    /// The shortest duration that would pass, where the move is merely too fast.
    pub shortest: Option<LeastDuration>,
}

/// The shortest duration that would pass, in ticks, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LeastDuration {
    /// It passes; one tick less does not.
    pub enough: u32,
    /// The longest of the durations that were tried and break a limit for certain; 0 if there was none. From
    /// rest to rest all shorter ones break it, too. Between the two no duration is proven to do either.
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
    /// Code of what happened.
    pub code: FaultCode,
    /// The leg or motor, from 0, where it belongs to one.
    pub index: Option<u8>,
    /// The value; 0 where there is none.
    pub value: N,
    /// The limit that it broke; 0 where there is none.
    pub limit: N,
    /// The tick in which it happened.
    pub tick: u32,
}

/// Subject of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FaultCode {
    /// The tick's result was beyond a limit; it was not given out.
    Limit(Bounded),
    /// The setpoint had no motion: a leg does not reach it.
    Unreachable,
    /// The setpoint had no motion: a leg is stretched or folded.
    SerialSingular,
    /// The setpoint had no motion: the torques are not defined.
    ParallelSingular,
    /// The setpoint had no motion: a result beyond the range of the number type.
    OutOfRange,
    /// A tick was not done when the next was due; the value is the time that it took over the
    /// period, at most 2, the limit 1.
    Overrun,
    /// A drive does not do what it was told.
    Drive(DriveFault),
    /// The board reports a fault; the value is its own code. 1: it started anew because it had
    /// failed, and its identity says how.
    Board,
    /// Homing: the motor has moved by as much as it may, the limit in rad, and its switch has not
    /// closed, or its drive has not stalled.
    HomingNotFound,
    /// Homing: the motor has backed off by the limit in rad, and its switch is still closed.
    HomingNotReleased,
    /// Homing: the switch was closed before the search, and is still closed after the motor has
    /// moved away by the limit in rad.
    HomingClosedAtStart,
    /// A joint is farther from its command than it may be, for longer than it may be: angle and limit in rad.
    FollowingError,
    /// Something pushes the platform: the force at D and the limit, in N, as the machine estimates them.
    Contact,
    /// Something turns the platform: the moment about D and the limit, in N m, as the machine estimates them.
    ContactMoment,
    /// The emergency stop was pressed, or its wire is broken.
    EmergencyStop,
    /// The motor has reached its limit switch, or the wire of that is broken.
    LimitSwitch,
}

/// Reason why a drive does not do what it was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum DriveFault {
    /// More microsteps in a tick than the stepper's driver takes; the value is in parts of the most
    /// that it takes, the limit 1.
    StepRate,
    /// A command beyond what the drive's frame can hold.
    Range,
    /// The bus has not carried the commands of the tick before.
    BusBusy,
    /// The bus has taken the board off it after too many errors.
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
