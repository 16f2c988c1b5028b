//! Figures as PNG beside those as SVG, for every command that writes figures.

use crate::failure::CliError;
use clap::Args;

/// Choice of pictures.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct PictureArgs {
    /// Write each figure as PNG, too, for programs that read no SVG
    #[arg(long)]
    pub png: bool,
}

impl PictureArgs {
    /// Looks whether this program draws what is asked for.
    ///
    /// # Errors
    /// In `trirrr-full`: pictures.
    pub(crate) fn require(self) -> Result<(), CliError> {
        match self.png {
            #[cfg(not(feature = "full"))]
            true => Err(CliError::InFull("--png")),
            _ => Ok(()),
        }
    }
}
