//! Failures of a command, and their exit codes.

use trirrr_client::local::Unbuildable;
use trirrr_scene::NumberType;

/// Reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The input is refused: a scene, a table, a number type.
    #[error("{0}")]
    Refused(String),
    /// The input is good, and the work failed: the disk is full, a file not writable, the motion ended
    /// in a status.
    #[error("{0}")]
    Failed(String),
    /// The board computes in another number type than it was spoken to in. Nothing was asked of it.
    #[error("{text}")]
    OtherNumbers {
        /// Number type of the board.
        board: NumberType,
        /// The same in words, with the option that leads on.
        text: String,
    },
    /// The command or the file is for `trirrr-full`. Nothing was done yet.
    #[cfg(not(feature = "full"))]
    #[error("{0} is part of trirrr-full")]
    InFull(&'static str),
}

impl From<Unbuildable> for CliError {
    fn from(error: Unbuildable) -> Self {
        CliError::Refused(error.to_string())
    }
}

impl CliError {
    /// Returns 2 for a refusal, as clap does for arguments, and 1 for a failure.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Refused(_) | CliError::OtherNumbers { .. } => 2,
            CliError::Failed(_) => 1,
            #[cfg(not(feature = "full"))]
            CliError::InFull(_) => 1,
        }
    }
}
