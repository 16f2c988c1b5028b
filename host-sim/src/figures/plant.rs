//! Figures of a simulated plant: how far it is off, and what its motors do.

use super::FigureError;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_plant::motor::wrapped;
use trirrr_plant::table::Row;

const MOTORS: [&str; 3] = ["motor 1", "motor 2", "motor 3"];

/// One panel's curves while they are gathered.
struct Gathered {
    quantity: &'static str,
    unit: &'static str,
    labels: &'static [&'static str],
    values: fn(&Row) -> [f64; 3],
    points: Decimator<3>,
}

/// Rows of a run, thinned out for the figures in bounded memory.
pub struct PlantTraces {
    figures: [(&'static str, &'static str, Vec<Gathered>); 3],
}

impl PlantTraces {
    /// For a run of about `rows` rows.
    pub fn new(rows: u64) -> Self {
        let panel = |quantity, unit, labels, values: fn(&Row) -> [f64; 3]| Gathered {
            quantity,
            unit,
            labels,
            values,
            points: Decimator::new(rows),
        };
        let joints = &["joint 1", "joint 2", "joint 3"];
        Self {
            figures: [
                (
                    "tracking.svg",
                    "tracking error",
                    vec![
                        panel("tool", "m", &["x", "y"], |row| {
                            [
                                row.pose[0] - row.setpoint[0],
                                row.pose[1] - row.setpoint[1],
                                0.0,
                            ]
                        }),
                        panel("platform angle", "rad", &["alpha"], |row| {
                            [row.pose[2] - row.setpoint[2], 0.0, 0.0]
                        }),
                        panel("joints", "rad", joints, |row| {
                            [0, 1, 2].map(|i| wrapped(row.angles[i] - row.references[i]))
                        }),
                    ],
                ),
                (
                    "current.svg",
                    "currents and voltages of the motors",
                    vec![
                        panel("current", "A", &MOTORS, |row| row.currents),
                        panel("voltage", "V", &MOTORS, |row| row.voltages),
                    ],
                ),
                (
                    "plant_torque.svg",
                    "torques and powers of the motors in the plant",
                    vec![
                        panel("torque", "N m", &MOTORS, |row| row.torques),
                        panel("mechanical power", "W", &MOTORS, |row| row.powers),
                    ],
                ),
            ],
        }
    }

    /// Adds the next row.
    pub fn push(&mut self, row: &Row) {
        for (_, _, panels) in &mut self.figures {
            for panel in panels {
                panel.points.push(row.t, (panel.values)(row));
            }
        }
    }

    /// Draws everything into `folder`, which must exist; the files written.
    ///
    /// # Errors
    /// The file that could not be written, and why.
    pub fn write_all(self, folder: &Path, heading: &str) -> Result<Vec<PathBuf>, FigureError> {
        let mut written = Vec::new();
        for (file, title, gathered) in self.figures {
            let panels: Vec<Panel> = gathered.into_iter().map(Gathered::panel).collect();
            let path = folder.join(file);
            draw(&format!("{heading}: {title}"), &panels)
                .map_err(|error| io::Error::other(error.to_string()))
                .and_then(|svg| std::fs::write(&path, svg))
                .map_err(|source| FigureError {
                    path: path.clone(),
                    source,
                })?;
            written.push(path);
        }
        Ok(written)
    }
}

impl Gathered {
    fn panel(self) -> Panel {
        let points = self.points.finish();
        let curve = |(index, label): (usize, &&'static str)| Curve {
            label: (*label).into(),
            points: points
                .iter()
                .map(|(t, values)| (*t, values[index]))
                .collect(),
        };
        Panel {
            quantity: self.quantity,
            unit: self.unit,
            from_zero: true,
            curves: self.labels.iter().enumerate().map(curve).collect(),
        }
    }
}
