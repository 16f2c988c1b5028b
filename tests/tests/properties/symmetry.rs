//! What a change of the point of view, of units or of direction does to the results: to the bit
//! where the change is exact, within the sum of two bounds where it is rounded.

use core::f64::consts::PI;
use nalgebra::{Vector2, Vector3};
use std::cell::RefCell;
use trirrr_core::machine::{Elbow, Parameters};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::tick::Motion;
use trirrr_tests::bound::{Worst, angle_difference};
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::random::{Case, case, for_all};
use trirrr_tests::results;

fn motion(parameters: &Parameters, setpoint: &Setpoint<f64>) -> Motion<f64> {
    evaluate(parameters, setpoint).expect("a motion")
}

/// The case with every vector of the fixed frame mapped by `linear` (positions also moved by
/// `offset`), and the platform turned by `turn`.
fn moved(
    case: &Case,
    linear: impl Fn(Vector2<f64>) -> Vector2<f64>,
    offset: Vector2<f64>,
    turn: f64,
) -> Case {
    let mut parameters = case.parameters;
    for leg in &mut parameters.legs {
        leg.base_m = linear(leg.base_m) + offset;
    }
    parameters.gravity_m_s2 = linear(parameters.gravity_m_s2);
    parameters.wrench_force_n = linear(parameters.wrench_force_n);
    let spatial = |v: Vector3<f64>| {
        let plane = linear(v.xy());
        Vector3::new(plane.x, plane.y, v.z)
    };
    let Setpoint {
        pose,
        velocity,
        acceleration,
    } = case.setpoint;
    let position = linear(pose.position) + offset;
    Case {
        parameters,
        setpoint: Setpoint {
            pose: Pose::from_f64(position.x, position.y, pose.angle + turn),
            velocity: spatial(velocity),
            acceleration: spatial(acceleration),
        },
        ..*case
    }
}

/// A turned machine turns its links along and keeps everything else. The rotation rounds every
/// component at the size of its vector, so the bound is that of both machines and of the inputs:
/// (2 + 2 + 2) u cond; a torque in which larger parts cancel misses 2 u cond, as against the truth.
#[test]
fn rotation_of_the_whole_machine() {
    let worst = RefCell::new(Worst::default());
    for_all(1500, (case(), -PI..PI), |(case, turn)| {
        let (sin, cos) = turn.sin_cos();
        let linear = |v: Vector2<f64>| Vector2::new(cos * v.x - sin * v.y, cos * v.y + sin * v.x);
        let turned = moved(&case, linear, Vector2::new(0.0, 0.0), turn);
        let before = motion(&case.parameters, &case.setpoint);
        let after = motion(&turned.parameters, &turned.setpoint);
        let lists = [(&case, &before), (&turned, &after)].map(|(case, motion)| {
            results::of_core(&case.parameters, &case.setpoint, motion).expect("finite results")
        });
        let conditions = results::isotropic_conditions(&case.parameters, &case.setpoint);
        for (index, (name, cond)) in results::names().into_iter().zip(conditions).enumerate() {
            let (a, b) = (lists[0][index], lists[1][index]);
            let difference = match name.stem {
                stem if stem.starts_with(['x', 'y', 'F']) => continue,
                _ if name.is_angle() => angle_difference(b, a + turn),
                _ => b - a,
            };
            // The turn itself is a rounded input to angles; both lie within pi of zero.
            let of_turn = if name.is_angle() {
                4.0 * PI * f64::UNIT_ROUNDOFF
            } else {
                0.0
            };
            let bound = 6.0 * f64::UNIT_ROUNDOFF * cond + of_turn;
            worst.borrow_mut().compare(
                || format!("{} turned by {turn} of {case:?}", name.column()),
                difference,
                bound,
            );
        }
    });
    worst.into_inner().assert_within("rotation", 0.1..=2.0);
}

/// Positions on a grid of 2^-20 of the size: a move along the grid is exact, and so is everything
/// that follows.
#[test]
fn translation_to_the_bit() {
    let steps = || -4_000_000i32..4_000_000;
    for_all(3000, (case(), steps(), steps()), |(case, x, y)| {
        let grid = 2f64.powf(case.size.log2().floor() - 20.0);
        let on_grid = |v: Vector2<f64>| v.map(|component| (component / grid).round() * grid);
        let here = moved(&case, on_grid, Vector2::new(0.0, 0.0), 0.0);
        let offset = Vector2::new(f64::from(x), f64::from(y)) * grid;
        let there = moved(&here, |v| v, offset, 0.0);
        // On the grid the state is another one, by a millionth: still away from singularities.
        assert_eq!(
            motion(&here.parameters, &here.setpoint),
            motion(&there.parameters, &there.setpoint)
        );
    });
}

/// The mirror image in the x axis: elbows change sides, angles, moments and torques change sign.
/// Every operation is odd or even in sign, so nothing but signs may change.
#[test]
fn mirror_image_to_the_bit() {
    for_all(3000, case(), |case| {
        let mut image = moved(
            &case,
            |v| Vector2::new(v.x, -v.y),
            Vector2::new(0.0, 0.0),
            0.0,
        );
        image.setpoint.pose.angle = -case.setpoint.pose.angle;
        image.setpoint.velocity.z = -case.setpoint.velocity.z;
        image.setpoint.acceleration.z = -case.setpoint.acceleration.z;
        image.parameters.wrench_torque_nm = -case.parameters.wrench_torque_nm;
        image.parameters.platform.com_m.y = -case.parameters.platform.com_m.y;
        for leg in &mut image.parameters.legs {
            leg.joint_angle_rad = -leg.joint_angle_rad;
            leg.elbow = match leg.elbow {
                Elbow::Positive => Elbow::Negative,
                Elbow::Negative => Elbow::Positive,
            };
        }
        let (object, image) = (
            motion(&case.parameters, &case.setpoint),
            motion(&image.parameters, &image.setpoint),
        );
        for (a, b) in object.motors.iter().zip(&image.motors) {
            assert_eq!([a.angle, a.rate], [-b.angle, -b.rate], "{case:?}");
            assert_eq!(
                [a.acceleration, a.torque],
                [-b.acceleration, -b.torque],
                "{case:?}"
            );
        }
        for (a, b) in object.legs.iter().zip(&image.legs) {
            let (a, b) = (&a.position.links, &b.position.links);
            assert_eq!(
                [a.r1.x, a.r1.y, a.r2.x, a.r2.y],
                [b.r1.x, -b.r1.y, b.r2.x, -b.r2.y]
            );
        }
    });
}

