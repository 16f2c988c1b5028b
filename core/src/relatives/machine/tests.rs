use super::*;
use crate::machine::{Elbow, LegParameters, LinkParameters, PlatformParameters, Quantity, example};
use crate::relatives::SliderParameters;
use crate::tick::Tick;
use crate::torque::links::Massive;
use core::cell::Cell;
use proptest::prelude::*;
use std::vec::Vec;

/// A random machine in a random motion: the platform and the sliders accelerate evenly.
#[derive(Clone, Debug)]
struct Case<const LEGS: usize> {
    parameters: RelativeParameters<LEGS>,
    pose: [[f64; 3]; 3],
    sliders: [[f64; 3]; LEGS],
    wanted: [f64; LEGS],
}

/// q0 + v t + a t^2 / 2, its rate, and that of it.
fn evenly([q0, v, a]: [f64; 3], t: f64) -> [f64; 3] {
    [q0 + t * (v + 0.5 * a * t), v + a * t, a]
}

impl<const LEGS: usize> Case<LEGS> {
    fn setpoint(&self, t: f64) -> Setpoint<f64> {
        let [x, y, alpha] = self.pose.map(|q| evenly(q, t));
        Setpoint {
            pose: Pose::from_f64(x[0], y[0], alpha[0]),
            velocity: Vector3::new(x[1], y[1], alpha[1]),
            acceleration: Vector3::new(x[2], y[2], alpha[2]),
        }
    }

    fn along(&self, t: f64) -> [Along<f64>; LEGS] {
        self.sliders.map(|q| {
            let [position, velocity, acceleration] = evenly(q, t);
            Along {
                position,
                velocity,
                acceleration,
            }
        })
    }

    fn evaluate(
        &self,
        relative: &Relative<f64, LEGS>,
        t: f64,
        wanted: &[f64; LEGS],
    ) -> RelativeMotion<f64, LEGS> {
        relative
            .evaluate(&self.setpoint(t), &self.along(t), wanted)
            .unwrap()
    }

    /// Kinetic and potential energy, from the places and rates of the bodies.
    fn energy(&self, relative: &Relative<f64, LEGS>, t: f64) -> f64 {
        let motion = self.evaluate(relative, t, &[0.0; LEGS]);
        let (setpoint, along) = (self.setpoint(t), self.along(t));
        let gravity = self.parameters.gravity_m_s2;
        let body = |mass: f64, inertia: f64, at: Vector2<f64>, v: Vector2<f64>, rate: f64| {
            0.5 * (mass * v.dot(&v) + inertia * rate * rate) - mass * gravity.dot(&at)
        };
        let turned = |v: Vector2<f64>, w: f64| Vector2::new(-v.y, v.x) * w;

        let platform = &self.parameters.platform;
        let (sin, cos) = f64::sin_cos(setpoint.pose.angle);
        let com = platform.com_m;
        let s = Vector2::new(com.x * cos - com.y * sin, com.x * sin + com.y * cos);
        let rate = setpoint.velocity.z;
        let mut energy = body(
            platform.mass_kg,
            platform.inertia_kgm2,
            setpoint.pose.position + s,
            setpoint.velocity.xy() + turned(s, rate),
            rate,
        );
        for (leg, along) in along.iter().enumerate() {
            let given = &self.parameters.legs[leg];
            let (mut base, mut v) = (given.base_m, Vector2::new(0.0, 0.0));
            if let Some(slider) = self.parameters.sliders[leg] {
                let (sin, cos) = slider.direction_rad.sin_cos();
                let direction = Vector2::new(cos, sin);
                base += direction * along.position;
                v = direction * along.velocity;
                energy += body(slider.mass_kg, 0.0, base, v, 0.0);
            }
            let (links, rates) = (&motion.legs[leg].position.links, &motion.legs[leg].rates);
            for (link, length, r, rate, rotor) in [
                (
                    &given.proximal,
                    given.proximal_m,
                    links.r1,
                    rates.proximal,
                    given.rotor_inertia_kgm2,
                ),
                (&given.distal, given.distal_m, links.r2, rates.distal, 0.0),
            ] {
                let com = r * (link.com_m / length);
                let inertia = link.inertia_kgm2 + rotor;
                energy += body(
                    link.mass_kg,
                    inertia,
                    base + com,
                    v + turned(com, rate),
                    rate,
                );
                base += r;
                v += turned(r, rate);
            }
        }
        energy
    }
}

