//! Forward dynamics against the inverse dynamics of others: the accelerations that the plant finds
//! under given torques take those torques, by the core's virtual work and by the 21 equations of
//! Newton and Euler in 31 digits.

use crate::scenes::{shipped, without_drives};
use nalgebra::{Vector2, Vector3};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_integrate::{End, Integrator, Method};
use trirrr_plant::control::Continuous;
use trirrr_plant::{Control, Plant};
use trirrr_scene::{Scene, pipeline};
use trirrr_truth::inputs::Inputs;

/// Poses, velocities and torques around the start of a scene's job, no two alike.
fn states(scene: &Scene) -> impl Iterator<Item = ([f64; 8], [f64; 3])> + '_ {
    let start = scene.job.start;
    (0..200).map(move |case| {
        // Incommensurable frequencies: the sequence never repeats.
        let wave = |frequency: f64, size: f64| size * (frequency * f64::from(case) + 0.3).sin();
        let state = [
            start.position.x + wave(1.1, 0.03),
            start.position.y + wave(1.3, 0.03),
            start.angle + wave(0.7, 0.3),
            wave(1.7, 1.0),
            wave(1.9, 1.0),
            wave(2.3, 8.0),
            0.0,
            0.0,
        ];
        (state, [wave(2.9, 2.0), wave(3.1, 2.0), wave(3.7, 2.0)])
    })
}

#[test]
fn accelerations_take_the_torques_that_caused_them() {
    for name in ["thesis", "thesis-links", "vertical", "chained"] {
        let scene = without_drives(name);
        let core = pipeline::build::<f64>(&scene.parameters).unwrap();
        let mut worst = (0.0_f64, 0.0_f64);
        for (state, torques) in states(&scene) {
            let (mut plant, _) = Plant::<8>::build(&scene, Control::Held).unwrap();
            plant.hold(torques);
            let a = plant.accelerations(0.0, &state).unwrap();
            let setpoint = Setpoint {
                pose: Pose {
                    position: Vector2::new(state[0], state[1]),
                    angle: state[2],
                },
                velocity: Vector3::new(state[3], state[4], state[5]),
                acceleration: Vector3::from(a),
            };
            let motors = core.motors(&setpoint).unwrap();
            let inputs = Inputs::exact(&scene.parameters, &setpoint);
            let kinematics = inputs.kinematics();
            let truth = inputs.dynamics(&kinematics);
            for (leg, applied) in torques.iter().enumerate() {
                let found = motors[leg].torque - applied;
                let exact = truth.torques[leg].value() - applied;
                worst.0 = worst.0.max(found.abs());
                worst.1 = worst.1.max(exact.abs());
            }
        }
        println!(
            "{name}: core {:.1e} N m, Newton-Euler {:.1e} N m",
            worst.0, worst.1
        );
        // Torques of 2 N m and inertial moments of the same size (8 rad/s, up to 600 rad/s^2), a
        // mass matrix of condition below 100: 100 * 2^-53 * a few dozen roundings * 2 N m.
        assert!(worst.0 < 1e-12 && worst.1 < 1e-12, "{name}: {worst:?}");
        // Something was computed: rounding errors are not zero.
        assert!(worst.1 > 1e-17, "{name}");
    }
}

/// A whole run under control: at the end of every step, the core's inverse dynamics of the plant's own
/// motion gives the torques of its motors, rotors, links and platform moved.
#[test]
fn inverse_dynamics_of_its_own_motion_gives_back_its_torques() {
    let scene = shipped("plant-reference");
    let continuous = Continuous::build(&scene, scene.controller.unwrap()).unwrap();
    let control = Control::Continuous(Box::new(continuous));
    let (mut plant, mut y) = Plant::<11>::build(&scene, control).unwrap();
    let core = pipeline::build::<f64>(&scene.parameters).unwrap();
    let method = Method::RadauIia { tolerance: 1e-10 };
    let mut integrator = Integrator::new(&plant, method).unwrap();
    let (mut worst, mut largest, mut compared) = (0.0_f64, 0.0_f64, 0);
    let end = integrator.run(&mut plant, 0.0, &mut y, 1.2, |plant, step| {
        let (t, y) = (step.end(), step.last());
        let setpoint = Setpoint {
            pose: Pose {
                position: Vector2::new(y[0], y[1]),
                angle: y[2],
            },
            velocity: Vector3::new(y[3], y[4], y[5]),
            acceleration: Vector3::from(plant.accelerations(t, y).unwrap()),
        };
        let motors = core.motors(&setpoint).unwrap();
        let outputs = plant.outputs(t, y).unwrap();
        for (motor, torque) in motors.iter().zip(outputs.torques) {
            worst = worst.max((motor.torque - torque).abs());
            largest = largest.max(torque.abs());
            compared += 1;
        }
    });
    assert_eq!(end, Ok(End::Reached));
    println!("{worst:.1e} of {largest:.3} N m, {compared} torques");
    // As above: rounding, of torques up to 0.06 N m.
    assert!(compared > 300 && largest > 0.03);
    assert!(worst < 1e-14, "{worst}");
}
