//! Failures of a command, and their exit codes.

use trirrr_client::local::Unbuildable;

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
            CliError::Refused(_) => 2,
            CliError::Failed(_) => 1,
        }
    }
}
