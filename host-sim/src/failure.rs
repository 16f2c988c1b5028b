//! How a command fails, and the exit code that says so.

use trirrr_client::local::Unbuildable;

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// What was asked for or handed in is refused: a scene, a table, a number type.
    #[error("{0}")]
    Refused(String),
    /// The request was good and could not be carried out: the disk is full, a file not writable,
    /// the motion ended in a status.
    #[error("{0}")]
    Failed(String),
}

impl From<Unbuildable> for Failure {
    fn from(error: Unbuildable) -> Self {
        Failure::Refused(error.to_string())
    }
}

impl Failure {
    /// 2 for what was refused, as for arguments that clap refuses; 1 for what failed.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::Refused(_) => 2,
            Failure::Failed(_) => 1,
        }
    }
}
