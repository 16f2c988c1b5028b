//! A table of `trirrr run` as a recording.

use crate::error::FoxgloveError;
use crate::topics::Topics;
use nalgebra::Vector3;
use std::path::Path;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::{Scene, pipeline};

/// Columns that are read: time, pose, velocity and acceleration of the platform, and the tool.
const COLUMNS: [&str; 11] = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha", "tool",
];

/// Gives out each row of `table`, at its time since 1970. Motors and drawings are those of the machine of `scene` at the setpoint.
///
/// # Errors
/// Refused: a table that cannot be read, lacks a column, or has a cell that is no number; a setpoint that the machine does not reach.
pub(crate) fn play(table: &Path, scene: &Scene, topics: &mut Topics) -> Result<(), FoxgloveError> {
    let name = table.display();
    let refused = |reason: String| FoxgloveError::Refused(format!("{name}: {reason}"));
    let machine = pipeline::of_scene::<f64>(scene, Units::SI)
        .map_err(|error| FoxgloveError::Refused(error.to_string()))?;
    let mut reader = csv::Reader::from_path(table).map_err(|error| refused(error.to_string()))?;
    let header = reader
        .headers()
        .map_err(|error| refused(error.to_string()))?;
    let place = |column: &str| {
        let place = header.iter().position(|name| name == column);
        place.ok_or_else(|| {
            refused(format!(
                "no column {column}: give ticks.csv as `trirrr run` writes it"
            ))
        })
    };
    let places: Vec<usize> = COLUMNS.into_iter().map(place).collect::<Result<_, _>>()?;
    for row in reader.records() {
        let row = row.map_err(|error| refused(error.to_string()))?;
        let line = row.position().map_or(0, csv::Position::line);
        let mut values = [0.0; COLUMNS.len()];
        for ((value, place), column) in values.iter_mut().zip(&places).zip(COLUMNS) {
            let cell = row.get(*place).unwrap_or_default();
            *value = cell.trim().parse().map_err(|_| {
                refused(format!(
                    "line {line}: {column} is {cell:?}, expected a number"
                ))
            })?;
        }
        let [t, x, y, alpha, vx, vy, valpha, ax, ay, aalpha, tool] = values;
        let setpoint = Setpoint {
            pose: Pose::from_f64(x, y, alpha),
            velocity: Vector3::new(vx, vy, valpha),
            acceleration: Vector3::new(ax, ay, aalpha),
        };
        let record = machine.evaluate(t, &setpoint);
        let mut record = record.map_err(|status| {
            refused(format!(
                "line {line}: {status}; is {} the scene of the table?",
                scene.name
            ))
        })?;
        record.tool = tool;
        // From float to integer the cast saturates.
        topics.record(&record, (1e9 * t).round() as u64);
    }
    Ok(())
}
