use super::*;
use crate::forward::random::{any, deterministic, share};
use crate::machine::{Geometry, example};
use crate::setpoint::RestToRest;
use core::cell::Cell;
use proptest::array::uniform3;

/// The thesis machine.
fn machine<N: Number>() -> (Geometry<N>, Forward<N>) {
    let parameters = example();
    let geometry = Geometry::build(&parameters).unwrap();
    let forward = Forward::build(&parameters, &geometry);
    (geometry, forward)
}

fn follows_the_move<N: Number>(tolerance: f64) -> u32 {
    let (geometry, forward) = machine::<N>();
    let tracker = Tracker::new(forward, N::from_f64(0.01), 16);
    let from = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
    let to = Pose::from_f64(0.28, 0.28, 12f64.to_radians());
    let job = RestToRest::new(from, to, 100, N::factor_from_f64(0.01));
    let angles = |tick| {
        let pose = job.at(tick).pose;
        geometry.motor_angles(&geometry.position(&pose).unwrap())
    };
    let mut track = tracker.start(&angles(0), from).unwrap();
    let mut most = 0;
    for tick in 1..=100 {
        track = tracker.follow(&track, &angles(tick)).unwrap();
        most = most.max(track.parts);
        let pose = job.at(tick).pose;
        let off = (track.pose.position - pose.position).map(N::to_f64);
        let turn = N::angle_to_f64(track.pose.angle - pose.angle);
        assert!(off.x.hypot(off.y).max(turn.abs()) < tolerance, "{track:?}");
        assert_eq!(track.angles, angles(tick));
    }
    most
}

#[test]
fn follows_a_move() {
    // A hundredth of a second at a time is never too much.
    assert_eq!(follows_the_move::<f64>(1e-13), 1);
    assert_eq!(follows_the_move::<f32>(2e-5), 1);
}

/// The motion in thousands of parts, each followed by Newton-Raphson: the mode that is right as
/// long as det A keeps its sign and the steps are far smaller than the modes are apart.
fn by_small_steps(
    forward: &Forward<f64>,
    from: &Track<f64>,
    angles: &[f64; 3],
    parts: u32,
) -> Option<Pose<f64>> {
    let mut pose = from.pose;
    for part in 1..=parts {
        let s = f64::from(part) / f64::from(parts);
        let turned = |leg: usize| from.angles[leg] + s * (angles[leg] - from.angles[leg]);
        let angles = [turned(0), turned(1), turned(2)];
        let next = forward.solve(&angles, pose, 20).ok()?.pose;
        let (det_a, distance) = forward.det_a(&next, &forward.elbows(&angles));
        let step = forward.joint_distance(&pose, &next);
        if (det_a > 0.0) != (from.det_a > 0.0) || distance < 1e-3 || step > 0.02 {
            return None;
        }
        pose = next;
    }
    Some(pose)
}

#[test]
fn never_ends_in_another_mode() {
    let (sure, unsure, jumps) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let motion = uniform3(-0.5..0.5f64);
    // Each is followed in 2000 steps besides.
    let cases = share(4000);
    deterministic(cases, (any(), motion), |(case, motion)| {
        let forward = case.forward();
        let tracker = Tracker::new(forward, 0.01, 200);
        let Ok(track) = tracker.start(&case.angles, case.pose()) else {
            return;
        };
        let mut angles = case.angles;
        for (angle, by) in angles.iter_mut().zip(motion) {
            *angle += by;
        }
        match tracker.follow(&track, &angles) {
            Ok(found) => {
                sure.set(sure.get() + 1);
                let right = by_small_steps(&forward, &track, &angles, 2000);
                let right = right.expect("a way that is sure exists");
                let off = forward.joint_distance(&found.pose, &right);
                assert!(off * found.distance < 1e-12, "{off:e}: {case:?}");
                assert!(found.det_a * track.det_a > 0.0);
                // What a single Newton-Raphson from the last pose would have made of it.
                let naive = forward.solve(&angles, track.pose, 20);
                let naive =
                    naive.is_ok_and(|naive| forward.joint_distance(&naive.pose, &right) < 1e-6);
                jumps.set(jumps.get() + u32::from(!naive));
            }
            Err(_) => unsure.set(unsure.get() + 1),
        }
    });
    // Half the motions of up to half a radian are followed, some only because they are divided.
    let counts = [&sure, &unsure, &jumps].map(Cell::get);
    assert!(
        counts[0] > cases / 2 && counts[1] > cases / 40 && counts[2] > cases / 40,
        "{counts:?}"
    );
}

#[test]
fn stops_at_a_parallel_singularity() {
    // The platform turns through the singular angle of the pose (0.245, 0.25); at first forwards,
    // then by one step across.
    let (geometry, forward) = machine::<f64>();
    let tracker = Tracker::new(forward, 0.01, 16);
    let at = |alpha: f64| {
        let pose = Pose::from_f64(0.245, 0.25, alpha);
        let position = geometry.position(&pose).unwrap();
        (pose, geometry.motor_angles(&position))
    };
    let singular = -0.753_418_931_929_448_5;
    let (pose, angles) = at(singular + 0.2);
    let mut track = tracker.start(&angles, pose).unwrap();
    let end = loop {
        let alpha = track.pose.angle - 0.002;
        assert!(alpha > singular, "went through");
        match tracker.follow(&track, &at(alpha).1) {
            Ok(next) => track = next,
            Err(error) => break error,
        }
    };
    let stopped = matches!(end, TrackingError::NearSingular { distance } if distance <= 0.01);
    assert!(stopped || end == TrackingError::StepTooLarge, "{end}");
    assert!(track.pose.angle - singular < 0.05, "{track:?}");

    // In one step across, the motors stand where they also would with the platform on this side:
    // that is the pose tracked, not the one beyond.
    let (pose, angles) = at(singular + 0.1);
    let track = tracker.start(&angles, pose).unwrap();
    let beyond = at(singular - 0.1);
    let across = tracker.follow(&track, &beyond.1).unwrap();
    assert!(across.det_a * track.det_a > 0.0, "{across:?}");
    assert!(forward.joint_distance(&across.pose, &beyond.0) > 1e-3);
    assert!(across.residual < 1e-14);

    let (pose, angles) = at(singular + 1e-6);
    assert!(matches!(
        tracker.start(&angles, pose),
        Err(TrackingError::NearSingular { .. })
    ));
}

#[test]
fn keeps_the_turns_and_refuses_what_is_no_angle() {
    let (geometry, forward) = machine::<f64>();
    let tracker = Tracker::new(forward, 0.01, 16);
    let turns = 5.0 * core::f64::consts::TAU;
    let pose = Pose::from_f64(0.245, 0.25, 0.1 + turns);
    let angles = geometry.motor_angles(&geometry.position(&pose).unwrap());
    let track = tracker.start(&angles, pose).unwrap();
    assert!((track.pose.angle - pose.angle).abs() < 1e-12);
    // A motor that reports its angle a turn on has not moved.
    let again = [angles[0] + core::f64::consts::TAU, angles[1], angles[2]];
    let again = tracker.follow(&track, &again).unwrap();
    assert!((again.pose.angle - pose.angle).abs() < 1e-12);

    for bad in [f64::NAN, f64::INFINITY] {
        let result = tracker.follow(&track, &[bad, angles[1], angles[2]]);
        assert_eq!(result, Err(TrackingError::StepTooLarge));
    }
    // Half a turn of a motor is more than any proof covers.
    let far = [angles[0] + 3.0, angles[1], angles[2]];
    assert!(tracker.follow(&track, &far).is_err());
}
