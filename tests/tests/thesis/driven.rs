//! Erratum 1, the last word: what the machine does when it is driven by C, and by the true torque.

use crate::job;
use nalgebra::Vector3;
use trirrr_core::machine::Geometry;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::inputs::Inputs;
use trirrr_tests::machines;
use trirrr_tests::thesis_formula;

/// State of the platform: (x, y, alpha) and rates.
type State = [Vector3<f64>; 2];

/// Acceleration of the massless-link machine at a state under `torques`: each leg pushes along its
/// distal link with f = tau / (r1 x r2).
fn acceleration(
    geometry: &Geometry<f64>,
    state: &State,
    torques: [f64; 3],
) -> Result<Vector3<f64>, Status> {
    let [q, _] = state;
    let position = geometry.position(&Pose::from_f64(q.x, q.y, q.z))?;
    let platform = machines::thesis().platform;
    let mut w = Vector3::new(0.0, 0.0, 0.0);
    for (leg, torque) in position.legs.iter().zip(torques) {
        let force = leg.links.r2 * (torque / leg.links.r1_cross_r2);
        w += Vector3::new(force.x, force.y, leg.platform_joint.perp(&force));
    }
    Ok(Vector3::new(
        w.x / platform.mass_kg,
        w.y / platform.mass_kg,
        w.z / platform.inertia_kgm2,
    ))
}

/// Runge-Kutta of fourth order at 1 ms; torques between the samples by a straight line. Gives the
/// distance of D from its setpoint each 0.1 s, and when the platform left the reach of a leg.
fn drive(samples: &[[f64; 3]]) -> (Vec<f64>, Option<f64>) {
    let geometry = Geometry::build(&machines::thesis()).expect("a machine");
    let torque = |time: f64| {
        let index = ((time * 100.0 + 1e-9) as usize).min(99);
        let share = time * 100.0 - index as f64;
        core::array::from_fn(|leg| {
            samples[index][leg] * (1.0 - share) + samples[index + 1][leg] * share
        })
    };
    let start = job().at(0).pose;
    let mut state: State = [
        Vector3::new(start.position.x, start.position.y, start.angle),
        Vector3::new(0.0, 0.0, 0.0),
    ];
    let mut distances = Vec::new();
    let h = 1e-3;
    for step in 0..1000 {
        let time = f64::from(step) * h;
        let slope = |state: &State, time: f64| {
            acceleration(&geometry, state, torque(time)).map(|a| [state[1], a])
        };
        let moved = |by: &State, h: f64| [state[0] + by[0] * h, state[1] + by[1] * h];
        let next = slope(&state, time).and_then(|k1| {
            let k2 = slope(&moved(&k1, h / 2.0), time + h / 2.0)?;
            let k3 = slope(&moved(&k2, h / 2.0), time + h / 2.0)?;
            let k4 = slope(&moved(&k3, h), time + h)?;
            let sum = [0, 1].map(|i| (k1[i] + k2[i] * 2.0 + k3[i] * 2.0 + k4[i]) / 6.0);
            Ok(moved(&sum, h))
        });
        match next {
            Ok(next) => state = next,
            Err(_) => return (distances, Some(time)),
        }
        if (step + 1) % 100 == 0 {
            let tick = u32::try_from((step + 1) / 10).expect("a tick");
            let wanted = job().at(tick).pose.position;
            distances.push((state[0].x - wanted.x).hypot(state[0].y - wanted.y));
        }
    }
    (distances, None)
}

/// C at both ends is 0/0; its limit is that of the quotient of the accelerations, which is what a
/// state with the velocity replaced by the acceleration gives.
fn samples_of_c() -> Vec<[f64; 3]> {
    (0..=100)
        .map(|tick| {
            let mut setpoint = job().at(tick);
            if tick == 0 || tick == 100 {
                setpoint.velocity = setpoint.acceleration;
            }
            thesis_formula::torques(&machines::thesis(), &setpoint)
        })
        .collect()
}

#[test]
fn erratum_1_driven_by_c_the_machine_leaves_its_path() {
    let (distances, left) = drive(&samples_of_c());
    let after_half_a_second = distances[4];
    assert!(
        (after_half_a_second - 0.0881).abs() < 0.0001,
        "{after_half_a_second}"
    );
    let left = left.expect("out of reach");
    assert!((0.795..=0.805).contains(&left), "{left}");
}

#[test]
fn erratum_1_driven_by_the_true_torque_it_follows() {
    let (distances, left) = drive(&crate::true_torques());
    assert_eq!(left, None);
    // 1.33 um at the end come from the straight lines between samples.
    let end = distances[9];
    assert!((end - 1.33e-6).abs() < 0.01e-6, "{end}");
}

/// The equations of motion used here are those of the independent model.
#[test]
fn the_driven_machine_is_the_models() {
    let parameters = machines::thesis();
    let geometry = Geometry::build(&parameters).expect("a machine");
    let setpoint: Setpoint<f64> = job().at(20);
    let inputs = Inputs::<DoubleDouble>::exact(&parameters, &setpoint);
    let torques = inputs
        .dynamics(&inputs.kinematics())
        .torques
        .map(DoubleDouble::value);
    let pose = &setpoint.pose;
    let state = [
        Vector3::new(pose.position.x, pose.position.y, pose.angle),
        setpoint.velocity,
    ];
    let found = acceleration(&geometry, &state, torques).expect("in reach");
    let error = found - setpoint.acceleration;
    assert!(
        error.x.hypot(error.y) < 1e-13 && error.z.abs() < 1e-13,
        "{error}"
    );
}
