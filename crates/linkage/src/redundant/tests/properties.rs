//! Properties of every machine.

use super::super::random::{dot_of, for_all};
use super::super::*;
use core::cell::Cell;
use nalgebra::Vector3;
use trirrr_core::model::Dynamic;
use trirrr_core::number::cross;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
#[test]
fn three_legs_are_the_tick() {
    type Full = Tick<Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>>;
    for_all::<3>(10_000, false, |case| {
        let machine = RedundantMachine::build(&case.parameters).unwrap();
        let tick = Full::build(&case.parameters.three([0, 1, 2])).unwrap();
        let ours = case.evaluate(&machine, 0.0, &case.wanted);
        let motion = tick.evaluate(&case.setpoint(0.0)).unwrap();
        let reactions = trirrr_core::reaction::Reactions::build(&case.parameters.three([0, 1, 2]));
        let reactions = reactions.forces(&motion).unwrap();
        assert_eq!(ours.legs, motion.legs);
        let size = motion
            .motors
            .iter()
            .map(|motor| motor.torque.abs())
            .fold(1.0, f64::max);
        for (leg, reactions) in reactions.iter().enumerate() {
            let (ours_of, theirs) = (&ours.motors[leg], &motion.motors[leg]);
            assert_eq!((ours_of.angle, ours_of.rate), (theirs.angle, theirs.rate));
            let off = (ours_of.torque - theirs.torque).abs() / size;
            assert!(off < 1e-13 / ours.parallel, "{off:e}: {case:?}");
            let off = (ours.joints[leg].base - reactions.base).abs().max();
            assert!(off < 1e-12 / ours.parallel * size, "{off:e}");
        }
        let distances =
            trirrr_core::singularity::Distances::build(&case.parameters.three([0, 1, 2]));
        let theirs = distances.parallel(&motion.position());
        assert!((ours.parallel - theirs).abs() < 1e-14);
        let ours = machine
            .distances(&case.setpoint(0.0).pose, &[0.0; 3])
            .unwrap();
        for (ours, theirs) in ours.serial.iter().zip(distances.serial(&motion.position())) {
            assert!((ours - theirs).abs() < 1e-15);
        }
    });
}

/// Motors and sliders supply what the bodies' energy gains, less what the wrench puts in.
fn power_is_balanced<const LEGS: usize>(sliders: bool) {
    for_all::<LEGS>(2500, sliders, |case| {
        let machine = RedundantMachine::build(&case.parameters).unwrap();
        for wanted in [[0.0; LEGS], case.wanted] {
            let motion = case.evaluate(&machine, 0.0, &wanted);
            let mut supplied = 0.0;
            let mut size = 1.0;
            for motor in &motion.motors {
                supplied += motor.torque * motor.rate;
                size += (motor.torque * motor.rate).abs();
            }
            for slider in motion.sliders.iter().flatten() {
                supplied += slider.power;
                size += slider.power.abs();
            }
            let velocity = case.setpoint(0.0).velocity;
            let wrench = case.parameters.wrench_force_n.dot(&velocity.xy())
                + case.parameters.wrench_torque_nm * velocity.z;
            // Five points: the error is of fourth order in the step.
            let h = 1e-4;
            let at = |steps: f64| case.energy(&machine, steps * h);
            let gained = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let off = (supplied - (gained - wrench)).abs() / size;
            assert!(off < 1e-8, "{off:e}: {case:?}");
        }
        assert_eq!(
            case.parameters.sliders.map(|it| it.is_some()),
            case.evaluate(&machine, 0.0, &[0.0; LEGS])
                .sliders
                .map(|it| it.is_some())
        );
    });
}

#[test]
fn power_is_balanced_in_3_rrr() {
    power_is_balanced::<3>(false);
}

#[test]
fn power_is_balanced_with_sliders() {
    power_is_balanced::<3>(true);
}

#[test]
fn power_is_balanced_in_4_rrr() {
    power_is_balanced::<4>(false);
}

#[test]
fn power_is_balanced_in_6_rrr_with_sliders() {
    power_is_balanced::<6>(true);
}

