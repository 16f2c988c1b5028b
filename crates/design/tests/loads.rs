//! Loads at a pose against the core's own statics with the loads as a wrench, differences of poses, and all directions.

use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_design::loads::{PoseLoads, stiffness_nm_rad};
use trirrr_design::{ratios, reactions};
use trirrr_scene::{JobPlayer, Scene, pipeline};

const DIRECTIONS: u32 = 720;

fn scene(name: &str) -> Scene {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    Scene::read(folder.join(format!("{name}.toml"))).unwrap()
}

fn poses(scene: &Scene) -> Vec<Pose<f64>> {
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let at = |part: u32| player.at(player.ticks() * part / 7).pose;
    (0..=7).map(at).collect()
}

fn loads(parameters: &Parameters, pose: Pose<f64>) -> PoseLoads {
    let machine = pipeline::build_in::<f64>(parameters, Units::SI).unwrap();
    PoseLoads::at(&*machine, pose).unwrap()
}

fn direction(index: u32) -> Vector2<f64> {
    let (sin, cos) = (TAU * f64::from(index) / f64::from(DIRECTIONS)).sin_cos();
    Vector2::new(cos, sin)
}

/// Torques of the machine with the force `force_n` more on D, as the core computes them.
fn torques(
    parameters: &Parameters,
    pose: Pose<f64>,
    force_n: Vector2<f64>,
    acceleration: Vector2<f64>,
) -> [f64; 3] {
    let mut loaded = *parameters;
    loaded.wrench_force_n += force_n;
    let machine = pipeline::build_in::<f64>(&loaded, Units::SI).unwrap();
    let setpoint = Setpoint {
        pose,
        velocity: Vector3::zeros(),
        acceleration: Vector3::new(acceleration.x, acceleration.y, 0.0),
    };
    let record = machine.evaluate(0.0, &setpoint).unwrap();
    record.legs.map(|leg| leg.torque)
}

fn largest(torques: [f64; 3]) -> f64 {
    torques
        .into_iter()
        .fold(0.0, |most: f64, torque| most.max(torque.abs()))
}

#[test]
fn the_torque_of_a_load_is_the_worst_of_all_directions() {
    let scene = scene("vertical");
    let parameters = &scene.parameters;
    let zero = Vector2::zeros();
    for pose in poses(&scene) {
        let found = loads(parameters, pose);
        let over = |of: &dyn Fn(Vector2<f64>) -> [f64; 3]| {
            let all = (0..DIRECTIONS).map(|index| largest(of(direction(index))));
            all.fold(0.0, f64::max)
        };
        let force = over(&|unit| torques(parameters, pose, 20.0 * unit, zero));
        let acceleration = over(&|unit| torques(parameters, pose, zero, 3.0 * unit));
        // Directions are half a degree apart: 1 - cos(0.25 degrees) is 1e-5.
        let close = |own: f64, all: f64| (own / all - 1.0).abs() < 2e-5 && own > all * (1.0 - 1e-9);
        assert!(close(found.torque_nm(20.0, 0.0), force), "{pose:?}");
        assert!(close(found.torque_nm(0.0, 3.0), acceleration), "{pose:?}");
        let rest = torques(parameters, pose, zero, zero);
        assert!((found.torque_nm(0.0, 0.0) - largest(rest)).abs() < 1e-12);
        // Both at once, each in its own direction, on a coarser set.
        let mut both: f64 = 0.0;
        for one in (0..DIRECTIONS).step_by(20) {
            for other in (0..DIRECTIONS).step_by(20) {
                let at = torques(
                    parameters,
                    pose,
                    20.0 * direction(one),
                    3.0 * direction(other),
                );
                both = both.max(largest(at));
            }
        }
        let own = found.torque_nm(20.0, 3.0);
        assert!(
            own >= both * (1.0 - 1e-9) && own < 1.01 * both,
            "{own} {both}"
        );
    }
}

#[test]
fn the_force_within_the_limits_is_held_in_every_direction_and_more_is_not() {
    let scene = scene("vertical");
    let parameters = &scene.parameters;
    let limits = [9.0, 7.0, 8.0];
    for pose in poses(&scene) {
        let force = loads(parameters, pose).force_n(limits);
        assert!(force > 0.0, "{pose:?}");
        let is_held = |force: f64| {
            (0..DIRECTIONS).all(|index| {
                let at = torques(parameters, pose, force * direction(index), Vector2::zeros());
                (0..3).all(|motor| at[motor].abs() <= limits[motor])
            })
        };
        assert!(
            is_held(force * (1.0 - 1e-9)) && !is_held(force * 1.0001),
            "{pose:?}"
        );
    }
    let weak = loads(parameters, scene.job.start).force_n([1e-3; 3]);
    assert_eq!(weak, 0.0);
}

