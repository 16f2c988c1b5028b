use super::*;
use crate::forward::exact;
use crate::forward::random::{
    Closed, any, closed, deterministic, nearly_double, scan, share, turned,
};
use crate::machine::{Geometry, Parameters, example};
use crate::number::{Arithmetic, Number};
use crate::singularity;
use nalgebra::Vector2;
use std::cell::Cell;
use std::vec::Vec;

/// Largest length error of the distal links at `pose`, from the joints' places, in roundings of
/// those places.
fn roundings<N: Number>(case: &Closed, pose: &Pose<N>) -> f64 {
    let place = pose.position.map(N::to_f64);
    let alpha = N::angle_to_f64(pose.angle);
    let error = |(leg, &theta): (&crate::machine::LegParameters, &f64)| {
        let joint = place + turned(leg.joint_radius_m, leg.joint_angle_rad + alpha);
        let r2 = joint - leg.base_m - turned(leg.proximal_m, theta);
        (r2.x.hypot(r2.y) - leg.distal_m).abs()
    };
    let legs = case.parameters.legs.iter().zip(&case.angles);
    let rounding = N::UNIT_ROUNDOFF.to_f64() * case.reach();
    legs.map(error).fold(0.0, f64::max) / rounding
}

fn thesis() -> (Parameters, Geometry<f64>, Forward<f64>) {
    let parameters = example();
    let geometry = Geometry::build(&parameters).unwrap();
    let forward = Forward::build(&parameters, &geometry);
    (parameters, geometry, forward)
}

fn thesis_angles(alpha: f64) -> [f64; 3] {
    let (_, geometry, _) = thesis();
    let at = geometry.position(&Pose::from_f64(0.245, 0.25, alpha));
    geometry.motor_angles(&at.unwrap())
}

#[test]
fn holds_the_pose_and_every_mode_closes() {
    let counts: [Cell<u32>; 7] = Default::default();
    let worst: [Cell<f64>; 3] = Default::default();
    let cases = share(20_000);
    deterministic(cases, any(), |case| {
        let forward = case.forward();
        let found = forward.assemblies(&case.angles).unwrap();
        assert_eq!(found.completeness, Completeness::Complete, "{found:?}");
        let count = &counts[found.modes().len()];
        count.set(count.get() + 1);

        let pose = case.pose();
        let near = forward.nearest(&found, &pose).unwrap();
        // The pose is rounded as the angles are, and looser the nearer it is to a singularity.
        let off = forward.joint_distance(&near.pose, &pose);
        let rounding = f64::UNIT_ROUNDOFF * case.reach();
        worst[1].set(worst[1].get().max(off * near.distance / rounding));

        for mode in found.modes() {
            worst[0].set(worst[0].get().max(roundings(&case, &mode.pose)));
            // Newton-Raphson from beside it, within its basin, comes back.
            let beside = 1e-3 * mode.distance * mode.distance;
            let guess = Pose::from_f64(
                mode.pose.position.x + beside,
                mode.pose.position.y - beside,
                mode.pose.angle + beside,
            );
            let again = forward.solve(&case.angles, guess, 20).unwrap();
            let off = forward.joint_distance(&again.pose, &mode.pose);
            worst[2].set(worst[2].get().max(off * mode.distance / rounding));
        }
    });
    // Of the joints' places: how well the legs close; how far the pose is found again, and how far
    // Newton-Raphson ends from the mode, each times the distance to the singularity.
    let worst = worst.map(Cell::into_inner);
    assert!(
        worst[0] < 8.0 && worst[1] < 32.0 && worst[2] < 32.0,
        "{worst:?}"
    );
    let counts = counts.map(Cell::into_inner);
    let odd = counts[1] + counts[3] + counts[5];
    assert_eq!(odd, 0, "{counts:?}");
    assert!(counts[0] == 0 && counts[2..].iter().sum::<u32>() == cases);
    assert!(
        counts[4] > cases / 5 && counts[6] > cases / 100,
        "{counts:?}"
    );
}

#[test]
fn finds_as_many_modes_as_a_scan() {
    deterministic(share(400), any(), |case| {
        let found = case.forward().assemblies(&case.angles).unwrap();
        let modes = found.modes().len();
        // A coarse scan steps over two modes that are close; a finer one does not.
        let agrees = [10_000, 160_000, 2_560_000]
            .iter()
            .any(|&cells| scan(&case, cells) == modes);
        assert!(agrees, "{modes} modes: {case:?}");
    });
}

