//! Reasons why a program ends early.

use std::fmt::Display;
use thiserror::Error;

/// Reason why a program ends early.
#[derive(Debug, Error)]
pub enum ZenohError {
    /// The input is refused.
    #[error("{0}")]
    Refused(String),
    /// The input is good, and the work failed.
    #[error("{0}")]
    Failed(String),
}

impl ZenohError {
    /// An error of Zenoh, at `what`.
    pub(crate) fn zenoh(what: &str, error: &dyn Display) -> Self {
        Self::Failed(format!("Zenoh: {what}: {error}"))
    }

    /// 2 for a refusal, as clap has it for arguments, and 1 for a failure: as `trirrr`.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Refused(_) => 2,
            Self::Failed(_) => 1,
        }
    }
}