/// Legs numbered otherwise: the same kinematics to the bit; torques, which the core solves for
/// with leg 1 set apart, within the bounds of both. det A keeps its sign under a cyclic change.
#[test]
fn renumbering_of_the_legs() {
    let worst = RefCell::new(Worst::default());
    for_all(1500, case(), |case| {
        let first = motion(&case.parameters, &case.setpoint);
        let conditions = results::isotropic_conditions(&case.parameters, &case.setpoint);
        let largest = results::names()
            .iter()
            .zip(conditions)
            .filter(|(name, _)| name.stem == "tau")
            .fold(0.0, |most: f64, (_, cond)| most.max(cond));
        for order in [[1, 2, 0], [2, 0, 1], [0, 2, 1]] {
            let mut parameters = case.parameters;
            parameters.legs = order.map(|leg| case.parameters.legs[leg]);
            let renumbered = motion(&parameters, &case.setpoint);
            for (new, old) in order.into_iter().enumerate() {
                assert_eq!(renumbered.legs[new], first.legs[old]);
                let (a, b) = (&first.motors[old], &renumbered.motors[new]);
                // With the largest condition of the three: see `truth` about leg 1.
                let bound = 4.0 * f64::UNIT_ROUNDOFF * largest;
                worst
                    .borrow_mut()
                    .compare(|| format!("{case:?}"), b.torque - a.torque, bound);
            }
            let sign = if order[0] == 0 { -1.0 } else { 1.0 };
            assert!(renumbered.forces.det_a * first.forces.det_a * sign > 0.0);
        }
    });
    worst.into_inner().assert_within("renumbering", 0.1..=1.0);
}

/// Lengths in other units: a power of two scales every product exactly, so angles and rates keep
/// their bits and torques (mass times length squared) are scaled to the bit.
#[test]
fn scaling_by_powers_of_two_to_the_bit() {
    for_all(3000, (case(), -20i32..20), |(case, exponent)| {
        let k = 2f64.powi(exponent);
        let mut scaled = moved(&case, |v| v * k, Vector2::new(0.0, 0.0), 0.0);
        let parameters = &mut scaled.parameters;
        parameters.platform.com_m *= k;
        parameters.platform.inertia_kgm2 *= k * k;
        parameters.wrench_torque_nm *= k * k;
        for leg in &mut parameters.legs {
            leg.proximal_m *= k;
            leg.distal_m *= k;
            leg.joint_radius_m *= k;
            leg.rotor_inertia_kgm2 *= k * k;
            for link in [&mut leg.proximal, &mut leg.distal] {
                link.com_m *= k;
                link.inertia_kgm2 *= k * k;
            }
        }
        let (small, large) = (
            motion(&case.parameters, &case.setpoint),
            motion(&scaled.parameters, &scaled.setpoint),
        );
        for (a, b) in small.motors.iter().zip(&large.motors) {
            assert_eq!(
                [a.angle, a.rate, a.acceleration],
                [b.angle, b.rate, b.acceleration]
            );
            assert_eq!(a.torque * k * k, b.torque, "{case:?} by {k}");
        }
    });
}

/// The same way back: rates change sign, accelerations and torques do not.
#[test]
fn time_reversal_to_the_bit() {
    for_all(3000, case(), |case| {
        let mut back = case.setpoint;
        back.velocity = -back.velocity;
        let (forth, back) = (
            motion(&case.parameters, &case.setpoint),
            motion(&case.parameters, &back),
        );
        for (a, b) in forth.motors.iter().zip(&back.motors) {
            assert_eq!([a.angle, a.rate], [b.angle, -b.rate]);
            assert_eq!(
                [a.acceleration, a.torque],
                [b.acceleration, b.torque],
                "{case:?}"
            );
        }
    });
}

/// Whole turns of the platform change nothing but roundings of its angle.
#[test]
fn whole_turns_of_the_platform() {
    let worst = RefCell::new(Worst::default());
    for_all(1000, (case(), -100i32..100), |(case, turns)| {
        let turn = f64::from(turns) * core::f64::consts::TAU;
        let wound = moved(&case, |v| v, Vector2::new(0.0, 0.0), turn);
        let torque = |case: &Case| motion(&case.parameters, &case.setpoint).motors[1].torque;
        let conditions = results::isotropic_conditions(&wound.parameters, &wound.setpoint);
        let own = results::isotropic_conditions(&case.parameters, &case.setpoint);
        let index = results::names()
            .iter()
            .position(|name| name.column() == "tau2");
        let index = index.expect("a torque");
        // Two roundings of the turn and one of the sum, then the bounds of both machines.
        let bound = f64::UNIT_ROUNDOFF * (6.0 * conditions[index] + 6.0 * own[index]);
        let difference = torque(&wound) - torque(&case);
        worst
            .borrow_mut()
            .compare(|| format!("{turns} turns of {case:?}"), difference, bound);
    });
    worst.into_inner().assert_within("turns", 0.05..=1.0);
}
