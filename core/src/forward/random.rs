//! Random machines with a pose that closes, and a count of assembly modes that shares nothing with
//! the polynomial: for the tests of this folder.

use super::Forward;
use crate::machine::{
    Elbow, Geometry, LegParameters, LinkParameters, Parameters, PlatformParameters,
};
use crate::setpoint::Pose;
use nalgebra::Vector2;
use proptest::array::uniform3;
use proptest::prelude::*;
use std::vec::Vec;

/// A machine, a pose of it and its motor angles there.
#[derive(Clone, Debug)]
pub(super) struct Closed {
    pub(super) parameters: Parameters,
    pub(super) pose: [f64; 3],
    pub(super) angles: [f64; 3],
}

impl Closed {
    pub(super) fn forward(&self) -> Forward<f64> {
        let geometry = Geometry::build(&self.parameters).unwrap();
        Forward::build(&self.parameters, &geometry)
    }

    /// Length at which the places of the joints are rounded.
    pub(super) fn reach(&self) -> f64 {
        let legs = self.parameters.legs.iter();
        legs.fold(0.0, |reach, leg| {
            let to_base = leg.base_m.x.hypot(leg.base_m.y);
            reach.max(to_base + leg.proximal_m + leg.distal_m + leg.joint_radius_m)
        })
    }

    /// The machine and its angles, rounded to `f32`.
    pub(super) fn in_f32(mut self) -> Self {
        let rounded = |x: f64| f64::from(x as f32);
        for leg in &mut self.parameters.legs {
            leg.base_m = leg.base_m.map(rounded);
            leg.proximal_m = rounded(leg.proximal_m);
            leg.distal_m = rounded(leg.distal_m);
            leg.joint_radius_m = rounded(leg.joint_radius_m);
            leg.joint_angle_rad = rounded(leg.joint_angle_rad);
        }
        self.angles = self.angles.map(rounded);
        self
    }

    pub(super) fn pose(&self) -> Pose<f64> {
        Pose::from_f64(self.pose[0], self.pose[1], self.pose[2])
    }
}

pub(super) fn turned(length: f64, angle: f64) -> Vector2<f64> {
    Vector2::new(length * angle.cos(), length * angle.sin())
}

