//! The machines of table 1.1, and what is refused.

use super::super::random::dot_of;
use super::super::*;
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{Quantity, example};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
/// The six machines of table 1.1, of the thesis's links: sliders along the sides, more legs round
/// the middle.
fn table() -> Vec<(&'static str, RedundantParameters<6>, usize)> {
    let three = example();
    let make = |legs: usize, sliders: usize| {
        let guide = |leg: usize| SliderParameters {
            direction_rad: [0.0, core::f64::consts::PI, 0.0][leg],
            mass_kg: 1.0,
        };
        RedundantParameters {
            legs: core::array::from_fn(|leg| {
                let turn = core::f64::consts::TAU * leg as f64 / legs.max(1) as f64;
                let mut made = three.legs[leg % 3];
                if legs > 3 {
                    made.base_m = Vector2::new(0.25 + 0.28 * turn.cos(), 0.25 + 0.28 * turn.sin());
                    made.joint_angle_rad = turn;
                }
                made
            }),
            sliders: core::array::from_fn(|leg| (leg < sliders).then(|| guide(leg))),
            platform: three.platform,
            gravity_m_s2: Vector2::new(0.0, 0.0),
            wrench_force_n: Vector2::new(1.0, -2.0),
            wrench_torque_nm: 0.1,
        }
    };
    vec![
        ("3-RRR", make(3, 0), 3),
        ("4-RRR", make(4, 0), 4),
        ("6-RRR", make(6, 0), 6),
        ("PRRR+2RRR", make(3, 1), 3),
        ("2PRRR+RRR", make(3, 2), 3),
        ("3PRRR", make(3, 3), 3),
    ]
}

fn first<const LEGS: usize>(of: &RedundantParameters<6>) -> RedundantParameters<LEGS> {
    RedundantParameters {
        legs: core::array::from_fn(|leg| of.legs[leg]),
        sliders: core::array::from_fn(|leg| of.sliders[leg]),
        platform: of.platform,
        gravity_m_s2: of.gravity_m_s2,
        wrench_force_n: of.wrench_force_n,
        wrench_torque_nm: of.wrench_torque_nm,
    }
}

/// Norm of the torques, in f64, and by how much those in f32 differ.
fn torques<const LEGS: usize>(parameters: &RedundantParameters<6>) -> (f64, f64) {
    fn of<N: Number, const LEGS: usize>(parameters: &RedundantParameters<6>) -> [f64; LEGS] {
        let machine = RedundantMachine::<N, LEGS>::build(&first(parameters)).unwrap();
        let number = N::from_f64;
        let setpoint = Setpoint {
            pose: Pose::from_f64(0.25, 0.26, 0.2),
            velocity: Vector3::new(number(0.3), number(-0.2), number(0.5)),
            acceleration: Vector3::new(number(2.0), number(1.0), number(-3.0)),
        };
        let states = [SliderState {
            position: number(0.01),
            velocity: number(0.2),
            acceleration: number(-1.0),
        }; LEGS];
        let motion = machine
            .evaluate(&setpoint, &states, &[N::ZERO; LEGS])
            .unwrap();
        let sliders = motion.sliders.iter().flatten().count();
        assert_eq!(sliders, parameters.sliders.iter().flatten().count());
        motion.motors.map(|motor| motor.torque.to_f64())
    }
    let (double, single) = (of::<f64, LEGS>(parameters), of::<f32, LEGS>(parameters));
    let off: [f64; LEGS] = core::array::from_fn(|leg| double[leg] - single[leg]);
    (dot_of(&double, &double).sqrt(), dot_of(&off, &off).sqrt())
}