#[test]
fn most_random_angles_that_fit_no_pose_give_none() {
    // The proximal links turned anywhere: the scan is the judge again.
    let (empty, cases) = (Cell::new(0), share(400));
    deterministic(cases, any(), |mut case| {
        case.angles = case.angles.map(|theta| 1.7 * theta + 1.0);
        let found = case.forward().assemblies(&case.angles).unwrap();
        let modes = found.modes().len();
        assert!(
            [10_000, 160_000, 2_560_000]
                .iter()
                .any(|&cells| scan(&case, cells) == modes)
        );
        empty.set(empty.get() + u32::from(modes == 0));
    });
    assert!(
        (cases / 8..cases * 7 / 8).contains(&empty.get()),
        "{empty:?}"
    );
}

/// A machine with six modes, by search over machines of one decimal.
#[test]
fn six_modes() {
    let case = six();
    let found = case.forward().assemblies(&case.angles).unwrap();
    assert_eq!(found.modes().len(), 6, "{found:?}");
    assert_eq!(found.completeness, Completeness::Complete);
    assert_eq!(scan(&case, 10_000), 6);
    // Modes that meet have different signs of det A; over all of them as many of either.
    let positive = found.modes().iter().filter(|mode| mode.det_a > 0.0).count();
    assert_eq!(positive, 3);
    for pair in found.modes().windows(2) {
        assert!(pair[0].pose.angle < pair[1].pose.angle);
        assert!(case.forward().joint_distance(&pair[0].pose, &pair[1].pose) > 0.1);
    }
    for mode in found.modes() {
        assert!(mode.residual < 1e-14 && mode.distance > 0.4 && !mode.double);
        assert!(roundings(&case, &mode.pose) < 4.0);
    }
}

fn six() -> Closed {
    closed(
        [0.0, 0.0, 0.0],
        [
            [0.2, 0.5, 0.3, 3.0, 1.6, 0.9],
            [0.4, 0.5, 0.7, -1.9, 0.7, 0.8],
            [0.2, 0.4, 0.4, -0.5, -1.8, -0.2],
        ],
    )
}

#[test]
fn signs_of_det_a_are_those_of_the_singularity_distance() {
    let (parameters, geometry, forward) = thesis();
    let distances = singularity::Distances::<f64>::build(&parameters);
    for alpha in [-0.9, -0.5, 0.2, 1.0] {
        let pose = Pose::from_f64(0.245, 0.25, alpha);
        let position = geometry.position(&pose).unwrap();
        let angles = geometry.motor_angles(&position);
        let found = forward.assemblies(&angles).unwrap();
        let here = forward.nearest(&found, &pose).unwrap();
        let (det_a, distance) = (singularity::det_a(&position), distances.parallel(&position));
        assert!((here.det_a - det_a).abs() < 1e-15, "{here:?}, {det_a:e}");
        assert!((here.distance - distance).abs() < 1e-12);
    }
}

#[test]
fn two_modes_merge_at_a_parallel_singularity() {
    let forward = thesis().2;
    // det A of the pose (0.245, 0.25, alpha) vanishes here.
    let singular = -0.753_418_931_929_448_5;
    let angles = thesis_angles(singular);
    let pose = Pose::from_f64(0.245, 0.25, singular);
    let at = forward.assemblies(&angles).unwrap();
    let near = forward.nearest(&at, &pose).unwrap();
    assert!(forward.joint_distance(&near.pose, &pose) < 1e-8, "{near:?}");
    assert!(near.distance < 1e-6 && near.residual < 1e-14, "{near:?}");
    assert_eq!(at.completeness, Completeness::Double, "{at:?}");
    assert!(near.double);

    // One motor aside: two modes on one side of the singularity, none on the other, and the
    // nearer it is the closer they are.
    let beside = |step: f64| {
        let angles = [angles[0] + step, angles[1], angles[2]];
        let found = forward.assemblies(&angles).unwrap();
        assert_eq!(found.completeness, Completeness::Complete, "{found:?}");
        let near = |mode: &&Assembly<f64>| forward.joint_distance(&mode.pose, &pose) < 0.1;
        let near: Vec<_> = found.modes().iter().filter(near).copied().collect();
        near
    };
    for step in [1e-3, 1e-6, 1e-9, 1e-11] {
        let (one, other) = (beside(step), beside(-step));
        let (two, none) = if one.is_empty() {
            (other, one)
        } else {
            (one, other)
        };
        assert_eq!((two.len(), none.len()), (2, 0), "{step:e}");
        assert!(two[0].det_a * two[1].det_a < 0.0);
        let moved = forward.joint_distance(&two[0].pose, &two[1].pose);
        assert!(
            (0.05..5.0).contains(&(moved / step.sqrt())),
            "{moved:e} at {step:e}"
        );
    }
}

