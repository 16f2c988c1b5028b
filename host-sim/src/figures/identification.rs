//! Figure of an identification: torques of the motors, measured and by the parameters.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_calibration::identify::ExplainedTorque;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};

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
    let panel = |(motor, quantity): (usize, &&'static str)| {
        let own = torques.iter().filter(|torque| torque.motor == motor);
        let mut points = Decimator::<3>::new(torques.len() as u64 / 3 + 1);
        for torque in own {
            points.push(
                torque.t,
                [torque.measured_nm, torque.after_nm, torque.before_nm],
            );
        }
        let points = points.finish();
        let curve = |index: usize, label: &'static str| Curve {
            label: label.into(),
            points: points
                .iter()
                .map(|(t, values)| (*t, values[index]))
                .collect(),
            ..Curve::default()
        };
        Panel {
            quantity,
            unit: "N m",
            from_zero: false,
            curves: vec![curve(0, "measured"), curve(1, "found"), curve(2, "before")],
            ..Panel::default()
        }
    };
    let panels: Vec<Panel> = MOTORS.iter().enumerate().map(panel).collect();
    let title = format!("{name}: torques, measured and by the parameters");
    results.figure("torques.svg", draw(&title, &panels))
}
