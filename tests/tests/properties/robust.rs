//! Whatever the numbers, a tick ends in finite results or in a status, and so does every stage
//! around it: parameters and states of any bit pattern.

use core::cell::Cell;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use trirrr_core::forward::Forward;
use trirrr_core::machine::{
    Elbow, Geometry, LegParameters, LinkParameters, Parameters, PlatformParameters,
};
use trirrr_core::number::Number;
use trirrr_core::reaction::Reactions;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_tests::evaluate::{distances, evaluate};
use trirrr_tests::random::{Case, case, for_all, share};
use trirrr_tests::results;

/// A number of any size that `N` can hold, favouring what breaks formulas.
fn number<N: Number>() -> impl Strategy<Value = f64> {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.2,
        1e-3,
        1e6,
        1e150,
        -1e150,
        1e-150,
        1e300,
        -1e300,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        f64::from_bits(1),
        f64::EPSILON,
        f64::from(f32::MAX),
        f64::from(f32::MIN_POSITIVE),
        1e19,
        1e-19,
    ];
    prop_oneof![
        4 => -1.0..1.0,
        2 => prop::sample::select(special.to_vec()),
        1 => any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        1 => any::<u32>().prop_map(|bits| f64::from(f32::from_bits(bits))).prop_filter("finite", |x| x.is_finite()),
    ]
    .prop_map(|x| if N::from_f64(x).is_finite() { x } else { 1e38 * x.signum() })
}

fn vector<N: Number>() -> impl Strategy<Value = Vector2<f64>> {
    [number::<N>(), number::<N>()].prop_map(Vector2::from)
}

fn link<N: Number>() -> impl Strategy<Value = LinkParameters> {
    prop_oneof![
        Just(LinkParameters::default()),
        (number::<N>(), number::<N>(), number::<N>()).prop_map(|(mass, com_m, inertia)| {
            LinkParameters {
                mass_kg: mass.abs(),
                com_m,
                inertia_kgm2: inertia.abs(),
            }
        }),
    ]
}

/// Mostly lengths that the check accepts: three of each leg have to pass it.
fn length<N: Number>() -> impl Strategy<Value = f64> {
    prop_oneof![6 => 1e-3..1e3, 1 => number::<N>()]
}

fn leg<N: Number>() -> impl Strategy<Value = LegParameters> {
    let lengths = (length::<N>(), length::<N>(), length::<N>());
    (
        vector::<N>(),
        lengths,
        number::<N>(),
        any::<bool>(),
        link::<N>(),
        link::<N>(),
        number::<N>(),
    )
        .prop_map(
            |(base_m, (l1, l2, h), joint_angle_rad, positive, proximal, distal, rotor)| {
                LegParameters {
                    base_m,
                    proximal_m: l1.abs(),
                    distal_m: l2.abs(),
                    joint_radius_m: h.abs(),
                    joint_angle_rad,
                    elbow: if positive {
                        Elbow::Positive
                    } else {
                        Elbow::Negative
                    },
                    proximal,
                    distal,
                    rotor_inertia_kgm2: rotor.abs(),
                }
            },
        )
}

fn parameters<N: Number>() -> impl Strategy<Value = Parameters> {
    let platform = (number::<N>(), number::<N>(), vector::<N>());
    (
        [leg::<N>(), leg::<N>(), leg::<N>()],
        platform,
        vector::<N>(),
        vector::<N>(),
        number::<N>(),
    )
        .prop_map(
            |(legs, (mass, inertia, com_m), gravity_m_s2, wrench_force_n, wrench_torque_nm)| {
                Parameters {
                    legs,
                    platform: PlatformParameters {
                        mass_kg: mass.abs(),
                        inertia_kgm2: inertia.abs(),
                        com_m,
                        tool_point_m: Vector2::new(0.0, 0.0),
                    },
                    gravity_m_s2,
                    wrench_force_n,
                    wrench_torque_nm,
                }
            },
        )
}

/// A state of any numbers, or now and then not even numbers.
fn state<N: Number>() -> impl Strategy<Value = Setpoint<N>> {
    let any_number =
        || prop_oneof![30 => number::<N>(), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)];
    let three = || [any_number(), any_number(), any_number()];
    (three(), three(), three()).prop_map(|([x, y, alpha], velocity, acceleration)| Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::from(velocity).map(N::from_f64),
        acceleration: Vector3::from(acceleration).map(N::from_f64),
    })
}

/// What the core promises for one tick; true when it ended in results.
fn holds<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> bool {
    // Positions have results of their own, also where there is no motion.
    let (serial, parallel) = distances(parameters, &setpoint.pose);
    for distance in serial.into_iter().chain([parallel]) {
        assert!(
            distance >= 0.0 && distance.is_finite(),
            "distance {distance}: {parameters:?} {setpoint:?}"
        );
    }
    match evaluate(parameters, setpoint) {
        Ok(motion) => {
            // Joint forces and powers may leave the range of the number type, and say so.
            let list = results::of_core(parameters, setpoint, &motion).unwrap_or_default();
            for (name, value) in results::names().into_iter().zip(list) {
                assert!(
                    value.is_finite(),
                    "{}: {value}: {parameters:?} {setpoint:?}",
                    name.column()
                );
            }
            true
        }
        Err(status) => {
            assert!(!status.to_string().is_empty());
            false
        }
    }
}

