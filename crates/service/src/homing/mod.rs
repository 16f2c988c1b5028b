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
//! another. Where the switch closes in the slow approach is the motor's reference. Against a hard
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

use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointSetpoint, Pose};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::FaultCode;

/// How a machine finds out where its motors are, tick by tick.
pub trait Homing<N: Number>: Send {
    /// What the tick is reported of switches and drives.
    type Inputs: Copy + Default;

    /// Whether the machine has to be homed at all.
    fn is_needed(&self) -> bool;

    /// Takes the inputs of this tick, which belong to where `motors` were commanded in the last.
    fn listen(&mut self, inputs: Self::Inputs, motors: &[Motor<N>; 3]);

    /// Starts looking.
    fn begin(&mut self);

    /// Brings the motors to rest, and gives up.
    fn stop(&mut self);

    /// Gives up at once.
    fn abandon(&mut self);

    /// Whether motors are being looked for, or are on their way to rest after that was given up.
    fn is_under_way(&self) -> bool;

    /// One tick further from `motors`.
    fn advance(&mut self, motors: &[Motor<N>; 3]) -> Progress<N>;

    /// What was added to the commanded angles in the last tick without a motion, where a motor
    /// found its reference.
    fn shift(&self) -> Option<[N::Angle; 3]>;
}

/// What a tick of homing comes to.
pub enum Progress<N: Number> {
    /// The motors move, or wait.
    Moving(JointSetpoint<N>),
    /// All stand at the angles of [`Plan::from`].
    Done,
    /// All stand, after it was given up.
    Stopped,
    /// It has failed, and is to be abandoned.
    Failed {
        /// Why,
        code: FaultCode,
        /// and at which motor, from 0.
        motor: u8,
        /// What it was allowed to move by, rad.
        limit: N,
    },
}

/// What the background has to know of homing.
pub struct Plan<N: Number> {
    /// Where the motors stand when it is done.
    pub from: [N::Angle; 3],
    /// Where it leads to,
    pub to: Pose<N>,
    /// in this many ticks from there.
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
    fn listen(&mut self, (): (), _: &[Motor<N>; 3]) {}

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
    fn shift(&self) -> Option<[N::Angle; 3]> {
        None
    }
}

/// Chosen when the program runs: for hosts, which play scenes of both kinds.
impl<N: Number> Homing<N> for Option<Cycle<'_, N>> {
    type Inputs = [bool; 3];

    fn is_needed(&self) -> bool {
        self.is_some()
    }

    fn listen(&mut self, inputs: [bool; 3], motors: &[Motor<N>; 3]) {
        if let Some(cycle) = self {
            cycle.listen(inputs, motors);
        }
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

    fn shift(&self) -> Option<[N::Angle; 3]> {
        self.as_ref().and_then(Cycle::shift)
    }
}
