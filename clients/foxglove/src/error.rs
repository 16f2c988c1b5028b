//! Reasons why the program ends early.

use std::fmt::Display;
use std::path::Path;
use thiserror::Error;

/// Reason why the program ends early.
#[derive(Debug, Error)]
pub(crate) enum FoxgloveError {
    /// The input is refused.
    #[error("{0}")]
    Refused(String),
    /// The input is good, and the work failed.
    #[error("{0}")]
    Failed(String),
}

impl FoxgloveError {
    /// A file that cannot be made or written.
    pub(crate) fn file(path: &Path, error: &impl Display) -> Self {
        match path.exists() {
            true => Self::Refused(format!(
                "{}: is there already, and stays; give another name",
                path.display()
            )),
            false => Self::Failed(format!("{}: cannot be written: {error}", path.display())),
        }
    }

    /// 2 for a refusal, as clap has it for arguments, and 1 for a failure: as `trirrr`.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Refused(_) => 2,
            Self::Failed(_) => 1,
        }
    }
}
