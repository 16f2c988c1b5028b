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
//!
//! The kind is a choice by type, as [`Compiled`](super::Compiled) is: with [`NoHoming`] an image
//! holds nothing of it.

mod coefficients;
mod cycle;
mod input;
mod parameters;

pub use coefficients::{HomingAxis, HomingCoefficients};
pub use cycle::Cycle;
pub use parameters::{Contact, HomingMotor, HomingParameters, HomingTimes};

use crate::feedback::Readings;
use crate::splice::Optional;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointSetpoint, Pose};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::FaultCode;

/// Search of a machine for the angles of its motors, tick by tick.
pub trait Homing<N: Number>: Send {
    /// Reports of switches and drives to the tick.
    type Inputs: Copy + Default;

    /// Returns true if the machine has to be homed at all.
    fn is_needed(&self) -> bool;

    /// Takes the inputs of this tick, which belong to where `motors` were commanded in the last, and what drives that tell
    /// something have told.
    fn listen(
        &mut self,
        inputs: Self::Inputs,
        motors: &[Motor<N>; 3],
        readings: Option<&Readings<N>>,
    );

    /// Returns the first of the `motors` that its drive says to stall while it moves, if that is a fault.
    fn stalled(&self, motors: &[Motor<N>; 3]) -> Option<u8>;

    /// Starts looking.
    fn begin(&mut self);

    /// Brings the motors to rest, and gives up.
    fn stop(&mut self);

    /// Gives up at once.
    fn abandon(&mut self);

    /// Returns true while homing looks for motors, or brings them to rest after it was given up.
    fn is_under_way(&self) -> bool;

    /// One tick further from `motors`.
    fn advance(&mut self, motors: &[Motor<N>; 3]) -> Progress<N>;

    /// Takes changed encoder offsets: the references are found at other angles from now on.
    fn add_offsets(&mut self, by: [N::Angle; 3]);

    /// Returns what the last tick added to the commanded angles without a motion.
    /// It adds something where a motor found its reference.
    fn shift(&self) -> Option<[N::Angle; 3]>;
}

/// Result of a tick of homing.
pub enum Progress<N: Number> {
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
pub struct Plan<N: Number> {
    /// Angles at which the motors stand when homing is done.
    pub from: [N::Angle; 3],
    /// Pose that the way from there leads to.
    pub to: Pose<N>,
    /// Number of ticks of that way.
    pub ticks: u32,
    /// The greatest rate of each motor,
    pub rates: [N; 3],
    /// and its acceleration.
    pub accelerations: [N; 3],
}

/// A machine that knows where its motors are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoHoming;

impl<N: Number> Homing<N> for NoHoming {
    type Inputs = ();

    #[inline(always)]
    fn is_needed(&self) -> bool {
        false
    }

    #[inline(always)]
    fn listen(&mut self, (): (), _: &[Motor<N>; 3], _: Option<&Readings<N>>) {}

    #[inline(always)]
    fn stalled(&self, _: &[Motor<N>; 3]) -> Option<u8> {
        None
    }

    fn begin(&mut self) {}

    fn stop(&mut self) {}

    #[inline(always)]
    fn abandon(&mut self) {}

    #[inline(always)]
    fn is_under_way(&self) -> bool {
        false
    }

    #[inline(always)]
    fn advance(&mut self, _: &[Motor<N>; 3]) -> Progress<N> {
        Progress::Stopped
    }

    #[inline(always)]
    fn add_offsets(&mut self, _: [N::Angle; 3]) {}

    #[inline(always)]
    fn shift(&self) -> Option<[N::Angle; 3]> {
        None
    }
}

/// Chosen when the program runs: for hosts, which play scenes of both kinds.
impl<N, O> Homing<N> for Option<Cycle<'_, N, O>>
where
    N: Number,
    O: Optional<Option<[N::Angle; 3]>> + Send,
{
    type Inputs = [bool; 3];

    fn is_needed(&self) -> bool {
        self.is_some()
    }

    fn listen(
        &mut self,
        inputs: [bool; 3],
        motors: &[Motor<N>; 3],
        readings: Option<&Readings<N>>,
    ) {
        if let Some(cycle) = self {
            cycle.listen(inputs, motors, readings);
        }
    }

    fn stalled(&self, motors: &[Motor<N>; 3]) -> Option<u8> {
        self.as_ref()?.stalled(motors)
    }

    fn begin(&mut self) {
        if let Some(cycle) = self {
            cycle.begin();
        }
    }

    fn stop(&mut self) {
        if let Some(cycle) = self {
            cycle.stop();
        }
    }

    fn abandon(&mut self) {
        if let Some(cycle) = self {
            cycle.abandon();
        }
    }

    fn is_under_way(&self) -> bool {
        self.as_ref().is_some_and(Cycle::is_under_way)
    }

    fn advance(&mut self, motors: &[Motor<N>; 3]) -> Progress<N> {
        match self {
            Some(cycle) => cycle.advance(motors),
            None => Progress::Stopped,
        }
    }

    fn add_offsets(&mut self, by: [N::Angle; 3]) {
        if let Some(cycle) = self {
            cycle.add_offsets(by);
        }
    }

    fn shift(&self) -> Option<[N::Angle; 3]> {
        self.as_ref().and_then(Cycle::shift)
    }
}
