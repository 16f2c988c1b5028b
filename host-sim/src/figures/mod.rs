//! Figures of a run as SVG: the thesis's figures 5.1 to 5.4 against time, and the machine drawn
//! to scale with the path of its tool.

mod calibration;
mod catalogue;
mod drives;
mod identification;
mod machine;
mod plan;
mod plant;
mod preview;
mod tolerances;
mod traces;

pub use calibration::CalibrationFigures;
pub use drives::DriveTraces;
pub use identification::write_torques;
pub use plan::PlanTraces;
pub use plant::PlantTraces;
pub use preview::Preview;
pub use tolerances::ToleranceTraces;
pub use traces::Traces;

use std::io;
use std::path::{Path, PathBuf};

/// Draws everything into `folder`, which must exist, and returns the files written, in order.
///
/// `heading` begins every title: the scene's name, and where the run ended early, when.
///
/// # Errors
/// The file that could not be written, and why.
pub fn write_all(
    folder: &Path,
    heading: &str,
    mut traces: Traces,
) -> Result<Vec<PathBuf>, FigureError> {
    let mut written = Vec::new();
    let mut add = |file: &str, drawn: trirrr_figures::canvas::Drawn| {
        written.push(save(folder.join(file), drawn)?);
        Ok(())
    };
    for (file, title, panels) in traces.panels() {
        add(
            file,
            trirrr_figures::panel::draw(&format!("{heading}: {title}"), &panels),
        )?;
    }
    let title = format!("{heading}: the machine and its path");
    add("machine.svg", machine::draw(&title, &traces.scenery()))?;
    Ok(written)
}

/// Writes a figure to `path`, and returns that.
fn save(path: PathBuf, drawn: trirrr_figures::canvas::Drawn) -> Result<PathBuf, FigureError> {
    drawn
        .map_err(|error| io::Error::other(error.to_string()))
        .and_then(|svg| std::fs::write(&path, svg))
        .map(|()| path.clone())
        .map_err(|source| FigureError { path, source })
}

/// A figure that could not be drawn or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct FigureError {
    /// The file.
    pub path: PathBuf,
    /// Cause.
    pub source: io::Error,
}
