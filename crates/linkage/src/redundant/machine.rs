//! Coefficients of a redundant machine, position of its joints, distances to singularities.

use super::parameters::RedundantParameters;
use crate::motion::unit;
use nalgebra::Vector2;
use trirrr_core::inverse::{LegPosition, Rotation};
use trirrr_core::machine::{BuildError, Geometry, Leg};
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::reaction::LegMasses;
use trirrr_core::setpoint::Pose;
use trirrr_core::status::Status;
use trirrr_core::torque::links::MassiveLeg;
use trirrr_core::torque::payload::{Offset, Payload};

/// Redundant machine with its coefficients, immutable once built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RedundantMachine<N: Number, const LEGS: usize> {
    pub(super) legs: [RedundantLeg<N>; LEGS],
    pub(super) payload: Offset<N>,
    pub(super) gravity: Vector2<N>,
    /// Length that makes moments comparable with forces, m.
    pub(super) arm: N,
    /// Upper bound of the volume of A.
    pub(super) greatest: N,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RedundantLeg<N: Number> {
    pub(super) leg: Leg<N>,
    pub(super) inertia: MassiveLeg<N>,
    pub(super) masses: LegMasses<N>,
    /// Direction u of the guide and mass of the carriage.
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

impl<N: Number> RedundantLeg<N> {
    pub(super) fn slid(&self, slider: impl FnOnce() -> N) -> Vector2<N> {
        match &self.slider {
            Some((direction, _)) => direction * slider(),
            None => Vector2::new(N::ZERO, N::ZERO),
        }
    }

    /// Returns the leg with its base joint at the slider position `slider`.
    pub(super) fn placed(&self, slider: N) -> Leg<N> {
        self.leg.at(self.leg.base() + self.slid(|| slider))
    }
}

impl<N: Number, const LEGS: usize> RedundantMachine<N, LEGS> {
    /// Checks `parameters` and builds the coefficients, in `f64`, each rounded once.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn build(parameters: &RedundantParameters<LEGS>) -> Result<Self, BuildError> {
        const { assert!(LEGS >= 3, "three legs hold a platform") };
        parameters.check::<N>()?;
        let first = Geometry::build(&parameters.three([0, 1, 2]))?.legs()[0];
        let leg = |index: usize| {
            let given = &parameters.legs[index];
            let leg =
                Geometry::build(&parameters.three([index; 3])).map_or(first, |it| it.legs()[0]);
            RedundantLeg {
                leg,
                inertia: MassiveLeg::build(given),
                masses: LegMasses::build(given),
                slider: parameters.sliders[index].map(|slider| {
                    let direction = unit(slider.direction_rad).map(N::from_f64);
                    (direction, N::from_f64(slider.mass_kg))
                }),
                serial: N::from_f64(1.0 / (given.proximal_m * given.distal_m)),
            }
        };
        let mut sum = 0.0;
        for third in 2..LEGS {
            for second in 1..third {
                for first in 0..second {
                    let greatest = parameters.three([first, second, third]).greatest_det_a();
                    sum += greatest * greatest;
                }
            }
        }
        let joint = |index: usize| {
            let leg = &parameters.legs[index];
            unit(leg.joint_angle_rad) * leg.joint_radius_m
        };
        let arm = (1..LEGS).fold(0.0, |arm, leg| {
            let offset: Vector2<f64> = joint(leg) - joint(0);
            f64::max(
                arm,
                Arithmetic::sqrt(offset.x * offset.x + offset.y * offset.y),
            )
        });
        Ok(Self {
            legs: core::array::from_fn(leg),
            payload: Offset::build(Offset::<N>::KIND, &parameters.three([0, 1, 2])),
            gravity: parameters.gravity_m_s2.map(N::from_f64),
            // Joints in one point hold no moment, however it is scaled.
            arm: N::from_f64(if arm > 0.0 { arm } else { 1.0 }),
            greatest: N::from_f64(Arithmetic::sqrt(sum)),
        })
    }

    /// Solves the joints for `pose`, with the sliders at `sliders`, m. The entry of a leg without a
    /// slider is ignored.
    ///
    /// # Errors
    /// [`Status::Unreachable`] or [`Status::SerialSingular`] with the first leg concerned.
    pub fn position(
        &self,
        pose: &Pose<N>,
        sliders: &[N; LEGS],
    ) -> Result<[LegPosition<N>; LEGS], Status> {
        let rotation = Rotation::new(pose.angle);
        self.each(|index, leg| {
            leg.placed(sliders[index])
                .position(index, pose.position, &rotation)
        })
    }

    /// Returns the scale-free distances from the singularities.
    ///
    /// # Errors
    /// As [`position`](Self::position).
    pub fn distances(
        &self,
        pose: &Pose<N>,
        sliders: &[N; LEGS],
    ) -> Result<Distances<N, LEGS>, Status> {
        let position = self.position(pose, sliders)?;
        let serial = |leg: usize| {
            let links = &position[leg].links;
            (links.r1_cross_r2 * self.legs[leg].serial).abs()
        };
        Ok(Distances {
            serial: core::array::from_fn(serial),
            parallel: self.parallel(&self.balance(&position)),
        })
    }

    /// Applies `of_leg` to every leg; stops at the first failure.
    pub(super) fn each<T: Copy>(
        &self,
        mut of_leg: impl FnMut(usize, &RedundantLeg<N>) -> Result<T, Status>,
    ) -> Result<[T; LEGS], Status> {
        let mut all = [of_leg(0, &self.legs[0])?; LEGS];
        for (index, leg) in self.legs.iter().enumerate().skip(1) {
            all[index] = of_leg(index, leg)?;
        }
        Ok(all)
    }
}