/// Machines that close at their pose, well away from singularities.
fn any<const LEGS: usize>(with_sliders: bool) -> impl Strategy<Value = Case<LEGS>> {
    let numbers = proptest::collection::vec(-1.0..1.0f64, 24 + 24 * LEGS);
    numbers
        .prop_map(move |numbers| {
            let mut numbers = numbers.into_iter();
            let mut next = move || numbers.next().unwrap();
            let pose = core::array::from_fn(|_| [next(), 0.5 * next(), next()]);
            let mut sliders = [[0.0; 3]; LEGS];
            let mut guides = [None; LEGS];
            let legs = core::array::from_fn(|leg| {
                let (l1, l2) = (0.6 + 0.3 * next(), 0.6 + 0.3 * next());
                let (h, lambda) = (0.3 + 0.2 * next(), 3.1 * next());
                let theta1 = 3.1 * next();
                let bend = 1.6 + 0.9 * next();
                let elbow = if next() > 0.0 {
                    Elbow::Positive
                } else {
                    Elbow::Negative
                };
                // r1 x r2 = -sigma S.
                let theta2 = theta1 - elbow.sign() * bend;
                let turned =
                    |length: f64, angle: f64| Vector2::new(angle.cos(), angle.sin()) * length;
                let place: [[f64; 3]; 3] = pose;
                let joint =
                    Vector2::new(place[0][0], place[1][0]) + turned(h, lambda + place[2][0]);
                let mut base_m = joint - turned(l1, theta1) - turned(l2, theta2);
                let (along, direction_rad, mass_kg) =
                    ([next(), next(), next()], 3.1 * next(), 1.0 + next());
                if with_sliders && leg % 2 == 0 {
                    base_m -= turned(along[0], direction_rad);
                    sliders[leg] = along;
                    guides[leg] = Some(SliderParameters {
                        direction_rad,
                        mass_kg,
                    });
                }
                let mut link = |length: f64| LinkParameters {
                    mass_kg: 0.5 + 0.4 * next(),
                    com_m: length * (0.5 + 0.6 * next()),
                    inertia_kgm2: 0.05 + 0.04 * next(),
                };
                LegParameters {
                    base_m,
                    proximal_m: l1,
                    distal_m: l2,
                    joint_radius_m: h,
                    joint_angle_rad: lambda,
                    elbow,
                    proximal: link(l1),
                    distal: link(l2),
                    rotor_inertia_kgm2: 0.02,
                }
            });
            Case {
                parameters: RelativeParameters {
                    legs,
                    sliders: guides,
                    platform: PlatformParameters {
                        mass_kg: 1.5 + next(),
                        inertia_kgm2: 0.2 + 0.1 * next(),
                        com_m: Vector2::new(0.1 * next(), 0.1 * next()),
                    },
                    gravity_m_s2: Vector2::new(3.0 * next(), -9.81),
                    wrench_force_n: Vector2::new(5.0 * next(), 5.0 * next()),
                    wrench_torque_nm: next(),
                },
                pose,
                sliders,
                wanted: core::array::from_fn(|_| 20.0 * next()),
            }
        })
        .prop_filter("near a parallel singularity", |case: &Case<LEGS>| {
            let relative = Relative::<f64, LEGS>::build(&case.parameters).unwrap();
            let at = case.sliders.map(|q| q[0]);
            let distances = relative.distances(&case.setpoint(0.0).pose, &at);
            distances.is_ok_and(|it| it.parallel > 0.03)
        })
}

fn for_all<const LEGS: usize>(cases: u32, sliders: bool, check: impl Fn(Case<LEGS>)) {
    crate::forward::random::deterministic(cases, any::<LEGS>(sliders), check);
}

