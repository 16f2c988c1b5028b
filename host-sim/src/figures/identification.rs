//! Figure of an identification: torques of the motors, measured and by the parameters.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_calibration::identify::ExplainedTorque;
use trirrr_figures::chart::{Chart, Figure, Series, gathered};
use trirrr_figures::panel::draw;

const MOTORS: [&str; 3] = ["torque 1", "torque 2", "torque 3"];

/// Draws `torques` of the machine `name` into the folder of `results`; the file written.
///
/// # Errors
/// Failed: a file that cannot be drawn or written.
pub fn write_torques(
    results: &mut ResultFolder,
    name: &str,
    torques: &[ExplainedTorque],
) -> Result<PathBuf, CliError> {
    // Each motor has rows of its own.
    let of_motor = |(motor, quantity): (usize, &&'static str)| {
        let own = torques.iter().filter(|torque| torque.motor == motor);
        let own: Vec<_> = own.map(|torque| (torque.t, torque)).collect();
        let series = [
            Series::new("measured", |torque: &ExplainedTorque| torque.measured_nm),
            Series::new("found", |torque: &ExplainedTorque| torque.after_nm),
            Series::new("before", |torque: &ExplainedTorque| torque.before_nm),
        ];
        let figure = Figure::new("", "", [Chart::new(quantity, "N m", series)]);
        let figures = gathered(vec![figure], own.into_iter());
        figures.into_iter().flat_map(|figure| figure.panels)
    };
    let panels: Vec<_> = MOTORS.iter().enumerate().flat_map(of_motor).collect();
    let title = format!("{name}: torques, measured and by the parameters");
    results.figure("torques.svg", draw(&title, &panels))
}
