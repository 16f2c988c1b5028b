//! What fixed point promises of the thesis machine, over its whole workspace; that a scene it was
//! accepted for never leaves its range; and that what does not fit is refused by name.

use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use trirrr_core::forward::Forward;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::model::Dynamic;
use trirrr_core::number::Arithmetic;
use trirrr_core::number::Fixed;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
use trirrr_core::units::Units;
use trirrr_scene::{JobPlayer, Scene, units_of_scene, units_of_setpoints};

/// A machine that may have anything: what it has not is zero.
type Any<N> = Tick<Dynamic<N, Offset<N>, Massive<N, InPlane<N>>>>;

const SCENES: [&str; 4] = ["thesis", "thesis-links", "vertical", "chained"];

fn scene(name: &str) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    Scene::read(scenes.join(format!("{name}.toml"))).unwrap()
}

/// Uniform in [0, 1): a linear congruential generator, so that every run has the same poses.
fn uniform() -> impl FnMut() -> f64 {
    let mut state = 1u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Poses all over the workspace of the thesis machine, both distances from singularity at least
/// 5 %, with velocities and accelerations up to the peaks of the thesis's move.
fn workspace(parameters: &Parameters, count: usize) -> Vec<Setpoint<f64>> {
    let geometry = Geometry::<f64>::build(parameters).unwrap();
    let distances = Distances::<f64>::build(parameters);
    let mut next = uniform();
    let mut found = Vec::new();
    while found.len() < count {
        let pose = Pose::from_f64(0.5 * next(), 0.433 * next(), TAU * (next() - 0.5));
        // h = (0.07 m, 0.06 m, pi/60) in 1 s: 1.5 h / T and 6 h / T^2.
        let mut within = |most: f64| most * (2.0 * next() - 1.0);
        let setpoint = Setpoint {
            pose,
            velocity: Vector3::new(within(0.105), within(0.09), within(0.0786)),
            acceleration: Vector3::new(within(0.42), within(0.36), within(0.315)),
        };
        let Ok(at) = geometry.position(&pose) else {
            continue;
        };
        let serial = distances.serial(&at).into_iter().fold(1.0, f64::min);
        if serial >= 0.05 && distances.parallel(&at) >= 0.05 {
            found.push(setpoint);
        }
    }
    found
}

fn in_fixed(setpoint: &Setpoint<f64>, units: &Units) -> Setpoint<Fixed> {
    let own = units.setpoint(setpoint);
    Setpoint {
        pose: Pose::from_f64(own.pose.position.x, own.pose.position.y, own.pose.angle),
        velocity: own.velocity.map(Fixed::from_f64),
        acceleration: own.acceleration.map(Fixed::from_f64),
    }
}

/// The promise is of the setpoint as it is asked for, its rounding to the format included.
///
/// One unit of length is 2^-29 / 4 m = 4.7e-10 m. D, A and c are rounded by half of one each, so
/// that d is off by up to 1.5 and, along either axis, by 2.1 together; the angle follows it with
/// 1 / (0.2 m sin) at a distance of sin = 0.05 from singularity: 2.1 x 4.7e-10 / 0.01 = 9.8e-8 rad
/// if everything comes together, which it does not. A pose is known as well as d is: 1e-9 m, times
/// the condition of three distal lines at 5 % from singularity, 20 at most.
/// The torque follows the setpoint's acceleration and det A. In the units that the thesis's move
/// asks for, some of these motions near singularity are beyond the range, and say so.
#[test]
fn the_thesis_machine_over_its_workspace() {
    let scene = scene("thesis");
    let parameters = scene.parameters;
    let setpoints = workspace(&parameters, 30_000);
    let units = units_of_scene(&scene).unwrap();
    let exact: Tick<Dynamic<f64>> = Tick::build(&parameters).unwrap();
    let fixed: Tick<Dynamic<Fixed>> = Tick::build(&units.parameters(&parameters)).unwrap();
    let geometry = Geometry::build(&parameters).unwrap();
    let forward = Forward::<f64>::build(&parameters, &geometry);
    let (mut angle, mut torque, mut peak, mut tool) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    let mut beyond = 0;
    for setpoint in &setpoints {
        let truth = exact.evaluate(setpoint).unwrap();
        let own = in_fixed(setpoint, &units);
        let position = fixed.geometry().position(&own.pose).unwrap();
        let angles = fixed.geometry().motor_angles(&position);
        let angles = angles.map(Fixed::angle_to_f64);
        for (found, truth) in angles.iter().zip(&truth.motors) {
            let off = found - truth.angle;
            angle = angle.max((off - TAU * (off / TAU).round()).abs());
        }
        let pose = forward.solve(&angles, setpoint.pose, 20).unwrap().pose;
        let off = pose.position - setpoint.pose.position;
        tool = tool.max(off.x.hypot(off.y));
        let found = match fixed.evaluate(&own) {
            Ok(found) => found,
            Err(status) => {
                assert_eq!(status, Status::OutOfRange);
                beyond += 1;
                continue;
            }
        };
        for (found, truth) in found.motors.iter().zip(&truth.motors) {
            let found = found.torque.to_f64() * units.torque_nm();
            torque = torque.max((found - truth.torque).abs());
            peak = peak.max(truth.torque.abs());
        }
    }
    let torque = torque / peak;
    println!(
        "{units:?}: angle {angle:.3e} rad, tool {tool:.3e} m, torque {torque:.3e} of the peak of \
         {peak:.3} N m; {beyond} beyond the range"
    );
    assert!((1e-8..1e-7).contains(&angle), "{angle:e}");
    assert!((1e-9..0.05e-6).contains(&tool), "{tool:e}");
    assert!((1e-8..1e-6).contains(&torque), "{torque:e}");
    assert!((300..4500).contains(&beyond), "{beyond}");
}

/// An accepted scene has no tick that fixed point has not, and its own machine has the same bits
/// as one with room for everything.
#[test]
fn accepted_scenes_stay_in_range() {
    for name in SCENES {
        let scene = scene(name);
        let units = units_of_scene(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let tick = Any::<Fixed>::build(&units.parameters(&scene.parameters)).unwrap();
        let job = scene.job.in_units(&units);
        let player = JobPlayer::<Fixed>::new(&job, units.time(scene.period_s()));
        for (at, setpoint) in player.setpoints().enumerate() {
            let ended = tick.evaluate(&setpoint).map(|_| ());
            assert_eq!(ended, Ok(()), "{name}, tick {at}");
        }
    }
}

/// The same machine, 5 cm and 5 m large and as fast in proportion, in the same bits: powers of two
/// of length and time only move the units.
#[test]
fn small_and_large_machines_use_the_range_equally() {
    let parameters = scene("thesis").parameters;
    let setpoints = workspace(&parameters, 300);
    let units = units_of_setpoints(&parameters, &setpoints).unwrap();
    for (length, time, mass) in [(-3, -2, -6), (4, 3, 7)] {
        // Larger by as much as the units are.
        let scale = Units { length, time, mass };
        let other = scale.parameters(&parameters);
        let scaled: Vec<_> = setpoints.iter().map(|one| scale.setpoint(one)).collect();
        let own = units_of_setpoints(&other, &scaled).unwrap();
        assert_eq!(
            (own.length, own.time, own.mass),
            (units.length - length, units.time - time, units.mass - mass)
        );
        let here: Tick<Dynamic<Fixed>> = Tick::build(&units.parameters(&parameters)).unwrap();
        let there: Tick<Dynamic<Fixed>> = Tick::build(&own.parameters(&other)).unwrap();
        for (one, scaled) in setpoints.iter().zip(&scaled) {
            let a = here.evaluate(&in_fixed(one, &units)).unwrap();
            let b = there.evaluate(&in_fixed(scaled, &own)).unwrap();
            assert_eq!(a.motors, b.motors);
        }
    }
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let refused = |change: fn(&mut Scene)| {
        let mut scene = scene("thesis");
        change(&mut scene);
        units_of_scene(&scene).unwrap_err().to_string()
    };
    // A turn and a half in one move.
    let turn = refused(|scene| scene.job.moves[0].to.angle += 3.0 * PI);
    assert!(
        turn.contains("a move's curve in alpha is 9.4")
            && turn.contains("rad; in fixed point it may be"),
        "{turn}"
    );
    // Far from the origin the legs have too few digits.
    let far = refused(|scene| {
        for leg in &mut scene.parameters.legs {
            leg.base_m.x += 1e5;
        }
        let there = &mut scene.job;
        there.start.position.x += 1e5;
        for each in &mut there.moves {
            each.from.position.x += 1e5;
            each.to.position.x += 1e5;
        }
    });
    assert!(far.contains("the least r1 x r2 of a leg"), "{far}");
    // A platform so small that det A has too few.
    let small = refused(|scene| {
        for leg in &mut scene.parameters.legs {
            leg.joint_radius_m = 1e-7;
        }
    });
    assert!(small.contains("the least det A"), "{small}");
}

/// Beyond the range there is a status, never a wrapped value: the scene's own units, and motions
/// that grow until nothing fits.
#[test]
fn beyond_the_range_there_is_a_status() {
    let scene = scene("vertical");
    let units = units_of_scene(&scene).unwrap();
    let parameters = units.parameters(&scene.parameters);
    let (exact, fixed) = (
        Any::<f64>::build(&parameters).unwrap(),
        Any::<Fixed>::build(&parameters).unwrap(),
    );
    let mut next = uniform();
    let (mut held, mut lost) = (0, 0);
    for _ in 0..100_000 {
        let from = &scene.job.moves[(5.0 * next()) as usize];
        let size = 10f64.powf(6.0 * next() - 3.0);
        let mut any = || size * (2.0 * next() - 1.0);
        let setpoint = Setpoint {
            pose: units.pose(&from.from),
            velocity: Vector3::new(any(), any(), any()),
            acceleration: Vector3::new(any(), any(), any()),
        };
        let found = fixed.evaluate(&in_fixed(&setpoint, &Units::SI));
        let truth = exact.evaluate(&setpoint).unwrap();
        match found {
            Ok(found) => {
                held += 1;
                for (found, truth) in found.motors.iter().zip(&truth.motors) {
                    let pairs = [
                        (found.rate, truth.rate),
                        (found.acceleration, truth.acceleration),
                        (found.torque, truth.torque),
                    ];
                    for (found, truth) in pairs {
                        // Far from singularity nothing is amplified by more than 100.
                        assert!((found.to_f64() - truth).abs() < 2e-7, "{setpoint:?}");
                    }
                }
            }
            Err(status) => {
                lost += 1;
                assert_eq!(status, Status::OutOfRange);
            }
        }
    }
    assert!(held > 20_000 && lost > 20_000, "{held} {lost}");
}
