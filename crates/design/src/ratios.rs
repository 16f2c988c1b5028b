//! Velocity ratios of a machine at a pose, and the forces and errors that follow from them.

use nalgebra::{Matrix3, Vector3};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::{JobPlayer, Scene};

/// The inverse by cofactors; none of a matrix that has none in numbers.
fn inverted(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let rows: [Vector3<f64>; 3] = [0, 1, 2].map(|row| matrix.row(row).transpose());
    let columns = [
        rows[1].cross(&rows[2]),
        rows[2].cross(&rows[0]),
        rows[0].cross(&rows[1]),
    ];
    let determinant = rows[0].dot(&columns[0]);
    let inverse = Matrix3::from_columns(&columns) / determinant;
    inverse
        .iter()
        .all(|value| value.is_finite())
        .then_some(inverse)
}

/// Ratios between the three motors and the platform. The inverse Jacobian maps the platform's velocity (m/s, m/s, rad/s) to the
/// rates of the motors, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios {
    /// The inverse Jacobian, a row for each motor.
    pub inverse: Matrix3<f64>,
    /// Its inverse: the velocity of the platform, by the rates.
    pub jacobian: Matrix3<f64>,
    /// Distances to the serial singularities, the least of the legs, and to the parallel one, 0 to 1.
    pub distances: [f64; 2],
}

impl Ratios {
    /// Ratios of `machine` at `pose`; none where it cannot stand.
    pub fn at(machine: &dyn Pipeline<f64>, pose: Pose<f64>) -> Option<Self> {
        let mut inverse = Matrix3::zeros();
        let mut distances = [0.0; 2];
        for axis in 0..3 {
            let setpoint = Setpoint {
                pose,
                velocity: Vector3::ith(axis, 1.0),
                acceleration: Vector3::zeros(),
            };
            let record = machine.evaluate(0.0, &setpoint).ok()?;
            for (motor, leg) in record.legs.iter().enumerate() {
                inverse[(motor, axis)] = leg.dth1;
            }
            let serial = record.legs.iter().map(|leg| leg.serial);
            distances = [serial.fold(1.0, f64::min), record.parallel];
        }
        Some(Self {
            inverse,
            jacobian: inverted(&inverse)?,
            distances,
        })
    }

    /// Largest rate of a motor for a speed of D of 1 m/s in the worst direction, rad/s: the platform does not turn.
    pub fn rate_per_speed(&self) -> f64 {
        let rows = self.inverse.row_iter();
        rows.map(|row| row[0].hypot(row[1])).fold(0.0, f64::max)
    }

    /// Largest torque of a motor at rest for a force on D of 1 N in the worst direction, N m.
    pub fn torque_per_force(&self) -> f64 {
        // Powers are the same on both sides: torques are the transposed Jacobian times the wrench.
        let columns = self.jacobian.column_iter();
        columns
            .map(|column| column[0].hypot(column[1]))
            .fold(0.0, f64::max)
    }

    /// Largest distance of D from where it should be for angles of the motors that are off by 1 rad each in the worst
    /// combination, m; to first order.
    pub fn offset_per_error(&self) -> f64 {
        let signs = [
            [1.0, 1.0, 1.0],
            [1.0, 1.0, -1.0],
            [1.0, -1.0, 1.0],
            [-1.0, 1.0, 1.0],
        ];
        let off = signs.map(|signs| {
            let moved = self.jacobian * Vector3::from(signs);
            moved[0].hypot(moved[1])
        });
        off.into_iter().fold(0.0, f64::max)
    }
}

/// Ratios of the platform's rates to those of the motors at an instant of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioInstant {
    /// Time, s.
    pub t_s: f64,
    /// Velocity of the platform over the rate of each motor, a column for each motor (m, m, 1): the velocity ratios of the source. They
    /// depend on the motion, and are not finite where the motor stands.
    pub velocity_ratios: Matrix3<f64>,
    /// The Jacobian: velocity of the platform where one motor turns at 1 rad/s and the others stand. It depends on the pose alone.
    pub jacobian: Matrix3<f64>,
}

/// Instants of a job, at most.
const INSTANTS: u32 = 1_000;

/// Part of its largest rate below which a motor is taken to stand.
const STANDS: f64 = 0.02;

/// Ratios along the job of `scene`.
///
/// # Errors
/// The machine is refused, or the job leads where it cannot stand.
pub fn along_job(scene: &Scene) -> Result<Vec<RatioInstant>, String> {
    let machine = pipeline::of_scene::<f64>(scene, Units::SI).map_err(|error| error.to_string())?;
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let step = player.ticks() / INSTANTS + 1;
    let mut instants = Vec::new();
    for tick in (0..=player.ticks()).step_by(step as usize) {
        let (t_s, setpoint) = (f64::from(tick) * scene.period_s(), player.at(tick));
        let record = machine
            .evaluate(t_s, &setpoint)
            .map_err(|status| format!("at t = {t_s} s: {status}"))?;
        let ratios = Ratios::at(&*machine, setpoint.pose)
            .ok_or_else(|| format!("at t = {t_s} s: the platform is not held"))?;
        instants.push((record, ratios.jacobian));
    }
    let most = |motor: usize| {
        let rates = instants
            .iter()
            .map(|(record, _)| record.legs[motor].dth1.abs());
        rates.fold(0.0, f64::max)
    };
    let most = [most(0), most(1), most(2)];
    let ratios = instants.iter().map(|(record, jacobian)| RatioInstant {
        t_s: record.t,
        velocity_ratios: Matrix3::from_fn(|axis, motor| {
            let rate = record.legs[motor].dth1;
            match rate.abs() > STANDS * most[motor] {
                true => record.velocity[axis] / rate,
                false => f64::NAN,
            }
        }),
        jacobian: *jacobian,
    });
    Ok(ratios.collect())
}