#[test]
fn every_machine_of_the_table_is_solved() {
    let mut norms = Vec::new();
    for (name, parameters, legs) in table() {
        let (norm, off) = match legs {
            3 => torques::<3>(&parameters),
            4 => torques::<4>(&parameters),
            _ => torques::<6>(&parameters),
        };
        assert!(norm > 0.05 && norm < 2.0, "{name}: {norm}");
        assert!(off < 2e-5 * norm, "{name}: {off:e} of {norm}");
        norms.push(norm);
    }
    // Six motors share what four carry.
    assert!(norms[2] < norms[1]);
}

#[test]
fn a_slider_at_rest_is_a_base_joint_elsewhere() {
    let (_, parameters, _) = table()[5];
    let slid = RedundantMachine::<f64, 3>::build(&first(&parameters)).unwrap();
    let mut moved = first::<3>(&parameters);
    moved.sliders = [None; 3];
    moved.legs[0].base_m.x += 0.03;
    let moved = RedundantMachine::<f64, 3>::build(&moved).unwrap();
    let setpoint = Setpoint {
        pose: Pose::from_f64(0.25, 0.26, 0.2),
        velocity: Vector3::new(0.3, -0.2, 0.5),
        acceleration: Vector3::new(2.0, 1.0, -3.0),
    };
    let states = [
        SliderState::at(0.03),
        SliderState::at(0.0),
        SliderState::at(0.0),
    ];
    let slid = slid.evaluate(&setpoint, &states, &[0.0; 3]).unwrap();
    let moved = moved
        .evaluate(&setpoint, &[SliderState::at(0.0); 3], &[0.0; 3])
        .unwrap();
    for (slid, moved) in slid.motors.iter().zip(&moved.motors) {
        assert!((slid.torque - moved.torque).abs() < 1e-14);
        assert!((slid.angle - moved.angle).abs() < 1e-14);
    }
}

#[test]
fn refuses_with_the_leg_and_the_reason() {
    let (_, good, _) = table()[2];
    let build = |parameters: &RedundantParameters<6>| RedundantMachine::<f64, 6>::build(parameters);
    let mut bad = good;
    bad.legs[4].distal_m = -1.0;
    let error = build(&bad).unwrap_err();
    assert_eq!(
        (error.quantity, error.leg),
        (Quantity::DistalLength, Some(4))
    );
    let mut bad = good;
    bad.sliders[5] = Some(SliderParameters {
        direction_rad: 0.0,
        mass_kg: f64::NAN,
    });
    let error = build(&bad).unwrap_err();
    assert_eq!((error.quantity, error.leg), (Quantity::SliderMass, Some(5)));
    bad.sliders[5] = Some(SliderParameters {
        direction_rad: f64::INFINITY,
        mass_kg: 1.0,
    });
    let error = build(&bad).unwrap_err();
    assert_eq!(
        (error.quantity, error.leg),
        (Quantity::SliderDirection, Some(5))
    );

    let machine = build(&good).unwrap();
    let at = |x: f64| Setpoint {
        pose: Pose::from_f64(x, 0.25, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        acceleration: Vector3::new(0.0, 0.0, 0.0),
    };
    let evaluate = |machine: &RedundantMachine<f64, 6>, x: f64| {
        let motion = machine.evaluate(&at(x), &[SliderState::at(0.0); 6], &[0.0; 6]);
        motion.map(|motion| motion.parallel)
    };
    assert_eq!(evaluate(&machine, 9.0), Err(Status::Unreachable { leg: 0 }));
    // The leg opposite to the way comes out of reach first.
    assert_eq!(evaluate(&machine, 0.4), Err(Status::Unreachable { leg: 3 }));
    assert!(evaluate(&machine, 0.25).unwrap() > 0.01);
    assert_eq!(
        evaluate(&machine, f64::NAN),
        Err(Status::Unreachable { leg: 0 })
    );

    // All joints of the platform in one point.
    let mut loose = good;
    for leg in &mut loose.legs {
        leg.joint_radius_m = 0.0;
    }
    assert_eq!(
        evaluate(&build(&loose).unwrap(), 0.25),
        Err(Status::ParallelSingular)
    );
}