/// Of least norm, and preloaded by what the platform does not feel.
fn torques_are_least<const LEGS: usize>() {
    let spread = Cell::new(0.0f64);
    for_all::<LEGS>(5000, true, |case| {
        let machine = RedundantMachine::build(&case.parameters).unwrap();
        let least = case.evaluate(&machine, 0.0, &[0.0; LEGS]);
        let preloaded = case.evaluate(&machine, 0.0, &case.wanted);
        let torques = least.motors.each_ref().map(|motor| motor.torque);
        let other = preloaded.motors.each_ref().map(|motor| motor.torque);
        let held: [f64; LEGS] = core::array::from_fn(|leg| other[leg] - torques[leg]);
        let (norm, of_held) = (
            dot_of(&torques, &torques).sqrt(),
            dot_of(&held, &held).sqrt(),
        );
        let closest = least
            .legs
            .iter()
            .map(|leg| leg.position.links.r1_cross_r2.abs());
        let rounding =
            1e-13 * (norm + of_held + 1.0) / (least.parallel * closest.fold(1.0, f64::min));

        // The torques that hold each other are across from those of least norm,
        assert!(
            dot_of(&torques, &held).abs() < rounding * (of_held + 1.0),
            "{case:?}"
        );
        // so that any others are larger,
        assert!(dot_of(&other, &other).sqrt() > norm - rounding);
        // they are the part of what was wanted that can be had,
        let left: [f64; LEGS] = core::array::from_fn(|leg| case.wanted[leg] - held[leg]);
        let wanted = dot_of(&case.wanted, &case.wanted).sqrt();
        assert!(
            dot_of(&left, &held).abs() < rounding * (wanted + 1.0),
            "{case:?}"
        );
        // and the platform does not feel them: J^T tau = 0.
        let mut felt = Vector3::new(0.0, 0.0, 0.0);
        for (leg, held) in preloaded.legs.iter().zip(held) {
            let (c, r2) = (leg.position.platform_joint, leg.position.links.r2);
            let row = Vector3::new(r2.x, r2.y, cross(c, r2));
            felt += row * (held / leg.position.links.r1_cross_r2);
        }
        let serial = machine
            .distances(&case.setpoint(0.0).pose, &case.sliders.map(|q| q[0]))
            .unwrap()
            .serial;
        let nearest = serial.iter().fold(1.0, |a: f64, &b| a.min(b));
        assert!(felt.abs().max() < rounding / nearest, "{felt:?}: {case:?}");
        spread.set(spread.get().max(of_held));
    });
    // With three legs there is nothing to preload.
    assert_eq!(spread.get() > 1.0, LEGS > 3);
    assert!(LEGS > 3 || spread.get() == 0.0);
}

#[test]
fn torques_are_least_in_3_rrr() {
    torques_are_least::<3>();
}

#[test]
fn torques_are_least_in_4_rrr() {
    torques_are_least::<4>();
}

#[test]
fn torques_are_least_in_6_rrr() {
    torques_are_least::<6>();
}

#[test]
fn rates_and_accelerations_are_those_of_the_angles() {
    for_all::<3>(10_000, true, |case| {
        let machine = RedundantMachine::build(&case.parameters).unwrap();
        let motors = |t: f64| case.evaluate(&machine, t, &[0.0; 3]).motors;
        let h = 1e-4;
        let (before, now, after) = (motors(-h), motors(0.0), motors(h));
        for leg in 0..3 {
            let turned = |a: f64, b: f64| (b - a).sin().atan2((b - a).cos());
            let rate = turned(before[leg].angle, after[leg].angle) / (2.0 * h);
            let acceleration = (after[leg].rate - before[leg].rate) / (2.0 * h);
            let size = 1.0 + now[leg].rate.abs() + now[leg].acceleration.abs();
            // Second order in h; the third derivative grows with the cube of the size.
            let bound = 1e-7 * size * size * size;
            assert!((rate - now[leg].rate).abs() < bound, "{case:?}");
            assert!(
                (acceleration - now[leg].acceleration).abs() < 10.0 * bound * size,
                "{case:?}"
            );
        }
    });
}