#[test]
fn two_modes_with_one_angle_are_both_found() {
    // The points B_i - R h_i on a line: D and its mirror image fit, with one alpha.
    let (alpha, d) = (0.4, Vector2::new(0.3, 0.5));
    for tilt in [0.0, 1e-12, 1e-9, 1e-6] {
        let leg = |along: f64, h: f64, lambda: f64| {
            let to_d = d - Vector2::new(along, tilt * along * along);
            let theta2 = to_d.y.atan2(to_d.x);
            [0.4, to_d.x.hypot(to_d.y), h, lambda, 0.3 + along, theta2]
        };
        let legs = [
            leg(-0.4, 0.2, 0.1),
            leg(0.1, 0.25, 2.0),
            leg(0.7, 0.15, -2.2),
        ];
        let case = closed([d.x, d.y, alpha], legs);
        let forward = case.forward();
        let found = forward.assemblies(&case.angles).unwrap();
        assert_eq!(found.completeness, Completeness::Complete, "{found:?}");
        for y in [0.5, -0.5] {
            let pose = Pose::from_f64(0.3, y, alpha);
            let near = forward.nearest(&found, &pose).unwrap();
            let off = forward.joint_distance(&near.pose, &pose);
            assert!(off < 1e-14 + 4.0 * tilt, "{off:e}, {tilt:e}: {found:?}");
        }
        assert_eq!(found.modes().len() % 2, 0, "{found:?}");
    }
}

#[test]
fn loose_platforms_are_said_to_be() {
    let (example, geometry, _) = thesis();
    let pose = Pose::from_f64(0.25, 0.25, 0.3);
    let assemblies = |parameters: &Parameters, angles: &[f64; 3]| {
        let geometry = Geometry::<f64>::build(parameters).unwrap();
        Forward::build(parameters, &geometry).assemblies(angles)
    };

    // All platform joints in one point: it turns freely where the legs meet, else nothing fits.
    let mut point = example;
    for leg in &mut point.legs {
        leg.joint_radius_m = 0.0;
    }
    let at = Geometry::<f64>::build(&point).unwrap().position(&pose);
    let angles = geometry.motor_angles(&at.unwrap());
    assert_eq!(assemblies(&point, &angles), Err(AssemblyError::Loose));
    let none = assemblies(&point, &[angles[0] + 0.1, angles[1], angles[2]]).unwrap();
    assert_eq!(none.modes(), []);

    // Three parallel and equal distal links: the platform moves along a circle.
    let shape = [(0.2, 0.0), (0.25, 2.0), (0.15, -2.0)];
    let legs = shape.map(|(h, lambda)| [0.3, 0.4, h, lambda, 0.5, 1.1]);
    let parallel = closed([0.1, 0.2, 0.3], legs);
    assert_eq!(
        parallel.forward().assemblies(&parallel.angles),
        Err(AssemblyError::Loose)
    );

    // A leg that is there twice.
    let legs = [0, 0, 1].map(|shape_of| {
        let (h, lambda) = shape[shape_of];
        [0.3, 0.4, h, lambda, 0.5, 1.1 + shape_of as f64]
    });
    let twice = closed([0.1, 0.2, 0.3], legs);
    assert_eq!(
        twice.forward().assemblies(&twice.angles),
        Err(AssemblyError::Loose)
    );
}

#[test]
fn degenerate_platforms_are_solved() {
    for shape in [
        // On a line; two joints in one point; one of them at D.
        [(0.2, 0.3), (0.1, 0.3), (0.15, 0.3 + core::f64::consts::PI)],
        [(0.2, 0.3), (0.2, 0.3), (0.15, -2.0)],
        [(0.0, 0.0), (0.2, 0.0), (0.15, -2.0)],
    ] {
        let mut theta2 = 0.0;
        let legs = shape.map(|(h, lambda)| {
            theta2 += 1.7;
            [0.3, 0.4, h, lambda, theta2 - 0.5, theta2]
        });
        let case = closed([0.1, 0.2, 0.3], legs);
        let forward = case.forward();
        let found = forward.assemblies(&case.angles).unwrap();
        assert_eq!(found.completeness, Completeness::Complete, "{found:?}");
        assert_eq!(found.modes().len(), scan(&case, 10_000));
        let near = forward.nearest(&found, &case.pose()).unwrap();
        assert!(forward.joint_distance(&near.pose, &case.pose()) < 1e-13);
    }
}

