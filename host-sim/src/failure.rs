//! Failures of a command, and their exit codes.

use std::io;
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

/// Judges a write to standard output. Who closes it early does not want what is printed; any other error counts.
///
/// # Errors
/// Failed: standard output cannot be written.
pub(crate) fn printed(result: io::Result<()>) -> Result<(), CliError> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::Failed(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}
