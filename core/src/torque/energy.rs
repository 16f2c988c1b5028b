//! The tick against a machine that is written down a second time: by the law of cosines, and by its energy.

use crate::machine::{LegParameters, Parameters, example};
use crate::model::Dynamic;
use crate::setpoint::{Pose, Setpoint};
use crate::tick::Tick;
use crate::torque::links::{InPlane, Massive};
use crate::torque::payload::Offset;
use nalgebra::{Vector2, Vector3};
use std::vec;
use std::vec::Vec;

/// Step of the differences, s.
const STEP_S: f64 = 1e-3;

/// A machine in which everything has mass and nothing is symmetric, under gravity and a wrench.
fn machine() -> Parameters {
    let mut parameters = example();
    parameters.gravity_m_s2 = Vector2::new(1.0, -9.0);
    parameters.wrench_force_n = Vector2::new(0.8, -0.5);
    parameters.wrench_torque_nm = 0.02;
    parameters.platform.com_m = Vector2::new(0.01, 0.03);
    for (leg, factor) in parameters.legs.iter_mut().zip([1.0, 1.2, 0.7]) {
        (leg.proximal.mass_kg, leg.proximal.com_m) = (0.3 * factor, 0.08);
        (leg.distal.mass_kg, leg.distal.com_m) = (0.2 * factor, 0.13);
        (leg.proximal.inertia_kgm2, leg.distal.inertia_kgm2) = (0.002 * factor, 0.001);
        leg.rotor_inertia_kgm2 = 0.003 * factor;
        leg.proximal_m = 0.22;
    }
    parameters
}

fn turned(vector: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(
        cos * vector.x - sin * vector.y,
        sin * vector.x + cos * vector.y,
    )
}

fn along(angle: f64) -> Vector2<f64> {
    turned(Vector2::new(1.0, 0.0), angle)
}

/// Angles of a leg's links for the platform at `pose`.
fn angles(leg: &LegParameters, pose: &Vector3<f64>) -> [f64; 2] {
    let joint = pose.xy() + along(leg.joint_angle_rad + pose.z) * leg.joint_radius_m;
    let reach = joint - leg.base_m;
    let (length, l1, l2) = (reach.x.hypot(reach.y), leg.proximal_m, leg.distal_m);
    let inner = ((length * length + l1 * l1 - l2 * l2) / (2.0 * length * l1)).acos();
    let proximal = reach.y.atan2(reach.x) + leg.elbow.sign() * inner;
    let rest = reach - along(proximal) * l1;
    [proximal, rest.y.atan2(rest.x)]
}

/// Bodies of the machine at `pose`: mass and centre of mass, inertia and angle.
fn bodies(parameters: &Parameters, pose: &Vector3<f64>) -> Vec<(f64, Vector2<f64>, f64, f64)> {
    let platform = &parameters.platform;
    let centre = pose.xy() + turned(platform.com_m, pose.z);
    let mut all = vec![(platform.mass_kg, centre, platform.inertia_kgm2, pose.z)];
    for leg in &parameters.legs {
        let [first, second] = angles(leg, pose);
        let elbow = leg.base_m + along(first) * leg.proximal_m;
        let centres = [
            leg.base_m + along(first) * leg.proximal.com_m,
            elbow + along(second) * leg.distal.com_m,
        ];
        all.push((
            leg.proximal.mass_kg,
            centres[0],
            leg.proximal.inertia_kgm2 + leg.rotor_inertia_kgm2,
            first,
        ));
        all.push((
            leg.distal.mass_kg,
            centres[1],
            leg.distal.inertia_kgm2,
            second,
        ));
    }
    all
}

/// Derivative of `value` at time `t`, by differences of fourth order.
fn derivative(value: &dyn Fn(f64) -> f64, t: f64) -> f64 {
    let across = |step: f64| value(t + step) - value(t - step);
    (8.0 * across(STEP_S) - across(2.0 * STEP_S)) / (12.0 * STEP_S)
}

/// The motors' rates and accelerations are the derivatives of their angles. Their power and that of the wrench change the energy of all
/// bodies, and in six directions of one pose no torque can hide.
#[test]
fn the_motors_give_what_the_energy_takes() {
    let parameters = machine();
    type Loaded = Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>;
    let tick: Tick<Loaded> = Tick::build(&parameters).expect("a machine");
    let start = Vector3::new(0.26, 0.23, 0.2);
    for velocity in [
        [0.3, 0.0, 0.0],
        [0.0, 0.2, 0.0],
        [0.0, 0.0, 1.5],
        [0.2, 0.3, -1.0],
        [-0.3, 0.1, 0.7],
        [0.1, -0.3, 1.2],
    ] {
        let (velocity, acceleration) = (Vector3::from(velocity), Vector3::new(-0.5, 1.0, 2.0));
        let pose = |t: f64| start + velocity * t + acceleration * (t * t / 2.0);
        let setpoint = Setpoint {
            pose: Pose::from_f64(start.x, start.y, start.z),
            velocity,
            acceleration,
        };
        let motors = tick.evaluate(&setpoint).expect("a motion").motors;
        let mut power = parameters.wrench_force_n.dot(&velocity.xy())
            + parameters.wrench_torque_nm * velocity.z;
        for (leg, motor) in parameters.legs.iter().zip(&motors) {
            let angle = |t: f64| angles(leg, &pose(t))[0];
            let rate = |t: f64| derivative(&angle, t);
            let errors = [
                motor.angle - angle(0.0),
                motor.rate - rate(0.0),
                motor.acceleration - derivative(&rate, 0.0),
            ];
            assert!(errors.iter().all(|error| error.abs() < 1e-7), "{errors:?}");
            power += motor.torque * motor.rate;
        }
        let energy = |t: f64| -> f64 {
            let of = |index: usize| {
                let body = |t: f64| bodies(&parameters, &pose(t))[index];
                let (mass, centre, inertia, _) = body(t);
                let [vx, vy, turning] = [
                    derivative(&|t| body(t).1.x, t),
                    derivative(&|t| body(t).1.y, t),
                    derivative(&|t| body(t).3, t),
                ];
                0.5 * (mass * (vx * vx + vy * vy) + inertia * turning * turning)
                    - mass * parameters.gravity_m_s2.dot(&centre)
            };
            (0..7).map(of).sum()
        };
        let error = power - derivative(&energy, 0.0);
        assert!(error.abs() < 1e-7, "{velocity:?}: {error:e}");
    }
}
