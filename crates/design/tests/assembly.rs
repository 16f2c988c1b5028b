//! Assembly and working modes, against a scan of the platform's angle and against the textbook's inverse.

use nalgebra::Vector2;
use trirrr_core::forward::{AssemblyError, Completeness};
use trirrr_core::machine::{Elbow, LegParameters, Parameters, example};
use trirrr_core::setpoint::Pose;
use trirrr_design::assembly::{
    AssemblyFault, AssemblyModes, elbows_of, reach_gaps_m, working_modes,
};

/// Steps of the scan over a turn of the platform.
const STEPS: usize = 1_000;

/// The thesis machine with a platform of `radius`, which has more modes the larger the platform is.
fn machine(radius: f64) -> Parameters {
    let mut parameters = example();
    for leg in &mut parameters.legs {
        leg.joint_radius_m = radius;
    }
    parameters
}

fn length(way: Vector2<f64>) -> f64 {
    way.x.hypot(way.y)
}

fn at(angle: f64, length: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin()) * length
}

/// D where the platform's joints 1 and 2 lie on the circles about their elbows, on either side of the line between the centres.
fn on_two_circles(
    parameters: &Parameters,
    angles: [f64; 3],
    alpha: f64,
    side: f64,
) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let centres = [0, 1, 2].map(|index: usize| {
        let leg = &parameters.legs[index];
        leg.base_m + at(angles[index], leg.proximal_m)
            - at(alpha + leg.joint_angle_rad, leg.joint_radius_m)
    });
    let [one, two, three] = centres;
    let (r1, r2) = (parameters.legs[0].distal_m, parameters.legs[1].distal_m);
    let between = two - one;
    let d = length(between);
    let along = (d * d + r1 * r1 - r2 * r2) / (2.0 * d);
    let square = r1 * r1 - along * along;
    let unit = between / d;
    (square >= 0.0).then(|| {
        (
            one + unit * along + Vector2::new(-unit.y, unit.x) * (side * square.sqrt()),
            three,
        )
    })
}

/// The last angle from `inside`, where `error` has a value, towards `outside`, where it has none.
fn edge(error: &dyn Fn(f64) -> Option<f64>, mut inside: f64, mut outside: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        match error(middle) {
            Some(_) => inside = middle,
            None => outside = middle,
        }
    }
    inside
}

/// All poses, by sign changes of the third leg's error over the platform's angle, on both sides.
fn scanned(parameters: &Parameters, angles: [f64; 3]) -> Vec<[f64; 3]> {
    let mut poses = Vec::new();
    for side in [1.0, -1.0] {
        let error = |alpha: f64| {
            let (d, centre) = on_two_circles(parameters, angles, alpha, side)?;
            Some(length(d - centre) - parameters.legs[2].distal_m)
        };
        let grid = |step: usize| {
            -std::f64::consts::PI + std::f64::consts::TAU * (step as f64 + 0.37) / STEPS as f64
        };
        for step in 0..STEPS {
            let (mut low, mut high) = (grid(step), grid(step + 1));
            // Where the circles part within the step, up to there.
            match (error(low), error(high)) {
                (Some(_), None) => high = edge(&error, low, high),
                (None, Some(_)) => low = edge(&error, high, low),
                _ => {}
            }
            let (Some(first), Some(last)) = (error(low), error(high)) else {
                continue;
            };
            if (first > 0.0) == (last > 0.0) {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match error(middle) {
                    Some(value) if (value > 0.0) == (first > 0.0) => low = middle,
                    _ => high = middle,
                }
            }
            let (d, _) = on_two_circles(parameters, angles, low, side).unwrap();
            poses.push([d.x, d.y, low]);
        }
    }
    poses
}

