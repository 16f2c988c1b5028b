//! Figures as PNG beside those as SVG, for every command that writes figures.

use crate::failure::CliError;
use crate::recording::unwritable;
use clap::Args;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::png::png;

/// Choice of pictures.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct PictureArgs {
    /// Write each figure as PNG, too, for programs that read no SVG
    #[arg(long)]
    pub png: bool,
}

impl PictureArgs {
    /// Writes a PNG beside each SVG of `files`, if they are asked for; the files written, in order.
    ///
    /// # Errors
    /// Failed: a file cannot be written.
    pub(crate) fn beside(self, files: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
        let is_figure = |file: &&PathBuf| file.extension().is_some_and(|kind| kind == "svg");
        let figures: Vec<&PathBuf> = files.iter().filter(is_figure).collect();
        if !self.png || figures.is_empty() {
            return Ok(Vec::new());
        }
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let share = figures.len().div_ceil(threads);
        std::thread::scope(|scope| {
            let shares: Vec<_> = figures
                .chunks(share)
                .map(|share| scope.spawn(move || share.iter().map(|file| draw(file)).collect()))
                .collect();
            let joined = shares.into_iter().map(|share| {
                // A panic there is a bug and goes on here.
                let drawn: Vec<Result<PathBuf, CliError>> = share
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                drawn
            });
            joined.flatten().collect()
        })
    }
}

fn draw(file: &Path) -> Result<PathBuf, CliError> {
    let picture = file.with_extension("png");
    let written = std::fs::read_to_string(file)
        .and_then(|svg| png(&svg).map_err(|error| io::Error::other(error.to_string())))
        .and_then(|bytes| std::fs::write(&picture, bytes));
    written.map_err(|error| unwritable(&picture, &error))?;
    Ok(picture)
}
