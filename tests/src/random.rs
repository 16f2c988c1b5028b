//! Random machines in random states, away from singularities: strategies for proptest, and a
//! runner whose cases are the same in every run.

use crate::evaluate::distances;
use core::f64::consts::PI;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};
use trirrr_core::setpoint::{Pose, Setpoint};

/// Least distance from a serial singularity (sine of the angle between the links) and from the
/// parallel one (as the core defines it) of a random machine.
pub const LEAST_DISTANCE: f64 = 0.02;

/// A machine with a state.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The machine with its loads.
    pub parameters: Parameters,
    /// The state of its platform.
    pub setpoint: Setpoint<f64>,
    /// Length that the machine's sizes were drawn about, m.
    pub size: f64,
}

/// Part of `cases` that a build without optimisation takes, at least one: all of them are for `cargo xtask nightly`, which
/// optimises.
pub const fn share(cases: u32) -> u32 {
    match cfg!(debug_assertions) {
        true => cases.div_ceil(10),
        false => cases,
    }
}

/// Runs `test` on the [share] of `cases` values of `strategy`, always the same ones.
///
/// # Panics
/// When a case fails, with the case.
pub fn for_all<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value)) {
    let cases = share(cases);
    let config = Config {
        cases,
        failure_persistence: None,
        max_global_rejects: 100 * cases,
        // Every shrunken case would print its panic; a random machine says no less than a simple.
        max_shrink_iters: 0,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
        .run(&strategy, |value| {
            test(value);
            Ok(())
        })
        .unwrap_or_else(|failure| panic!("{failure}"));
}

/// Any machine: 1 mm to 100 m, three different legs, every working mode, link masses, rotors,
/// payload offset, gravity and wrench each present or not.
pub fn case() -> impl Strategy<Value = Case> {
    let size = (-3.0..2.0).prop_map(|exponent: f64| 10f64.powf(exponent));
    (size, state(), [leg(), leg(), leg()], loads())
        .prop_map(|(size, state, legs, loads)| assemble(size, &state, &legs, &loads))
        .prop_filter("too near to a singularity", is_clear)
}

fn is_clear(case: &Case) -> bool {
    let (serial, parallel) = distances(&case.parameters, &case.setpoint.pose);
    serial.iter().all(|&distance| distance > LEAST_DISTANCE) && parallel > LEAST_DISTANCE
}

/// The link of a leg that is much shorter than the other one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shorter {
    /// The link at the motor.
    Proximal,
    /// The link at the platform.
    Distal,
}

/// Like [`case`] at size 1; in one to three legs one link is shorter than the other by a factor of
/// 10^`decades`.
pub fn unequal_case(
    shorter: Shorter,
    decades: core::ops::Range<f64>,
) -> impl Strategy<Value = Case> {
    let part = decades.prop_map(|decades: f64| 10f64.powf(-decades));
    let which = (any::<bool>(), any::<bool>());
    (state(), [leg(), leg(), leg()], loads(), part, which)
        .prop_map(move |(state, mut legs, loads, part, which)| {
            for (leg, unequal) in legs.iter_mut().zip([which.0, which.1, true]) {
                match (unequal, shorter) {
                    (false, _) => {}
                    (true, Shorter::Proximal) => leg.proximal = leg.distal * part,
                    (true, Shorter::Distal) => leg.distal = leg.proximal * part,
                }
            }
            assemble(1.0, &state, &legs, &loads)
        })
        .prop_filter("too near to a singularity", is_clear)
}

/// Like [`case`] at size 1, with leg 1 of equal links folded onto its base joint but for an angle of
/// 10^-`decades`, and with or without masses of links.
pub fn folded_case(
    decades: core::ops::Range<f64>,
    with_links: bool,
) -> impl Strategy<Value = Case> {
    let open = (decades, any::<bool>());
    (state(), [leg(), leg(), leg()], loads(), open).prop_map(
        move |(state, mut legs, mut loads, (decades, left))| {
            let angle = PI - 10f64.powf(-decades);
            legs[0].distal = legs[0].proximal;
            legs[0].elbow = if left { -angle } else { angle };
            loads.links = with_links;
            assemble(1.0, &state, &legs, &loads)
        },
    )
}

/// A leg about a machine of size 1 and mass 1.
#[derive(Clone, Copy, Debug)]
struct Leg {
    proximal: f64,
    distal: f64,
    radius: f64,
    lambda: f64,
    direction: f64,
    /// Angle from the proximal to the distal link.
    elbow: f64,
    links: [LinkParameters; 2],
    rotor: f64,
}