#[test]
fn refuses_what_is_no_angle() {
    let forward = thesis().2;
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(
            forward.assemblies(&[0.1, bad, 0.2]),
            Err(AssemblyError::OutOfRange)
        );
    }
}

#[test]
fn nearest_keeps_the_turns_of_the_reference() {
    let (_, _, forward) = thesis();
    let found = forward.assemblies(&thesis_angles(0.2)).unwrap();
    let turns = 3.0 * core::f64::consts::TAU;
    let reference = Pose::from_f64(0.24, 0.25, 0.21 + turns);
    let nearest = forward.nearest(&found, &reference).unwrap();
    assert!((nearest.pose.angle - turns - 0.2).abs() < 1e-13);
}

#[test]
fn finds_them_in_f32() {
    let undecided = Cell::new(0);
    deterministic(share(5000), any(), |case| {
        let geometry = Geometry::<f32>::build(&case.parameters).unwrap();
        let forward = Forward::build(&case.parameters, &geometry);
        let angles = case.angles.map(|theta| theta as f32);
        let found = forward.assemblies(&angles).unwrap();
        if found.completeness != Completeness::Complete {
            undecided.set(undecided.get() + 1);
            return;
        }
        let exact = case.forward().assemblies(&case.angles).unwrap();
        for mode in found.modes() {
            assert!(roundings(&case, &mode.pose) < 16.0, "{mode:?}: {case:?}");
            assert!(mode.pose.angle.is_finite() && mode.distance.is_finite());
        }
        // Roots that f32 moves by its rounding may vanish or appear only next to a double root.
        let clear = exact.modes().iter().all(|mode| mode.distance > 0.01);
        if clear {
            assert_eq!(found.modes().len(), exact.modes().len(), "{case:?}");
        }
    });
    assert!(undecided.get() < 10, "{undecided:?}");
}

/// The modes in `N`, and the share of `cases` whose list is complete. A complete list has as many modes
/// as the exact machine.
fn share_complete<N: Number>(
    cases: u32,
    strategy: impl proptest::strategy::Strategy<Value = Closed>,
) -> f64 {
    let (complete, wrong) = (Cell::new(0), Cell::new(0));
    deterministic(cases, strategy, |case| {
        let geometry = Geometry::<N>::build(&case.parameters).unwrap();
        let forward = Forward::build(&case.parameters, &geometry);
        let found = forward
            .assemblies(&case.angles.map(N::angle_from_f64))
            .unwrap();
        if found.completeness == Completeness::Complete {
            complete.set(complete.get() + 1);
            wrong.set(wrong.get() + usize::from(found.modes().len() != exact::modes(&case)));
        }
    });
    assert_eq!(wrong.get(), 0, "wrong counts of {cases}");
    f64::from(complete.get()) / f64::from(cases)
}

/// Machines whose pose is nearly a parallel singularity, and any.
#[test]
fn complete_lists_next_to_double_roots_are_complete() {
    assert_decided(shares_complete(share(2500)));
}

/// Few lists are left open: else a list would seldom say how many modes there are.
fn assert_decided(shares: [f64; 4]) {
    let least = [0.99, 0.999, 0.99, 0.999];
    let decided = shares
        .iter()
        .zip(least)
        .all(|(&share, least)| share > least);
    assert!(decided, "{shares:?}");
}

#[test]
#[ignore = "a minute unless optimised; cargo xtask nightly runs it"]
fn complete_lists_next_to_many_double_roots_are_complete() {
    let shares = shares_complete(20_000);
    std::println!("{shares:?}");
    assert_decided(shares);
}

/// In `f32` next to double roots and anywhere, in `f64` next to them and anywhere.
fn shares_complete(cases: u32) -> [f64; 4] {
    use proptest::strategy::Strategy;
    let ordinary = || any().prop_map(Closed::in_f32);
    [
        share_complete::<f32>(cases, nearly_double()),
        share_complete::<f32>(cases, ordinary()),
        share_complete::<f64>(cases / 2, nearly_double()),
        share_complete::<f64>(cases / 2, ordinary()),
    ]
}