/// The machine whose legs, given by l1, l2, h, lambda and the angles of both links, meet at `pose`.
pub(super) fn closed(pose: [f64; 3], legs: [[f64; 6]; 3]) -> Closed {
    let mut angles = [0.0; 3];
    let mut index = 0;
    let legs = legs.map(|[l1, l2, h, lambda, theta1, theta2]| {
        let joint = Vector2::new(pose[0], pose[1]) + turned(h, lambda + pose[2]);
        angles[index] = theta1;
        index += 1;
        LegParameters {
            base_m: joint - turned(l1, theta1) - turned(l2, theta2),
            proximal_m: l1,
            distal_m: l2,
            joint_radius_m: h,
            joint_angle_rad: lambda,
            elbow: Elbow::Positive,
            proximal: LinkParameters::default(),
            distal: LinkParameters::default(),
            rotor_inertia_kgm2: 0.0,
        }
    });
    let parameters = Parameters {
        legs,
        platform: PlatformParameters {
            mass_kg: 1.0,
            inertia_kgm2: 1.0,
            com_m: Vector2::new(0.0, 0.0),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: Vector2::new(0.0, 0.0),
        wrench_force_n: Vector2::new(0.0, 0.0),
        wrench_torque_nm: 0.0,
    };
    Closed {
        parameters,
        pose,
        angles,
    }
}

/// Links of 0.1 to 1, platforms from a tenth of a link to three of them.
pub(super) fn any() -> impl Strategy<Value = Closed> {
    let turn = -3.1..3.1f64;
    let leg = (
        0.1..1.0f64,
        0.1..1.0f64,
        0.05..1.0f64,
        turn.clone(),
        turn.clone(),
        turn.clone(),
    );
    let place = -1.0..1.0f64;
    (place.clone(), place, turn, uniform3(leg), 0.2..3.0f64).prop_map(
        |(x, y, alpha, legs, platform)| {
            let legs = legs.map(|(l1, l2, h, lambda, theta1, theta2)| {
                [l1, l2, h * platform, lambda, theta1, theta2]
            });
            closed([x, y, alpha], legs)
        },
    )
}

/// Machines whose pose is nearly a parallel singularity: the distal lines of the three legs miss one
/// point by an angle of 1e-7 to 1e-2 rad. All numbers are those of an `f32`.
pub(super) fn nearly_double() -> impl Strategy<Value = Closed> {
    let meet = (-2.0..2.0f64, -2.0..2.0f64);
    let off = (-7.0..-2.0f64, proptest::bool::ANY);
    (any(), meet, off).prop_map(|(case, meet, (decades, left))| {
        let [x, y, alpha] = case.pose;
        let off = 10f64.powf(decades) * if left { -1.0 } else { 1.0 };
        let mut index = 0;
        let legs = case.parameters.legs.map(|leg| {
            let joint =
                Vector2::new(x, y) + turned(leg.joint_radius_m, leg.joint_angle_rad + alpha);
            let theta2 = (meet.1 - joint.y).atan2(meet.0 - joint.x);
            let theta1 = case.angles[index];
            index += 1;
            let theta2 = if index == 3 { theta2 + off } else { theta2 };
            let (h, lambda) = (leg.joint_radius_m, leg.joint_angle_rad);
            [leg.proximal_m, leg.distal_m, h, lambda, theta1, theta2]
        });
        closed(case.pose, legs).in_f32()
    })
}

/// Counts the modes by walking `cells` platform angles round the circle. D is an intersection of
/// the circles of legs 0 and 1; on both branches, which meet where the circles touch, the length
/// error of leg 2 changes sign at a mode.
pub(super) fn scan(case: &Closed, cells: usize) -> usize {
    let elbow = |leg: usize| {
        let leg_parameters = &case.parameters.legs[leg];
        leg_parameters.base_m + turned(leg_parameters.proximal_m, case.angles[leg])
    };
    let errors = |cell: usize| -> Option<[bool; 2]> {
        let alpha = core::f64::consts::TAU * (cell as f64 + 0.5) / cells as f64;
        let centre = |index: usize| {
            let leg = &case.parameters.legs[index];
            elbow(index) - turned(leg.joint_radius_m, leg.joint_angle_rad + alpha)
        };
        let l = |leg: usize| case.parameters.legs[leg].distal_m;
        let to_second = centre(1) - centre(0);
        let d = to_second.x.hypot(to_second.y);
        let cos = (d * d + l(0) * l(0) - l(1) * l(1)) / (2.0 * d * l(0));
        (cos.abs() < 1.0).then(|| {
            [1.0, -1.0].map(|side| {
                let direction = to_second.y.atan2(to_second.x) + side * cos.acos();
                let to_third = centre(0) + turned(l(0), direction) - centre(2);
                to_third.x.hypot(to_third.y) > l(2)
            })
        })
    };
    let errors: Vec<_> = (0..cells).map(errors).collect();
    (0..cells)
        .map(|cell| {
            let next = errors[(cell + 1) % cells];
            match (errors[cell], next) {
                (Some(here), Some(there)) => (0..2).filter(|&b| here[b] != there[b]).count(),
                // Where the branches meet, a difference between them is a mode on the way round.
                (Some([plus, minus]), None) | (None, Some([plus, minus])) => {
                    usize::from(plus != minus)
                }
                (None, None) => 0,
            }
        })
        .sum()
}

/// Part of `cases` that a build without optimisation takes, at least one: all of them are for `cargo xtask nightly`, which
/// optimises.
pub(crate) const fn share(cases: u32) -> u32 {
    match cfg!(debug_assertions) {
        true => cases.div_ceil(10),
        false => cases,
    }
}

/// Runs `check` on `cases` values, the same in every run.
pub(crate) fn deterministic<S: Strategy>(cases: u32, strategy: S, check: impl Fn(S::Value)) {
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
