//! Figures of a run as SVG: the thesis's figures 5.1 to 5.4 against time, the machine drawn
//! to scale with the path of its tool, and the animation as a page. `docs/figures.md` lists them.

mod animation;
mod calibration;
mod catalogue;
mod coloured_path;
mod drives;
mod geometry;
mod identification;
mod machine;
mod marks;
mod plan;
mod plant;
mod preview;
mod redundant;
mod refused;
mod tolerances;
mod traces;

pub(crate) use animation::{Animation, escaped};
pub use calibration::CalibrationFigures;
pub use drives::DriveTraces;
pub(crate) use geometry::draw as draw_geometry;
pub use identification::write_torques;
pub(crate) use machine::draw_pose;
pub use marks::JobMarks;
pub use plan::PlanTraces;
pub use plant::PlantTraces;
pub use preview::Preview;
pub use redundant::{RedundantPlantTraces, RedundantTraces};
pub(crate) use refused::RefusedJob;
pub use tolerances::ToleranceTraces;
pub use traces::{MotorCurves, Traces};

use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::canvas::Drawn;

/// Draws everything into `folder`, which must exist, and returns the files written, in order, and the curves of the motors.
///
/// `heading` begins every title: the scene's name, and where the run ended early, when.
///
/// # Errors
/// The file that could not be written, and why.
pub fn write_all(
    folder: &Path,
    heading: &str,
    mut traces: Traces,
) -> Result<(Vec<PathBuf>, MotorCurves), FigureError> {
    let mut written = Vec::new();
    let mut add = |file: &str, drawn: Drawn| {
        written.push(save(folder.join(file), drawn)?);
        Ok(())
    };
    let panels = traces.panels();
    for (file, title, panels) in &panels {
        add(
            file,
            trirrr_figures::panel::draw(&format!("{heading}: {title}"), panels),
        )?;
    }
    let motors = Traces::of_motors(&panels);
    let (scenery, path, animation) = traces.scenery();
    let title = format!("{heading}: the machine and its path");
    add("machine.svg", machine::draw(&title, &scenery))?;
    add("path.svg", coloured_path::draw(heading, &path))?;
    add("animation.html", Ok(animation.page(heading)))?;
    Ok((written, motors))
}

/// Writes a figure to `path`, and returns that.
fn save(path: PathBuf, drawn: Drawn) -> Result<PathBuf, FigureError> {
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