fn dot_of<const LEGS: usize>(a: &[f64; LEGS], b: &[f64; LEGS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn three_legs_are_the_tick() {
    type Full = Tick<f64, Offset<f64>, Massive<f64, InPlane<f64>>>;
    for_all::<3>(2000, false, |case| {
        let relative = Relative::build(&case.parameters).unwrap();
        let tick = Full::build(&case.parameters.three([0, 1, 2])).unwrap();
        let ours = case.evaluate(&relative, 0.0, &case.wanted);
        let motion = tick.evaluate(&case.setpoint(0.0)).unwrap();
        let reactions = crate::reaction::Reactions::build(&case.parameters.three([0, 1, 2]));
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
        let distances = crate::singularity::Distances::build(&case.parameters.three([0, 1, 2]));
        let theirs = distances.parallel(&motion.position());
        assert!((ours.parallel - theirs).abs() < 1e-14);
        let ours = relative
            .distances(&case.setpoint(0.0).pose, &[0.0; 3])
            .unwrap();
        for (ours, theirs) in ours.serial.iter().zip(distances.serial(&motion.position())) {
            assert!((ours - theirs).abs() < 1e-15);
        }
    });
}

/// Motors and sliders supply what the bodies' energy gains, less what the wrench puts in.
fn power_is_balanced<const LEGS: usize>(sliders: bool) {
    for_all::<LEGS>(1000, sliders, |case| {
        let relative = Relative::build(&case.parameters).unwrap();
        for wanted in [[0.0; LEGS], case.wanted] {
            let motion = case.evaluate(&relative, 0.0, &wanted);
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
            let at = |steps: f64| case.energy(&relative, steps * h);
            let gained = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let off = (supplied - (gained - wrench)).abs() / size;
            assert!(off < 1e-8, "{off:e}: {case:?}");
        }
        assert_eq!(
            case.parameters.sliders.map(|it| it.is_some()),
            case.evaluate(&relative, 0.0, &[0.0; LEGS])
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
    for_all::<LEGS>(2000, true, |case| {
        let relative = Relative::build(&case.parameters).unwrap();
        let least = case.evaluate(&relative, 0.0, &[0.0; LEGS]);
        let preloaded = case.evaluate(&relative, 0.0, &case.wanted);
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
        let serial = relative
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
    for_all::<3>(2000, true, |case| {
        let relative = Relative::build(&case.parameters).unwrap();
        let motors = |t: f64| case.evaluate(&relative, t, &[0.0; 3]).motors;
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

/// The six machines of table 1.1, of the thesis's links: sliders along the sides, more legs round
/// the middle.
fn table() -> Vec<(&'static str, RelativeParameters<6>, usize)> {
    let three = example();
    let make = |legs: usize, sliders: usize| {
        let guide = |leg: usize| SliderParameters {
            direction_rad: [0.0, core::f64::consts::PI, 0.0][leg],
            mass_kg: 1.0,
        };
        RelativeParameters {
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
    std::vec![
        ("3-RRR", make(3, 0), 3),
        ("4-RRR", make(4, 0), 4),
        ("6-RRR", make(6, 0), 6),
        ("PRRR+2RRR", make(3, 1), 3),
        ("2PRRR+RRR", make(3, 2), 3),
        ("3PRRR", make(3, 3), 3),
    ]
}

fn first<const LEGS: usize>(of: &RelativeParameters<6>) -> RelativeParameters<LEGS> {
    RelativeParameters {
        legs: core::array::from_fn(|leg| of.legs[leg]),
        sliders: core::array::from_fn(|leg| of.sliders[leg]),
        platform: of.platform,
        gravity_m_s2: of.gravity_m_s2,
        wrench_force_n: of.wrench_force_n,
        wrench_torque_nm: of.wrench_torque_nm,
    }
}

/// Norm of the torques, in f64, and by how much those in f32 differ.
fn torques<const LEGS: usize>(parameters: &RelativeParameters<6>) -> (f64, f64) {
    fn of<N: Number, const LEGS: usize>(parameters: &RelativeParameters<6>) -> [f64; LEGS] {
        let relative = Relative::<N, LEGS>::build(&first(parameters)).unwrap();
        let number = N::from_f64;
        let setpoint = Setpoint {
            pose: Pose::from_f64(0.25, 0.26, 0.2),
            velocity: Vector3::new(number(0.3), number(-0.2), number(0.5)),
            acceleration: Vector3::new(number(2.0), number(1.0), number(-3.0)),
        };
        let along = [Along {
            position: number(0.01),
            velocity: number(0.2),
            acceleration: number(-1.0),
        }; LEGS];
        let motion = relative
            .evaluate(&setpoint, &along, &[N::ZERO; LEGS])
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
    let slid = Relative::<f64, 3>::build(&first(&parameters)).unwrap();
    let mut moved = first::<3>(&parameters);
    moved.sliders = [None; 3];
    moved.legs[0].base_m.x += 0.03;
    let moved = Relative::<f64, 3>::build(&moved).unwrap();
    let setpoint = Setpoint {
        pose: Pose::from_f64(0.25, 0.26, 0.2),
        velocity: Vector3::new(0.3, -0.2, 0.5),
        acceleration: Vector3::new(2.0, 1.0, -3.0),
    };
    let along = [Along::at(0.03), Along::at(0.0), Along::at(0.0)];
    let slid = slid.evaluate(&setpoint, &along, &[0.0; 3]).unwrap();
    let moved = moved
        .evaluate(&setpoint, &[Along::at(0.0); 3], &[0.0; 3])
        .unwrap();
    for (slid, moved) in slid.motors.iter().zip(&moved.motors) {
        assert!((slid.torque - moved.torque).abs() < 1e-14);
        assert!((slid.angle - moved.angle).abs() < 1e-14);
    }
}

#[test]
fn refuses_with_the_leg_and_the_reason() {
    let (_, good, _) = table()[2];
    let build = |parameters: &RelativeParameters<6>| Relative::<f64, 6>::build(parameters);
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

    let relative = build(&good).unwrap();
    let at = |x: f64| Setpoint {
        pose: Pose::from_f64(x, 0.25, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        acceleration: Vector3::new(0.0, 0.0, 0.0),
    };
    let evaluate = |relative: &Relative<f64, 6>, x: f64| {
        let motion = relative.evaluate(&at(x), &[Along::at(0.0); 6], &[0.0; 6]);
        motion.map(|motion| motion.parallel)
    };
    assert_eq!(
        evaluate(&relative, 9.0),
        Err(Status::Unreachable { leg: 0 })
    );
    // The leg opposite to the way comes out of reach first.
    assert_eq!(
        evaluate(&relative, 0.4),
        Err(Status::Unreachable { leg: 3 })
    );
    assert!(evaluate(&relative, 0.25).unwrap() > 0.01);
    assert_eq!(
        evaluate(&relative, f64::NAN),
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