#[test]
fn the_modes_are_those_that_a_scan_of_the_angle_finds() {
    // A multiplicative sequence, the same in every run.
    let mut state = 7u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut by_count = [0; 7];
    for case in 0..90 {
        let parameters = machine([0.02, 0.1, 0.25][case % 3]);
        let angles = [0; 3].map(|_| std::f64::consts::TAU * next());
        let found = AssemblyModes::of(&parameters, angles).unwrap();
        let mut expected = scanned(&parameters, angles);
        by_count[found.modes.len()] += 1;
        assert_eq!(found.completeness, Completeness::Complete);
        assert_eq!(found.modes.len(), expected.len(), "case {case}");
        for mode in &found.modes {
            let [x, y, alpha] = mode.record.pose;
            let index = expected.iter().position(|[u, v, angle]| {
                let turned = (alpha - angle).sin().abs() + (1.0 - (alpha - angle).cos());
                (x - u).hypot(y - v) < 1e-7 && turned < 1e-6
            });
            expected.remove(index.unwrap_or_else(|| panic!("case {case}: {:?}", mode.record.pose)));
            assert!(mode.residual_m < 1e-15, "{:e}", mode.residual_m);
        }
    }
    // Rare ones are among them.
    assert!(
        by_count[0] > 0 && by_count[2] > 0 && by_count[4] > 0,
        "{by_count:?}"
    );
}

#[test]
fn working_modes_are_the_two_solutions_of_each_triangle() {
    let parameters = machine(0.02);
    let pose = Pose::from_f64(0.21, 0.22, 0.2);
    for (elbows, record) in working_modes(&parameters, pose).unwrap() {
        for ((leg, elbow), given) in record.legs.iter().zip(elbows).zip(&parameters.legs) {
            let joint =
                pose.position + at(pose.angle + given.joint_angle_rad, given.joint_radius_m);
            let way = joint - given.base_m;
            let (l1, l2, d) = (given.proximal_m, given.distal_m, length(way));
            // Cosine law at A; to the left of A -> C is a positive angle.
            let gamma = ((l1 * l1 + d * d - l2 * l2) / (2.0 * l1 * d)).acos();
            let expected = way.y.atan2(way.x) + elbow.sign() * gamma;
            let off = expected - leg.th1;
            assert!(off.sin().abs() < 1e-14 && off.cos() > 0.0, "{off:e}");
        }
        assert_eq!(elbows_of(&record), elbows.map(Some));
        // det A is the moment of the line of link 3 about the crossing of the lines of links 1 and 2, times their cross product.
        let [one, two, three] = record
            .legs
            .map(|leg| (Vector2::from(leg.elbow()), Vector2::from(leg.r2)));
        let cross = one.1.perp(&two.1);
        let crossing = one.0 + one.1 * ((two.0 - one.0).perp(&two.1) / cross);
        let expected = cross * (three.0 - crossing).perp(&three.1);
        assert!(
            (record.det_a - expected).abs() < 1e-15,
            "{} {expected}",
            record.det_a
        );
    }
}

#[test]
fn legs_that_do_not_reach_say_by_how_much() {
    let mut parameters = machine(0.02);
    parameters.legs[0].distal_m = 0.05;
    // Joint 1 lies 0.01 m from its base, 0.14 m too near; joint 2 lies 0.6 m above its base, 0.2 m too far.
    let d = Vector2::new(0.01, 0.433) - at(parameters.legs[0].joint_angle_rad, 0.02);
    parameters.legs[1].base_m =
        d + at(parameters.legs[1].joint_angle_rad, 0.02) - Vector2::new(0.0, 0.6);
    let pose = Pose::from_f64(d.x, d.y, 0.0);
    let [near, far, _] = reach_gaps_m(&parameters, pose);
    assert!(
        (near + 0.14).abs() < 1e-15 && (far - 0.2).abs() < 1e-15,
        "{near} {far}"
    );
    assert!(working_modes(&parameters, pose).is_err());
    assert_eq!(
        reach_gaps_m(&machine(0.02), Pose::from_f64(0.21, 0.22, 0.2)),
        [0.0; 3]
    );
}

#[test]
fn a_parallelogram_is_loose() {
    let leg = |degrees: f64| LegParameters {
        base_m: at(degrees.to_radians(), 0.1),
        joint_radius_m: 0.1,
        joint_angle_rad: degrees.to_radians(),
        elbow: Elbow::Positive,
        ..example().legs[0]
    };
    let parameters = Parameters {
        legs: [leg(90.0), leg(210.0), leg(330.0)],
        ..example()
    };
    assert_eq!(
        AssemblyModes::of(&parameters, [0.7; 3]),
        Err(AssemblyFault::Modes(AssemblyError::Loose))
    );
}
