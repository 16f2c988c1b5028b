//! Figures of a run as SVG: the thesis's figures 5.1 to 5.4 against time, the machine drawn
//! to scale with the path of its tool, and the animation as a page. `docs/figures.md` lists them.

mod animation;
#[cfg(feature = "full")]
mod calibration;
mod catalogue;
mod coloured_path;
mod drives;
#[cfg(feature = "full")]
mod geometry;
#[cfg(feature = "full")]
mod identification;
mod job;
mod machine;
mod plan;
mod plant;
mod preview;
mod refused;
mod tolerances;
mod traces;

pub(crate) use animation::Animation;
#[cfg(feature = "full")]
pub use calibration::CalibrationFigures;
pub(crate) use drives::drive_figure;
#[cfg(feature = "full")]
pub(crate) use geometry::draw as draw_geometry;
#[cfg(feature = "full")]
pub use identification::write_torques;
pub use job::DrawnJob;
#[cfg(feature = "full")]
pub(crate) use job::limit_lines;
#[cfg(feature = "full")]
pub(crate) use machine::pose_marks;
pub(crate) use plan::plan_figure;
pub use plant::{PlantRow, PlantTraces};
pub use preview::Preview;
pub(crate) use refused::RefusedJob;
pub use tolerances::ToleranceTraces;
pub use traces::{MotorCurves, Traces};

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::chart::Gathered;

/// Draws `figures` over time into the folder of `results`, and returns the files. `heading` begins every title.
///
/// # Errors
/// Failed: a file that cannot be drawn or written.
pub(crate) fn write(
    results: &mut ResultFolder,
    heading: &str,
    figures: &[Gathered],
) -> Result<Vec<PathBuf>, CliError> {
    let files = figures.iter();
    files
        .map(|figure| results.figure(figure.file, figure.draw(heading)))
        .collect()
}
