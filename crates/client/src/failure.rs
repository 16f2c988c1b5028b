//! Ends of a job before its end.

use crate::describe::{self, Units};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{
    Acting, Fault, JobLabel, NotEnabled, Refusal, Start, State, Transmit, Violation,
};

/// Reason why a job was not played to its end. Moves are counted from 0 here and from 1 in texts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobFailure<N: Transmit> {
    /// The machine was not idle and empty when the conversation began.
    Occupied(State),
    /// A command was refused.
    Refused {
        /// Index of the move, if the command was a move.
        index: Option<u32>,
        /// Reason of the machine.
        refusal: Refusal<N>,
    },
    /// The machine took a move and found that the move breaks a limit.
    Inadmissible {
        /// Index of the move.
        index: u32,
        /// Limit that the move would break.
        violation: Violation<N>,
    },
    /// A fault is latched.
    Fault(Fault<N>),
    /// The drives were not switched on.
    NotEnabled(NotEnabled<N>),
    /// The machine does not stand at the start of the job, and the straight way there is not admitted, however slow.
    NoWay {
        /// Pose at which the machine stands.
        from: Pose<N>,
        /// Start of the job.
        to: Pose<N>,
        /// Duration of the way that was tried last, ticks.
        ticks: u32,
        /// Limit that it would break.
        violation: Violation<N>,
    },
    /// The user stopped the job.
    Stopped {
        /// Moves played to their end.
        done: u32,
    },
    /// The machine stopped by itself and dropped the rest of the job.
    Dropped {
        /// Moves played to their end.
        done: u32,
        /// Cause that acted last.
        acting: Acting,
    },
    /// The machine started anew, for this cause, and has lost the job.
    Restarted(Start),
    /// The machine was given another job meanwhile.
    OtherJob(JobLabel),
    /// The machine carries another tool than the job is for: that of this index among those of the scene, or none of them.
    OtherTool(Option<usize>),
}

impl<N: Transmit> JobFailure<N> {
    /// Describes the failure in words and SI units. `ticks` is the duration of the move that failed, `item` the word for a part of the job.
    pub fn describe(&self, item: &str, ticks: u32, units: &Units) -> String {
        match self {
            Self::Occupied(State::Idle) => "the machine has moves of another job".into(),
            Self::Occupied(state) => format!(
                "the machine is not free: {}",
                describe::state(*state, Acting::Nothing)
            ),
            Self::Refused { index, refusal } => {
                let why = describe::refusal(refusal, ticks, units);
                match index {
                    Some(index) => format!("{item} {} is refused: {why}", index + 1),
                    None => why,
                }
            }
            Self::Inadmissible { index, violation } => format!(
                "{item} {} is not admitted: {}",
                index + 1,
                describe::violation(violation, ticks, units)
            ),
            Self::Fault(fault) => describe::fault(fault, units),
            Self::NoWay {
                from,
                to,
                ticks,
                violation,
            } => {
                let pose = |pose: &Pose<N>| {
                    let [x, y] = [pose.position.x, pose.position.y]
                        .map(|value| value.to_f64() * units.length_m);
                    format!(
                        "({x:.6} m, {y:.6} m, {:.6} rad)",
                        N::angle_to_f64(pose.angle)
                    )
                };
                format!(
                    "the machine stands at {}; the straight way to {} is not admitted: {}; a recovery (--recover) moves the \
                     motors there one by one",
                    pose(from),
                    pose(to),
                    describe::violation(violation, *ticks, units)
                )
            }
            Self::NotEnabled(why) => format!("not enabled: {}", describe::not_enabled(why)),
            Self::Stopped { done } => format!("stopped, {done} {item}s done"),
            Self::Dropped { done, acting } => format!(
                "the machine stopped by itself and dropped the rest of the job, {done} {item}s done: {}",
                describe::state(State::Idle, *acting)
            ),
            Self::Restarted(start) => format!(
                "the machine started anew during the job: {}",
                describe::board::start(start)
            ),
            Self::OtherJob(label) => format!(
                "the machine was given another job meanwhile: {}",
                describe::board::name(&label.name)
            ),
            Self::OtherTool(_) => "the machine carries another tool than the job is for".into(),
        }
    }

    /// Returns true if the machine has nothing of the job any more, and would take it again. A job that the user has stopped is not lost.
    pub fn loses_job(&self) -> bool {
        matches!(
            self,
            Self::Fault(_)
                | Self::Dropped { .. }
                | Self::Restarted(_)
                | Self::OtherJob(_)
                | Self::Occupied(State::Disabled | State::Unhomed | State::Cleared | State::Idle)
        )
    }

    /// Returns the index of the move that failed.
    pub(crate) fn index(&self) -> Option<u32> {
        match self {
            Self::Refused { index, .. } => *index,
            Self::Inadmissible { index, .. } => Some(*index),
            _ => None,
        }
    }
}