/// The pose at which the motors stand at `angles`, near `pose`, by Newton's method with differences of the inverse kinematics.
fn forward(parameters: &Parameters, pose: Pose<f64>, angles: [f64; 3]) -> Vector3<f64> {
    let machine = pipeline::build_in::<f64>(parameters, Units::SI).unwrap();
    let inverse = |at: &Vector3<f64>| {
        let setpoint = Setpoint {
            pose: Pose::from_f64(at.x, at.y, at.z),
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let record = machine.evaluate(0.0, &setpoint).unwrap();
        Vector3::from(record.legs.map(|leg| leg.th1))
    };
    let mut at = Vector3::new(pose.position.x, pose.position.y, pose.angle);
    for _ in 0..20 {
        let off = inverse(&at) - Vector3::from(angles);
        let columns = [0, 1, 2].map(|axis| {
            let step = 1e-6 * Vector3::ith(axis, 1.0);
            (inverse(&(at + step)) - inverse(&(at - step))) / 2e-6
        });
        at -= nalgebra::Matrix3::from_columns(&columns)
            .try_inverse()
            .unwrap()
            * off;
    }
    at
}

#[test]
fn compliance_is_where_the_platform_goes_when_the_joints_give_way() {
    let scene = scene("vertical");
    let parameters = &scene.parameters;
    let stiffness = [4000.0, 5000.0, 7000.0];
    for pose in poses(&scene).into_iter().step_by(3) {
        let machine = pipeline::build_in::<f64>(parameters, Units::SI).unwrap();
        let at_rest = Setpoint {
            pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let record = machine.evaluate(0.0, &at_rest).unwrap();
        let unloaded = record.legs.map(|leg| leg.torque);
        let mut most: f64 = 0.0;
        for index in (0..DIRECTIONS).step_by(4) {
            // 1 N, small against the stiffness: differences are linear.
            let loaded = torques(parameters, pose, direction(index), Vector2::zeros());
            let angles = [0, 1, 2].map(|motor| {
                // The motor holds against the load: the joint gives way to the other side.
                record.legs[motor].th1 - (loaded[motor] - unloaded[motor]) / stiffness[motor]
            });
            let moved = forward(parameters, pose, angles);
            most = most.max((moved.xy() - pose.position).norm());
        }
        let own = loads(parameters, pose).compliance_m_n(stiffness);
        assert!((own / most - 1.0).abs() < 1e-3, "{own} {most}");
    }
}

#[test]
fn the_stiffness_is_that_of_the_plant_or_of_the_drives() {
    let of_plant = stiffness_nm_rad(&scene("plant-vertical"));
    assert!(of_plant.is_some_and(|each| each.iter().all(|one| *one > 0.0)));
    assert_eq!(stiffness_nm_rad(&scene("thesis")), None);
    assert_eq!(stiffness_nm_rad(&scene("vertical")), None);
}

#[test]
fn ratios_along_the_job_are_differences_of_the_job() {
    let scene = scene("vertical");
    let instants = ratios::along_job(&scene).unwrap();
    let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI).unwrap();
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let record = |tick: u32| {
        let t_s = f64::from(tick) * scene.period_s();
        machine.evaluate(t_s, &player.at(tick)).unwrap()
    };
    let mut compared = 0;
    for (index, instant) in instants.iter().enumerate().skip(1) {
        let tick = (instant.t_s / scene.period_s()).round() as u32;
        if tick + 1 > player.ticks() || player.move_at(tick - 1) != player.move_at(tick + 1) {
            continue;
        }
        let (before, after) = (record(tick - 1), record(tick + 1));
        for motor in 0..3 {
            let turned = after.legs[motor].th1 - before.legs[motor].th1;
            let ratio = instant.velocity_ratios[(0, motor)];
            if ratio.is_finite() && turned.abs() > 2e-3 {
                let difference = (after.pose[0] - before.pose[0]) / turned;
                assert!(
                    (ratio - difference).abs() < 1e-3 * (1.0 + ratio.abs()),
                    "{index}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 500, "{compared}");
    // The Jacobian: the platform where one motor turns alone.
    let pose = scene.job.start;
    let angles = record(0).legs.map(|leg| leg.th1);
    for motor in 0..3 {
        let mut turned = angles;
        turned[motor] += 1e-5;
        let ahead = forward(&scene.parameters, pose, turned);
        turned[motor] -= 2e-5;
        let behind = forward(&scene.parameters, pose, turned);
        let column = (ahead - behind) / 2e-5;
        let off = (instants[0].jacobian.column(motor) - column).norm();
        assert!(off < 1e-6, "{motor}: {off}");
    }
}

#[test]
fn forces_in_the_joints_are_in_the_axes_of_their_links() {
    // Massless links carry nothing across: the force at C, and that at B, lie along the distal link.
    let found = reactions::along_job(&scene("thesis")).unwrap();
    assert!(found.vectors.len() > 50);
    for (leg, peaks) in found.forces.iter().enumerate() {
        let sizes = |joint: usize| {
            let vectors = found.vectors.iter().map(move |vectors| vectors[leg][joint]);
            vectors.map(|[along, across]| along.hypot(across))
        };
        for (joint, peak) in peaks.iter().enumerate() {
            let most = sizes(joint).fold(0.0, f64::max);
            assert!((most / peak.peak_n - 1.0).abs() < 1e-9, "{leg} {joint}");
        }
        for vectors in &found.vectors {
            let [_, _, [_, across]] = vectors[leg];
            assert!(across.abs() < 1e-9 * peaks[2].peak_n.max(1e-3));
        }
    }
    // At B the arm of the force across the proximal link is the torque.
    let scene = scene("thesis");
    let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI).unwrap();
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    for (tick, vectors) in (0..).zip(&found.vectors) {
        let record = machine.evaluate(0.0, &player.at(tick)).unwrap();
        for (leg, [_, [_, across], _]) in vectors.iter().enumerate() {
            let arm = scene.parameters.legs[leg].proximal_m * across;
            // The distal link is pulled at by the proximal one, which the motor turns.
            assert!((arm - record.legs[leg].torque).abs() < 1e-9, "{tick} {leg}");
        }
    }
}
