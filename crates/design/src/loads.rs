//! Torques that loads and accelerations ask for at a pose, and the force and the compliance that motors give.

use crate::ratios::Ratios;
use nalgebra::{Matrix2, Matrix3, Vector3};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_scene::Scene;
use trirrr_scene::pipeline::Pipeline;

/// Statics and inertia of a machine at a pose, at rest and without friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseLoads {
    /// Velocity ratios.
    pub ratios: Ratios,
    /// Torques of the motors that hold the machine against gravity and its wrench, N m.
    pub at_rest_nm: [f64; 3],
    /// Torques, a row for each motor, for accelerations of the platform of 1 m/s^2, 1 m/s^2 and 1 rad/s^2.
    pub inertia: Matrix3<f64>,
}

impl PoseLoads {
    /// Loads of `machine`, which computes torques, at `pose`; none where it cannot stand.
    pub fn at(machine: &dyn Pipeline<f64>, pose: Pose<f64>) -> Option<Self> {
        let torques = |acceleration: Vector3<f64>| {
            let setpoint = Setpoint {
                pose,
                velocity: Vector3::zeros(),
                acceleration,
            };
            let record = machine.evaluate(0.0, &setpoint).ok()?;
            Some(record.legs.map(|leg| leg.torque))
        };
        let at_rest_nm = torques(Vector3::zeros())?;
        let mut inertia = Matrix3::zeros();
        for axis in 0..3 {
            let loaded = torques(Vector3::ith(axis, 1.0))?;
            for motor in 0..3 {
                inertia[(motor, axis)] = loaded[motor] - at_rest_nm[motor];
            }
        }
        Some(Self {
            ratios: Ratios::at(machine, pose)?,
            at_rest_nm,
            inertia,
        })
    }

    /// Torque of `motor` for 1 N on D in the worst direction, N m.
    fn per_force(&self, motor: usize) -> f64 {
        // Powers are the same on both sides: torques are the transposed Jacobian times the force.
        let column = self.ratios.jacobian.column(motor);
        column[0].hypot(column[1])
    }

    /// Largest torque of a motor, N m, that holds the masses, gravity and the wrench of the scene, with a force on D of `force_n` and an
    /// acceleration of D of `acceleration_m_s2`, each in its worst direction. The platform does not turn.
    pub fn torque_nm(&self, force_n: f64, acceleration_m_s2: f64) -> f64 {
        let of_motor = |motor: usize| {
            let inertia = self.inertia.row(motor);
            let turning = inertia[0].hypot(inertia[1]);
            self.at_rest_nm[motor].abs()
                + force_n * self.per_force(motor)
                + acceleration_m_s2 * turning
        };
        (0..3).map(of_motor).fold(0.0, f64::max)
    }

    /// Largest force on D that the machine holds at rest in every direction with motors that give `limits_nm`, N; 0 where they do not hold
    /// the machine itself.
    pub fn force_n(&self, limits_nm: [f64; 3]) -> f64 {
        let of_motor = |motor: usize| {
            let left = limits_nm[motor] - self.at_rest_nm[motor].abs();
            left.max(0.0) / self.per_force(motor)
        };
        (0..3).map(of_motor).fold(f64::INFINITY, f64::min)
    }

    /// Largest displacement of D for a force of 1 N on it, m/N, of joints with `stiffness_nm_rad` between motor and link: that in the worst
    /// direction. Links and bearings are rigid.
    pub fn compliance_m_n(&self, stiffness_nm_rad: [f64; 3]) -> f64 {
        let jacobian = &self.ratios.jacobian;
        let mut compliance = Matrix2::<f64>::zeros();
        for (motor, stiffness) in stiffness_nm_rad.into_iter().enumerate() {
            let column = jacobian.fixed_view::<2, 1>(0, motor);
            compliance += column * column.transpose() / stiffness;
        }
        // The greater eigenvalue of a symmetric matrix.
        let mean = 0.5 * compliance.trace();
        let half = 0.5 * (compliance[(0, 0)] - compliance[(1, 1)]);
        mean + half.hypot(compliance[(0, 1)])
    }
}

/// Stiffness between each motor and its link that `scene` gives, N m/rad: that of the transmission of its plant, otherwise that of its
/// drives; none of a scene that gives none to each motor.
pub fn stiffness_nm_rad(scene: &Scene) -> Option<[f64; 3]> {
    use trirrr_scene::DriveKind;
    let plant = scene.plant.as_ref().and_then(|plant| plant.transmission);
    if let Some(transmission) = plant {
        return Some(transmission.map(|each| each.stiffness_nm_rad));
    }
    let [one, two, three] = scene.drives?.map(|drive| match drive.kind {
        DriveKind::Bldc(bldc) => bldc.stiffness_nm_rad,
        _ => None,
    });
    Some([one?, two?, three?])
}
