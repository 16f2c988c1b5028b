//! Forward kinematics undoes inverse kinematics.

use std::cell::RefCell;
use trirrr_core::forward::{Forward, Found};
use trirrr_core::machine::Geometry;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_tests::bound::Worst;
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::evaluate::distances;
use trirrr_tests::inputs::Inputs;
use trirrr_tests::random::{Case, case, for_all};
use trirrr_tests::results;
use trirrr_tests::scalar::{Scalar, cross, solve};

use super::truth::rounded;

/// From the motor angles of the pose, and a guess that is off by a thousandth of the machine's
/// size times its distances to singularities: within the basin of the pose.
fn found<N: Number>(case: &Case) -> (Pose<N>, Found<N>) {
    let geometry = Geometry::<N>::build(&case.parameters).expect("a machine");
    let pose = rounded::<N>(&case.setpoint).pose;
    let position = geometry.position(&pose).expect("a pose");
    let angles = geometry.motor_angles(&position);
    let (_, parallel) = distances(&case.parameters, &case.setpoint.pose);
    let off = 1e-2 * parallel * parallel;
    let guess = Pose::from_f64(
        case.setpoint.pose.position.x + off * case.size,
        case.setpoint.pose.position.y - off * case.size,
        case.setpoint.pose.angle + off,
    );
    let forward = Forward::build(&case.parameters, &geometry);
    let found = forward
        .solve(&angles, guess, 20)
        .unwrap_or_else(|error| panic!("{error}: {case:?}"));
    (pose, found)
}

/// How far a change of every motor angle by its own 2 u cond, and of every gap between elbow and
/// platform joint by a few roundings of the vectors it is formed from, moves the pose: with
/// g_i = 0 the distance condition of leg i, dX = A^-1 (D_i dtheta_i + dg_i).
fn bound<N: Number>(case: &Case) -> [f64; 3] {
    let kinematics = Inputs::exact(&case.parameters, &case.setpoint).kinematics();
    let conditions = results::isotropic_conditions(&case.parameters, &case.setpoint);
    let u = N::UNIT_ROUNDOFF.to_f64();
    let mut moved = [0.0; 3];
    for leg in 0..3 {
        let mut right = vec![DoubleDouble::constant(0.0); 3];
        right[leg] = DoubleDouble::constant(1.0);
        let rows = kinematics.legs.iter().map(|leg| {
            let position = case.setpoint.pose.position;
            let c = [0, 1].map(|axis| leg.joints[1][axis] - DoubleDouble::constant(position[axis]));
            let r2 = leg.links[1];
            vec![r2[0], r2[1], cross(c, r2)]
        });
        let column = solve(rows.collect(), right);
        let index = results::names()
            .iter()
            .position(|name| name.stem == "th1" && name.leg == Some(leg));
        let of_angle = 2.0 * u * conditions[index.expect("an angle")];
        let parameters = &case.parameters.legs[leg];
        let place = parameters.base_m.x.hypot(parameters.base_m.y)
            + parameters.proximal_m
            + parameters.distal_m
            + parameters.joint_radius_m;
        let gap = kinematics.legs[leg].cross.value().abs() * of_angle
            + 4.0 * u * place * parameters.distal_m;
        for (moved, entry) in moved.iter_mut().zip(column) {
            *moved += entry.value().abs() * gap;
        }
    }
    // The pose itself is a rounded number.
    let pose = &case.setpoint.pose;
    [
        moved[0] + u * pose.position.x.abs(),
        moved[1] + u * pose.position.y.abs(),
        moved[2] + u * pose.angle.abs(),
    ]
}

fn worst<N: Number>(most_iterations: u32) -> Worst {
    let worst = RefCell::new(Worst::default());
    let iterations = RefCell::new(0);
    for_all(3000, case(), |case| {
        let (pose, found) = found::<N>(&case);
        let errors = [
            found.pose.position.x.to_f64() - pose.position.x.to_f64(),
            found.pose.position.y.to_f64() - pose.position.y.to_f64(),
            N::angle_to_f64(found.pose.angle) - N::angle_to_f64(pose.angle),
        ];
        for ((axis, error), bound) in errors.into_iter().enumerate().zip(bound::<N>(&case)) {
            worst.borrow_mut().compare(
                || format!("axis {axis}: {found:?} of {case:?}"),
                error,
                bound,
            );
        }
        let most = iterations.replace(0).max(found.iterations);
        iterations.replace(most);
    });
    let most = iterations.into_inner();
    assert!(
        (3..=most_iterations).contains(&most),
        "at most {most} iterations"
    );
    worst.into_inner()
}

#[test]
fn forward_of_inverse_is_the_pose_in_f64() {
    worst::<f64>(12).assert_within("forward, f64", 0.1..=1.0);
}

#[test]
fn forward_of_inverse_is_the_pose_in_f32() {
    worst::<f32>(10).assert_within("forward, f32", 0.1..=1.0);
}
