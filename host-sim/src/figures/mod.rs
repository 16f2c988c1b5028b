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
mod machine;
mod marks;
mod plan;
mod plant;
mod preview;
mod redundant;
mod refused;
mod tolerances;
mod traces;

pub(crate) use animation::Animation;
#[cfg(feature = "full")]
pub use calibration::CalibrationFigures;
pub use drives::DriveTraces;
#[cfg(feature = "full")]
pub(crate) use geometry::draw as draw_geometry;
#[cfg(feature = "full")]
pub use identification::write_torques;
#[cfg(feature = "full")]
pub(crate) use machine::draw_pose;
pub use marks::JobMarks;
pub use plan::PlanTraces;
pub use plant::PlantTraces;
pub use preview::Preview;
pub use redundant::{RedundantPlantTraces, RedundantTraces};
pub(crate) use refused::RefusedJob;
pub use tolerances::ToleranceTraces;
pub use traces::{MotorCurves, Traces};

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::canvas::Drawn;

/// Names of the files that [`write_all`] writes, for a scene with `torque` or without.
pub fn names(torque: bool) -> impl Iterator<Item = &'static str> {
    let over_time = catalogue::figures(torque).map(|figure| figure.file);
    over_time.chain(["machine.svg", "path.svg", ANIMATION])
}

/// Name of the animation's page.
const ANIMATION: &str = "animation.html";

/// Draws everything into the folder of `results`, and returns the files written, in order, and the curves of the motors.
///
/// `heading` begins every title: the scene's name, and where the run ended early, when.
///
/// # Errors
/// Failed: a file that cannot be drawn or written.
pub fn write_all(
    results: &mut ResultFolder,
    heading: &str,
    mut traces: Traces,
) -> Result<(Vec<PathBuf>, MotorCurves), CliError> {
    let mut written = Vec::new();
    let mut add = |file: &str, drawn: Drawn| -> Result<(), CliError> {
        written.push(results.figure(file, drawn)?);
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
    add(ANIMATION, Ok(animation.page(heading)))?;
    Ok((written, motors))
}
