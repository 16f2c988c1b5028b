//! A relative: its coefficients, its position, its distances to singularities.

use super::parameters::RelativeParameters;
use crate::inverse::{LegPosition, Rotation};
use crate::machine::{BuildError, Geometry, Leg};
use crate::number::Number;
use crate::reaction::LegMasses;
use crate::setpoint::Pose;
use crate::singularity::greatest_det_a;
use crate::status::Status;
use crate::torque::links::MassiveLeg;
use crate::torque::payload::{Offset, Payload};
use nalgebra::Vector2;

/// A relative with its coefficients, immutable once built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative<N: Number, const LEGS: usize> {
    pub(super) legs: [RelativeLeg<N>; LEGS],
    pub(super) payload: Offset<N>,
    pub(super) gravity: Vector2<N>,
    /// What moments are divided by where they stand beside forces.
    pub(super) arm: N,
    /// The size that the volume of A cannot exceed.
    pub(super) greatest: N,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RelativeLeg<N: Number> {
    pub(super) leg: Leg<N>,
    pub(super) inertia: MassiveLeg<N>,
    pub(super) masses: LegMasses<N>,
    /// u and the mass of the carriage.
    pub(super) slider: Option<(Vector2<N>, N)>,
    /// 1 / (l1 l2)
    serial: N,
}

/// Scale-free distances to the singularities: 0 there, at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances<N, const LEGS: usize> {
    /// Of each leg: |r1 x r2| / (l1 l2).
    pub serial: [N; LEGS],
    /// sqrt(det A^T A), over the root of the sum of squares of the greatest |det A| of any three
    /// legs. With three legs it is that of the 3-RRR; with more it is zero only where all three
    /// of any legs are singular.
    pub parallel: N,
}

impl<N: Number> RelativeLeg<N> {
    pub(super) fn slid(&self, along: impl FnOnce() -> N) -> Vector2<N> {
        match &self.slider {
            Some((direction, _)) => direction * along(),
            None => Vector2::new(N::ZERO, N::ZERO),
        }
    }

    /// The leg with its base joint where `along` has it.
    pub(super) fn placed(&self, along: N) -> Leg<N> {
        Leg {
            base: self.leg.base + self.slid(|| along),
            ..self.leg
        }
    }
}

impl<N: Number, const LEGS: usize> Relative<N, LEGS> {
    /// Checks `parameters` and builds the coefficients, in `f64`, each rounded once.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn build(parameters: &RelativeParameters<LEGS>) -> Result<Self, BuildError> {
        const { assert!(LEGS >= 3, "three legs hold a platform") };
        parameters.check::<N>()?;
        let first = Geometry::build(&parameters.three([0, 1, 2]))?.legs[0];
        let leg = |index: usize| {
            let given = &parameters.legs[index];
            let leg = Geometry::build(&parameters.three([index; 3])).map_or(first, |it| it.legs[0]);
            RelativeLeg {
                leg,
                inertia: MassiveLeg::build(given),
                masses: LegMasses::build(given),
                slider: parameters.sliders[index].map(|slider| {
                    let (sin, cos) = f64::sin_cos(slider.direction_rad);
                    let direction = Vector2::new(N::from_f64(cos), N::from_f64(sin));
                    (direction, N::from_f64(slider.mass_kg))
                }),
                serial: N::from_f64(1.0 / (given.proximal_m * given.distal_m)),
            }
        };
        let mut sum = 0.0;
        for third in 2..LEGS {
            for second in 1..third {
                for first in 0..second {
                    let greatest = greatest_det_a(&parameters.three([first, second, third]));
                    sum += greatest * greatest;
                }
            }
        }
        let joint = |index: usize| {
            let leg = &parameters.legs[index];
            let (sin, cos) = f64::sin_cos(leg.joint_angle_rad);
            Vector2::new(cos, sin) * leg.joint_radius_m
        };
        let arm = (1..LEGS).fold(0.0, |arm, leg| {
            let apart: Vector2<f64> = joint(leg) - joint(0);
            f64::max(arm, Number::sqrt(apart.x * apart.x + apart.y * apart.y))
        });
        Ok(Self {
            legs: core::array::from_fn(leg),
            payload: Offset::build(&parameters.three([0, 1, 2])),
            gravity: parameters.gravity_m_s2.map(N::from_f64),
            // Joints in one point hold no moment, however it is scaled.
            arm: N::from_f64(if arm > 0.0 { arm } else { 1.0 }),
            greatest: N::from_f64(Number::sqrt(sum)),
        })
    }

    /// Where the joints are for `pose`, with the sliders at `along` (ignored for a leg without).
    ///
    /// # Errors
    /// [`Status::Unreachable`] or [`Status::SerialSingular`] with the first leg concerned.
    pub fn position(
        &self,
        pose: &Pose<N>,
        along: &[N; LEGS],
    ) -> Result<[LegPosition<N>; LEGS], Status> {
        let rotation = Rotation::new(pose.angle);
        self.each(|index, leg| {
            leg.placed(along[index])
                .position(index, pose.position, &rotation)
        })
    }

    /// How far the machine is from its singularities.
    ///
    /// # Errors
    /// As [`position`](Self::position).
    pub fn distances(
        &self,
        pose: &Pose<N>,
        along: &[N; LEGS],
    ) -> Result<Distances<N, LEGS>, Status> {
        let position = self.position(pose, along)?;
        let serial = |leg: usize| {
            let links = &position[leg].links;
            (links.r1_cross_r2 * self.legs[leg].serial).abs()
        };
        Ok(Distances {
            serial: core::array::from_fn(serial),
            parallel: self.parallel(&self.balance(&position)),
        })
    }

    /// `of_leg` of every leg, or the first failure.
    pub(super) fn each<T: Copy>(
        &self,
        mut of_leg: impl FnMut(usize, &RelativeLeg<N>) -> Result<T, Status>,
    ) -> Result<[T; LEGS], Status> {
        let mut all = [of_leg(0, &self.legs[0])?; LEGS];
        for (index, leg) in self.legs.iter().enumerate().skip(1) {
            all[index] = of_leg(index, leg)?;
        }
        Ok(all)
    }
}