fn leg() -> impl Strategy<Value = Leg> {
    // Away from 0 and pi; the sign is the elbow's.
    let elbow = (0.03..PI - 0.03, any::<bool>())
        .prop_map(|(angle, left)| if left { -angle } else { angle });
    let link = || {
        (0.01..1.0, -0.2..1.2, 0.05..0.5).prop_map(|(mass_kg, com_m, radius): (f64, f64, f64)| {
            LinkParameters {
                mass_kg,
                com_m,
                inertia_kgm2: mass_kg * radius * radius,
            }
        })
    };
    let lengths = (0.4..1.6, 0.4..1.6, 0.1..1.0);
    let angles = (-PI..PI, -PI..PI, elbow);
    (lengths, angles, [link(), link()], 0.0..0.5).prop_map(
        |((proximal, distal, radius), (lambda, direction, elbow), links, rotor)| Leg {
            proximal,
            distal,
            radius,
            lambda,
            direction,
            elbow,
            links,
            rotor,
        },
    )
}

/// State of a platform of size 1: position, angle, velocity, acceleration.
#[derive(Clone, Copy, Debug)]
struct State {
    position: [f64; 2],
    angle: f64,
    velocity: [f64; 3],
    acceleration: [f64; 3],
}

fn state() -> impl Strategy<Value = State> {
    let component = || -1.0..1.0;
    let three = || [component(), component(), component()];
    let angle = prop_oneof![3 => -PI..PI, 1 => -1000.0..1000.0];
    // At rest now and then, where torque has to stay what it is.
    let moving = prop_oneof![1 => Just(0.0), 9 => Just(1.0)];
    ([component(), component()], angle, three(), three(), moving).prop_map(
        |(position, angle, velocity, acceleration, moving): (_, _, [f64; 3], _, f64)| State {
            position,
            angle,
            velocity: velocity.map(|component| component * moving),
            acceleration,
        },
    )
}

/// What a machine has besides a centred platform: each entry is there or zero.
#[derive(Clone, Copy, Debug)]
struct Loads {
    mass: f64,
    radius: f64,
    com: [f64; 2],
    gravity: [f64; 2],
    force: [f64; 2],
    moment: f64,
    links: bool,
    rotors: bool,
}

fn loads() -> impl Strategy<Value = Loads> {
    let component = || -1.0..1.0;
    let pair = || prop_oneof![Just([0.0, 0.0]), [component(), component()]];
    let platform = (
        (-2.0..2.0).prop_map(|exponent: f64| 10f64.powf(exponent)),
        0.1..1.0,
    );
    let kinds = (any::<bool>(), any::<bool>());
    (platform, pair(), pair(), pair(), component(), kinds).prop_map(
        |((mass, radius), com, gravity, force, moment, (links, rotors))| Loads {
            mass,
            radius,
            com,
            gravity,
            force,
            moment,
            links,
            rotors,
        },
    )
}

/// Builds the machine from its pose outwards: the legs are laid from the platform joints to where
/// their motors then have to stand, so that the pose is reached in the mode drawn.
fn assemble(size: f64, state: &State, legs: &[Leg; 3], loads: &Loads) -> Case {
    let turned = |length: f64, angle: f64| Vector2::new(angle.cos(), angle.sin()) * length;
    let position = Vector2::from(state.position) * size;
    let link = |link: &LinkParameters, length: f64| {
        if loads.links {
            LinkParameters {
                mass_kg: link.mass_kg * loads.mass,
                com_m: link.com_m * length,
                inertia_kgm2: link.inertia_kgm2 * loads.mass * length * length,
            }
        } else {
            LinkParameters::default()
        }
    };
    let legs = legs.map(|leg| {
        let [proximal_m, distal_m, joint_radius_m] =
            [leg.proximal, leg.distal, leg.radius].map(|length| length * size);
        let joint = position + turned(joint_radius_m, state.angle + leg.lambda);
        let links = turned(proximal_m, leg.direction) + turned(distal_m, leg.direction + leg.elbow);
        LegParameters {
            base_m: joint - links,
            proximal_m,
            distal_m,
            joint_radius_m,
            joint_angle_rad: leg.lambda,
            // r1 x r2 = -sigma S.
            elbow: if leg.elbow < 0.0 {
                Elbow::Positive
            } else {
                Elbow::Negative
            },
            proximal: link(&leg.links[0], proximal_m),
            distal: link(&leg.links[1], distal_m),
            rotor_inertia_kgm2: if loads.rotors {
                leg.rotor * loads.mass * size * size
            } else {
                0.0
            },
        }
    });
    // Forces of the size of the platform's inertia.
    let force = loads.mass * size;
    let parameters = Parameters {
        legs,
        platform: PlatformParameters {
            mass_kg: loads.mass,
            inertia_kgm2: loads.mass * (loads.radius * size) * (loads.radius * size),
            com_m: Vector2::from(loads.com) * (0.3 * size),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: Vector2::from(loads.gravity) * size,
        wrench_force_n: Vector2::from(loads.force) * force,
        wrench_torque_nm: loads.moment * force * size,
    };
    let motion = |[x, y, alpha]: [f64; 3]| Vector3::new(x * size, y * size, alpha);
    Case {
        parameters,
        setpoint: Setpoint {
            pose: Pose::from_f64(position.x, position.y, state.angle),
            velocity: motion(state.velocity),
            acceleration: motion(state.acceleration),
        },
        size,
    }
}