/// Machines of any numbers that pass the check are nearly always out of reach: those tell that no
/// guard is missing on the way there.
fn any_numbers<N: Number>(cases: u32) {
    let accepted = Cell::new(0);
    for_all(
        cases,
        (parameters::<N>(), state::<N>()),
        |(parameters, setpoint)| {
            if parameters.check::<N>().is_ok() {
                accepted.set(accepted.get() + 1);
                holds(&parameters, &setpoint);
            }
        },
    );
    assert!(
        accepted.get() > share(cases) / 10,
        "only {} machines were accepted",
        accepted.get()
    );
}

/// Machines that reach their pose, with velocities, accelerations, masses and loads of any
/// numbers, and one length in two hundred spoilt: nearly all of it runs through to the torques.
fn reachable<N: Number>(cases: u32) {
    let finished = Cell::new(0);
    let spoilt = (
        case(),
        [number::<N>(), number::<N>(), number::<N>()],
        [number::<N>(), number::<N>(), number::<N>()],
        parameters::<N>(),
    );
    for_all(cases, spoilt, |(case, velocity, acceleration, other)| {
        let Case {
            mut parameters,
            setpoint,
            ..
        } = case;
        parameters.platform = other.platform;
        parameters.gravity_m_s2 = other.gravity_m_s2;
        parameters.wrench_force_n = other.wrench_force_n;
        for (leg, other) in parameters.legs.iter_mut().zip(&other.legs) {
            leg.proximal = other.proximal;
            leg.distal = other.distal;
            leg.rotor_inertia_kgm2 = other.rotor_inertia_kgm2;
        }
        let pose = &setpoint.pose;
        let setpoint = Setpoint::<N> {
            pose: Pose::from_f64(pose.position.x, pose.position.y, pose.angle),
            velocity: Vector3::from(velocity).map(N::from_f64),
            acceleration: Vector3::from(acceleration).map(N::from_f64),
        };
        if parameters.check::<N>().is_ok() {
            finished.set(finished.get() + u32::from(holds(&parameters, &setpoint)));
        }
    });
    assert!(
        finished.get() > share(cases) / 50,
        "only {} ended in results",
        finished.get()
    );
}

#[test]
fn any_numbers_end_in_results_or_a_status_in_f64() {
    any_numbers::<f64>(20_000);
    reachable::<f64>(5000);
}

#[test]
fn any_numbers_end_in_results_or_a_status_in_f32() {
    any_numbers::<f32>(20_000);
    reachable::<f32>(5000);
}

/// Joint forces of an ordinary machine are finite wherever its torques are.
#[test]
fn reactions_of_ordinary_machines_are_finite() {
    for_all(2000, case(), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        let forces = Reactions::build(&case.parameters).forces(&motion);
        for forces in forces.expect("finite forces") {
            let sum = forces.base + forces.elbow + forces.platform;
            assert!(sum.x.is_finite() && sum.y.is_finite(), "{case:?}");
        }
    });
}

/// Poses from far outside through both limits of a leg's reach to its pivot: a status or a motion
/// at every one, and near the limits the right status.
#[test]
fn every_distance_from_a_motor_has_a_result_or_a_status() {
    let mut parameters = trirrr_tests::machines::thesis();
    for leg in &mut parameters.legs {
        leg.joint_radius_m = 0.0;
    }
    let geometry = Geometry::<f64>::build(&parameters).expect("a machine");
    let base = parameters.legs[0].base_m;
    let at = |distance: f64| geometry.position(&Pose::from_f64(base.x + distance, base.y, 0.0));
    assert_eq!(at(0.4 + 1e-9), Err(Status::Unreachable { leg: 0 }));
    // Legs of equal links fold to their pivot: singular there and nowhere near.
    assert_eq!(at(0.0), Err(Status::SerialSingular { leg: 0 }));
    for exponent in -320..3 {
        let _ = at(10f64.powi(exponent));
    }
}

/// Forward kinematics from any angles and any guess ends in a pose or in an error.
#[test]
fn forward_from_anywhere_ends() {
    let found = Cell::new(0);
    let three = || [number::<f64>(), number::<f64>(), number::<f64>()];
    for_all(
        5000,
        (case(), three(), three(), any::<bool>()),
        |(case, angles, guess, near)| {
            let geometry = Geometry::<f64>::build(&case.parameters).expect("a machine");
            let forward = Forward::build(&case.parameters, &geometry);
            let guess = if near {
                case.setpoint.pose
            } else {
                Pose::from_f64(guess[0], guess[1], guess[2])
            };
            if let Ok(result) = forward.solve(&angles, guess, 30) {
                let pose = result.pose;
                assert!(
                    pose.position.x.is_finite() && pose.position.y.is_finite(),
                    "{case:?}"
                );
                assert!(
                    pose.angle.is_finite() && result.residual.is_finite(),
                    "{case:?}"
                );
                found.set(found.get() + 1);
            }
        },
    );
    assert!(found.get() > 50, "only {} found", found.get());
}
