//! Figures as PNG beside those as SVG, for every command that writes figures.

use clap::Args;

/// Choice of pictures.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct PictureArgs {
    /// Write each figure as PNG, too, for programs that read no SVG
    #[arg(long)]
    pub png: bool,
}
