//! Figures of a simulated plant: how far it is off, and what its motors do.

mod path_error;

use super::job::{DrawnJob, of_motors};
use super::traces::{MotorCurves, MotorPoints};
use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::chart::{Chart, Figure, Gathering, Series};
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::Curve;
use trirrr_figures::style::{ANGLE, CURVES, RGBColor, X, Y};
use trirrr_plant::motor::wrapped;
use trirrr_plant::redundant::RedundantRow;
use trirrr_plant::table::Row;

/// Figure of the way of the platform beside that which is asked.
const PATH_ERROR: &str = "path_error.svg";

/// Row of a plant of a machine of any kind.
pub trait PlantRow: 'static {
    /// Time, s.
    fn t(&self) -> f64;

    /// Pose of the platform.
    fn pose(&self) -> [f64; 3];

    /// Pose less that of the setpoint.
    fn error(&self) -> [f64; 3];

    /// Angle of the motor's joint less that of the setpoint, rad.
    fn joint_error(&self, motor: usize) -> f64;

    /// Values of the columns of `plant.csv`.
    fn values(&self) -> Vec<f64>;
}

impl PlantRow for Row {
    fn t(&self) -> f64 {
        self.t
    }

    fn pose(&self) -> [f64; 3] {
        self.pose
    }

    fn error(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.pose[axis] - self.setpoint[axis])
    }

    fn joint_error(&self, motor: usize) -> f64 {
        wrapped(self.angles[motor] - self.references[motor])
    }

    fn values(&self) -> Vec<f64> {
        Row::values(self).into()
    }
}

impl PlantRow for RedundantRow {
    fn t(&self) -> f64 {
        self.t
    }

    fn pose(&self) -> [f64; 3] {
        self.pose
    }

    fn error(&self) -> [f64; 3] {
        self.error
    }

    fn joint_error(&self, motor: usize) -> f64 {
        self.joint_errors[motor]
    }

    fn values(&self) -> Vec<f64> {
        let first = std::iter::once(self.t).chain(self.pose).chain(self.error);
        let motors = self.joint_errors.iter().chain(&self.torques);
        let sliders = self.slider_errors.iter().chain(&self.forces);
        let all = first.chain(motors.copied());
        all.chain(sliders.copied().flatten()).collect()
    }
}

/// Rows of a run, thinned out for the figures in bounded memory.
pub struct PlantTraces<R> {
    over_time: Gathering<R>,
    /// Setpoint and place of D: x, y, x, y.
    places: Decimator<4>,
    ends_s: Vec<f64>,
}

/// Panel whose axis includes zero.
fn chart<R>(
    quantity: &'static str,
    unit: &'static str,
    series: impl IntoIterator<Item = Series<R>>,
) -> Chart<R> {
    Chart::new(quantity, unit, series).with_zero()
}

/// Errors of D, of the platform's angle and of the joints.
fn errors<R: PlantRow>(job: &DrawnJob) -> Vec<Chart<R>> {
    let axis = |label, axis: usize, colour| {
        Series::new(label, move |row: &R| row.error()[axis]).coloured(colour)
    };
    vec![
        chart("position of D", "m", [axis("x", 0, X), axis("y", 1, Y)]),
        chart("orientation", "rad", [axis("\u{3b1}", 2, ANGLE)]),
        chart(
            "angle at the motor's joint",
            "rad",
            Series::numbered("motor", job.legs, R::joint_error),
        ),
    ]
}

impl PlantTraces<Row> {
    /// For a run of about `rows` rows of a `job`.
    pub fn new(rows: u64, job: DrawnJob) -> Self {
        let motors = |value: fn(&Row) -> &[f64; 3]| {
            Series::numbered("motor", 3, move |row: &Row, motor| value(row)[motor])
        };
        let limits = &job.limits;
        let torque = chart("torque", "N m", motors(|row| &row.torques));
        let power = chart("mechanical power", "W", motors(|row| &row.powers));
        let figures = vec![
            Figure::new("tracking.svg", "tracking error", errors(&job)),
            Figure::new(
                "current.svg",
                "currents and voltages of the motors",
                [
                    chart("current", "A", motors(|row| &row.currents)),
                    chart("voltage", "V", motors(|row| &row.voltages)),
                ],
            ),
            Figure::new(
                "plant_torque.svg",
                "torques and powers of the motors in the plant",
                [
                    torque.within(of_motors(limits.torque_nm.as_ref())),
                    power.within(of_motors(limits.power_w.as_ref())),
                ],
            ),
        ];
        Self::of(rows, job, figures)
    }
}

impl PlantTraces<RedundantRow> {
    /// For a run of about `rows` rows of a `job` of a redundant machine.
    pub fn redundant(rows: u64, job: DrawnJob) -> Self {
        let sliders = |values: fn(&RedundantRow) -> &Vec<Option<f64>>| {
            let series = move |&leg: &usize| {
                let value = move |row: &RedundantRow| values(row)[leg].unwrap_or(0.0);
                Series::new(format!("slider {}", leg + 1), value)
            };
            job.sliders.iter().map(series).collect::<Vec<_>>()
        };
        let torques = Series::numbered("motor", job.legs, |row: &RedundantRow, motor| {
            row.torques[motor]
        });
        let limit = of_motors(job.limits.torque_nm.as_ref());
        let mut loads = vec![chart("torque", "N m", torques).within(limit)];
        let mut errors = errors(&job);
        if !job.sliders.is_empty() {
            errors.push(chart("sliders", "m", sliders(|row| &row.slider_errors)));
            loads.push(chart("force", "N", sliders(|row| &row.forces)));
        }
        let title = "torques and forces of the plant's loops";
        let figures = vec![
            Figure::new("tracking.svg", "tracking error", errors),
            Figure::new("plant_torque.svg", title, loads),
        ];
        Self::of(rows, job, figures)
    }
}

impl<R: PlantRow> PlantTraces<R> {
    fn of(rows: u64, job: DrawnJob, figures: Vec<Figure<R>>) -> Self {
        Self {
            over_time: Gathering::new(rows, figures),
            places: Decimator::new(rows),
            ends_s: job.ends_s,
        }
    }

    /// Names of the files that [`write_all`](Self::write_all) writes.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.over_time.names().chain([PATH_ERROR])
    }

    /// Adds the next row.
    pub fn push(&mut self, row: &R) {
        self.over_time.push(row.t(), row);
        let ([x, y, _], [dx, dy, _]) = (row.pose(), row.error());
        self.places.push(row.t(), [x - dx, y - dy, x, y]);
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
        asked: &MotorCurves,
    ) -> Result<Vec<PathBuf>, CliError> {
        let mut figures = self.over_time.finish(&self.ends_s);
        for panel in figures.iter_mut().flat_map(|figure| &mut figure.panels) {
            let asked = match panel.quantity {
                "torque" => asked.torques.as_ref(),
                "mechanical power" => asked.powers.as_ref(),
                _ => None,
            };
            panel.curves.extend(asked.into_iter().flat_map(ideal));
        }
        let mut written = super::write(results, heading, &figures)?;
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
fn ideal(points: &MotorPoints) -> impl Iterator<Item = Curve> {
    let motors = (1..).zip(points.iter().zip(CURVES));
    motors.map(|(motor, (points, colour)): (u32, _)| Curve {
        label: format!("ideal {motor}").into(),
        points: points.clone(),
        colour: Some(dark(colour)),
        dashed: true,
    })
}
