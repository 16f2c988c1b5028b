//! Random redundant machines in motion, and their energy: for the tests of this folder.

use super::*;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, PlatformParameters};
use trirrr_core::setpoint::{Pose, Setpoint};

/// A random machine in a random motion: the platform and the sliders accelerate evenly.
#[derive(Clone, Debug)]
pub(super) struct Case<const LEGS: usize> {
    pub(super) parameters: RedundantParameters<LEGS>,
    pub(super) pose: [[f64; 3]; 3],
    pub(super) sliders: [[f64; 3]; LEGS],
    pub(super) wanted: [f64; LEGS],
}

/// q0 + v t + a t^2 / 2, its rate, and that of it.
fn evenly([q0, v, a]: [f64; 3], t: f64) -> [f64; 3] {
    [q0 + t * (v + 0.5 * a * t), v + a * t, a]
}

impl<const LEGS: usize> Case<LEGS> {
    pub(super) fn setpoint(&self, t: f64) -> Setpoint<f64> {
        let [x, y, alpha] = self.pose.map(|q| evenly(q, t));
        Setpoint {
            pose: Pose::from_f64(x[0], y[0], alpha[0]),
            velocity: Vector3::new(x[1], y[1], alpha[1]),
            acceleration: Vector3::new(x[2], y[2], alpha[2]),
        }
    }

    pub(super) fn slider_states(&self, t: f64) -> [SliderState<f64>; LEGS] {
        self.sliders.map(|q| {
            let [position, velocity, acceleration] = evenly(q, t);
            SliderState {
                position,
                velocity,
                acceleration,
            }
        })
    }

    pub(super) fn evaluate(
        &self,
        machine: &RedundantMachine<f64, LEGS>,
        t: f64,
        wanted: &[f64; LEGS],
    ) -> RedundantMotion<f64, LEGS> {
        machine
            .evaluate(&self.setpoint(t), &self.slider_states(t), wanted)
            .unwrap()
    }

    /// Kinetic and potential energy, from the places and rates of the bodies.
    pub(super) fn energy(&self, machine: &RedundantMachine<f64, LEGS>, t: f64) -> f64 {
        let motion = self.evaluate(machine, t, &[0.0; LEGS]);
        let (setpoint, states) = (self.setpoint(t), self.slider_states(t));
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
        for (leg, state) in states.iter().enumerate() {
            let given = &self.parameters.legs[leg];
            let (mut base, mut v) = (given.base_m, Vector2::new(0.0, 0.0));
            if let Some(slider) = self.parameters.sliders[leg] {
                let (sin, cos) = slider.direction_rad.sin_cos();
                let direction = Vector2::new(cos, sin);
                base += direction * state.position;
                v = direction * state.velocity;
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
                parameters: RedundantParameters {
                    legs,
                    sliders: guides,
                    platform: PlatformParameters {
                        mass_kg: 1.5 + next(),
                        inertia_kgm2: 0.2 + 0.1 * next(),
                        com_m: Vector2::new(0.1 * next(), 0.1 * next()),
                        tool_point_m: Vector2::new(0.0, 0.0),
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
            let machine = RedundantMachine::<f64, LEGS>::build(&case.parameters).unwrap();
            let at = case.sliders.map(|q| q[0]);
            let distances = machine.distances(&case.setpoint(0.0).pose, &at);
            distances.is_ok_and(|it| it.parallel > 0.03)
        })
}

/// Part of `cases` that a build without optimisation takes, at least one: all of them are for `cargo xtask nightly`, which
/// optimises.
pub(crate) const fn share(cases: u32) -> u32 {
    match cfg!(debug_assertions) {
        true => cases.div_ceil(10),
        false => cases,
    }
}

/// Runs `check` on the [share] of `cases` machines.
pub(super) fn for_all<const LEGS: usize>(cases: u32, sliders: bool, check: impl Fn(Case<LEGS>)) {
    deterministic(share(cases), any::<LEGS>(sliders), check);
}

pub(super) fn dot_of<const LEGS: usize>(a: &[f64; LEGS], b: &[f64; LEGS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Runs `check` on the same random values in every run.
fn deterministic<S: Strategy>(cases: u32, strategy: S, check: impl Fn(S::Value)) {
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
    let config = Config {
        cases,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
        .run(&strategy, |value| {
            check(value);
            Ok(())
        })
        .unwrap();
}
