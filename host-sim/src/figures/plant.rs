//! Figures of a simulated plant: how far it is off, and what its motors do.

mod path_error;

use super::catalogue::MOTOR_NAMES;
use super::marks::{JobMarks, of_motors};
use super::traces::MotorCurves;
use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_figures::style::{ANGLE, MOTORS, RGBColor, X, Y};
use trirrr_plant::motor::wrapped;
use trirrr_plant::table::Row;

/// Figure of the way of the platform beside that which is asked.
const PATH_ERROR: &str = "path_error.svg";

/// One panel's curves while they are gathered.
struct Gathered {
    quantity: &'static str,
    unit: &'static str,
    labels: &'static [(&'static str, RGBColor)],
    values: fn(&Row) -> [f64; 3],
    points: Decimator<3>,
}

/// Rows of a run, thinned out for the figures in bounded memory.
pub struct PlantTraces {
    figures: [(&'static str, &'static str, Vec<Gathered>); 3],
    /// Setpoint and place of D: x, y, x, y.
    places: Decimator<4>,
    marks: JobMarks,
}

/// Names and colours of the motors.
const OF_MOTORS: [(&str, RGBColor); 3] = [
    (MOTOR_NAMES[0], MOTORS[0]),
    (MOTOR_NAMES[1], MOTORS[1]),
    (MOTOR_NAMES[2], MOTORS[2]),
];

impl PlantTraces {
    /// For a run of about `rows` rows of a job with `marks`.
    pub fn new(rows: u64, marks: JobMarks) -> Self {
        let panel = |quantity, unit, labels, values: fn(&Row) -> [f64; 3]| Gathered {
            quantity,
            unit,
            labels,
            values,
            points: Decimator::new(rows),
        };
        Self {
            places: Decimator::new(rows),
            marks,
            figures: [
                (
                    "tracking.svg",
                    "tracking error",
                    vec![
                        panel("position of D", "m", &[("x", X), ("y", Y)], |row| {
                            [
                                row.pose[0] - row.setpoint[0],
                                row.pose[1] - row.setpoint[1],
                                0.0,
                            ]
                        }),
                        panel("orientation", "rad", &[("\u{3b1}", ANGLE)], |row| {
                            [row.pose[2] - row.setpoint[2], 0.0, 0.0]
                        }),
                        panel("angle at the motor's joint", "rad", &OF_MOTORS, |row| {
                            [0, 1, 2].map(|i| wrapped(row.angles[i] - row.references[i]))
                        }),
                    ],
                ),
                (
                    "current.svg",
                    "currents and voltages of the motors",
                    vec![
                        panel("current", "A", &OF_MOTORS, |row| row.currents),
                        panel("voltage", "V", &OF_MOTORS, |row| row.voltages),
                    ],
                ),
                (
                    "plant_torque.svg",
                    "torques and powers of the motors in the plant",
                    vec![
                        panel("torque", "N m", &OF_MOTORS, |row| row.torques),
                        panel("mechanical power", "W", &OF_MOTORS, |row| row.powers),
                    ],
                ),
            ],
        }
    }

    /// Names of the files that [`write_all`](Self::write_all) writes.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        let figures = self.figures.iter().map(|(file, ..)| *file);
        figures.chain([PATH_ERROR])
    }

    /// Adds the next row.
    pub fn push(&mut self, row: &Row) {
        for (_, _, panels) in &mut self.figures {
            for panel in panels {
                panel.points.push(row.t, (panel.values)(row));
            }
        }
        let ([xd, yd, _], [x, y, _]) = (row.setpoint, row.pose);
        self.places.push(row.t, [xd, yd, x, y]);
    }

    /// Draws everything into the folder of `results`; the files written. `asked` are the torques and powers of the job, drawn beside
    /// those of the plant.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write_all(
        self,
        results: &mut ResultFolder,
        heading: &str,
        asked: MotorCurves,
    ) -> Result<Vec<PathBuf>, CliError> {
        let mut written = Vec::new();
        let limits = &self.marks.limits;
        for (file, title, gathered) in self.figures {
            let mut panels: Vec<Panel> = gathered.into_iter().map(Gathered::panel).collect();
            for panel in &mut panels {
                let (limit, points) = match panel.quantity {
                    "torque" => (limits.torque_nm, &asked.torques),
                    "mechanical power" => (limits.power_w, &asked.powers),
                    _ => (None, &None),
                };
                panel.limits = of_motors(limit);
                panel.marks.clone_from(&self.marks.ends_s);
                panel.curves.extend(points.iter().flat_map(ideal));
            }
            let drawn = draw(&format!("{heading}: {title}"), &panels);
            written.push(results.figure(file, drawn)?);
        }
        let drawn = path_error::draw(heading, &self.places.finish());
        written.push(results.figure(PATH_ERROR, drawn)?);
        Ok(written)
    }
}

/// Darker, so that it is seen on top of the plant's curve.
fn dark(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    RGBColor(red / 2, green / 2, blue / 2)
}

/// Curves of an ideal machine, dashed.
fn ideal(points: &[Vec<(f64, f64)>; 3]) -> impl Iterator<Item = Curve> {
    const LABELS: [&str; 3] = ["ideal 1", "ideal 2", "ideal 3"];
    (0..3).map(|motor| Curve {
        label: LABELS[motor].into(),
        points: points[motor].clone(),
        colour: Some(dark(MOTORS[motor])),
        dashed: true,
    })
}

impl Gathered {
    fn panel(self) -> Panel {
        let points = self.points.finish();
        let curve = |(index, (label, colour)): (usize, &(&'static str, RGBColor))| Curve {
            label: (*label).into(),
            points: points
                .iter()
                .map(|(t, values)| (*t, values[index]))
                .collect(),
            colour: Some(*colour),
            dashed: false,
        };
        Panel {
            quantity: self.quantity,
            unit: self.unit,
            from_zero: true,
            curves: self.labels.iter().enumerate().map(curve).collect(),
            ..Panel::default()
        }
    }
}
