//! How a job ends when it does not end at its end.

use super::describe::{fault, violation};
use std::fmt;
use trirrr_core::message::{Acting, Fault, Refusal, State, Transmit, Violation};

/// Why a job was not played to its end. Moves are counted from 0 here and from 1 in messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure<N: Transmit> {
    /// The machine was not idle and empty when the conversation began.
    Occupied(State),
    /// A command was refused.
    Refused {
        /// The move that it was about.
        index: Option<u32>,
        /// Why.
        refusal: Refusal<N>,
    },
    /// The machine took a move and found that it breaks a limit.
    Inadmissible {
        /// The move.
        index: u32,
        /// What it would break.
        violation: Violation<N>,
    },
    /// A fault is latched.
    Fault(Fault<N>),
    /// The user stopped the job.
    Stopped {
        /// Moves played to their end.
        done: u32,
    },
    /// The machine stopped by itself and dropped the rest of the job.
    Dropped {
        /// Moves played to their end.
        done: u32,
        /// What acted last.
        acting: Acting,
    },
    /// The machine knows nothing of the job any more: it was switched off and on.
    Restarted,
}

impl<N: Transmit> fmt::Display for Failure<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Occupied(state) => {
                write!(
                    f,
                    "the machine is not free: {state:?}, or with moves of another job"
                )
            }
            Self::Refused {
                index: Some(index),
                refusal,
            } => write!(f, "move {} was refused: {refusal:?}", index + 1),
            Self::Refused {
                index: None,
                refusal,
            } => write!(f, "refused: {refusal:?}"),
            Self::Inadmissible {
                index,
                violation: found,
            } => write!(
                f,
                "move {} is not admitted: {}",
                index + 1,
                violation(found)
            ),
            Self::Fault(latched) => write!(f, "{}", fault(latched)),
            Self::Stopped { done } => write!(f, "stopped, {done} moves done"),
            Self::Dropped { done, acting } => write!(
                f,
                "the machine stopped by itself ({acting:?}) and dropped the job, {done} moves done"
            ),
            Self::Restarted => write!(f, "the machine was switched off and on during the job"),
        }
    }
}

impl<N: Transmit> std::error::Error for Failure<N> {}
