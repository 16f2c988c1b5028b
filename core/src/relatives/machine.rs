//! A relative, built and evaluated.

use super::factor::Factors;
use super::parameters::RelativeParameters;
use crate::inverse::{LegMotion, LegPosition, Rotation};
use crate::linkage::rrr::{Accelerations, Rates};
use crate::machine::{BuildError, Geometry, Leg};
use crate::number::{Number, cross, dot, perpendicular};
use crate::reaction::{JointForces, LegMasses};
use crate::setpoint::{Pose, Setpoint};
use crate::singularity::greatest_det_a;
use crate::status::Status;
use crate::tick::Motor;
use crate::torque::links::{InPlane, MassiveLeg};
use crate::torque::payload::{Demand, Offset, Payload};
use nalgebra::{Vector2, Vector3};

/// Position, velocity and acceleration of a slider along its guide, m, m/s, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along<N> {
    /// From where the leg's base joint is given, in the direction of the guide.
    pub position: N,
    /// Its rate.
    pub velocity: N,
    /// The rate of that.
    pub acceleration: N,
}

impl<N: Number> Along<N> {
    /// A slider at rest at `position`.
    pub fn at(position: N) -> Self {
        Self {
            position,
            velocity: N::ZERO,
            acceleration: N::ZERO,
        }
    }
}

/// A relative with its coefficients, immutable once built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative<N, const LEGS: usize> {
    legs: [RelativeLeg<N>; LEGS],
    payload: Offset<N>,
    gravity: Vector2<N>,
    /// What moments are divided by where they stand beside forces.
    arm: N,
    /// The size that the volume of A cannot exceed.
    greatest: N,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct RelativeLeg<N> {
    leg: Leg<N>,
    inertia: MassiveLeg<N>,
    masses: LegMasses<N>,
    /// u and the mass of the carriage.
    slider: Option<(Vector2<N>, N)>,
    /// 1 / (l1 l2)
    serial: N,
}

/// What one slider's drive has to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderDrive<N> {
    /// Force of the drive on the carriage, N, positive in the direction of the guide.
    pub force: N,
    /// Its power, W.
    pub power: N,
}

/// One evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeMotion<N: Number, const LEGS: usize> {
    /// The motors. Angles are absolute: a slider does not turn.
    pub motors: [Motor<N>; LEGS],
    /// The sliders of the legs that have one.
    pub sliders: [Option<SliderDrive<N>>; LEGS],
    /// How the links move.
    pub legs: [LegMotion<N>; LEGS],
    /// f_i: force along distal link i on the platform over l2_i; positive pushes.
    pub along: [N; LEGS],
    /// The forces in the joints.
    pub joints: [JointForces<N>; LEGS],
    /// Scale-free distance to the parallel singularity.
    pub parallel: N,
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
    fn slid(&self, along: impl FnOnce() -> N) -> Vector2<N> {
        match &self.slider {
            Some((direction, _)) => direction * along(),
            None => Vector2::new(N::ZERO, N::ZERO),
        }
    }

    /// The leg with its base joint where `along` has it.
    fn placed(&self, along: N) -> Leg<N> {
        Leg {
            base: self.leg.base + self.slid(|| along),
            ..self.leg
        }
    }

    /// The leg's motion and what its base joint is accelerated with.
    fn motion(
        &self,
        index: usize,
        setpoint: &Setpoint<N>,
        rotation: &Rotation<N>,
        along: &Along<N>,
    ) -> Result<(LegMotion<N>, Vector2<N>), Status> {
        let leg = self.placed(along.position);
        let position = leg.position(index, setpoint.pose.position, rotation)?;
        let (v, a) = (
            self.slid(|| along.velocity),
            self.slid(|| along.acceleration),
        );
        // The platform seen from the base joint.
        let planar = |v: Vector2<N>| Vector3::new(v.x, v.y, N::ZERO);
        let relative = Setpoint {
            pose: setpoint.pose,
            velocity: setpoint.velocity - planar(v),
            acceleration: setpoint.acceleration - planar(a),
        };
        let rates: Rates<N> = leg.rates(&position, &relative.velocity);
        let accelerations: Accelerations<N> = leg.accelerations(&position, &rates, &relative);
        let motion = LegMotion {
            position,
            rates,
            accelerations,
        };
        Ok((motion, a))
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

    /// Angles, rates, accelerations and torques of the motors, and forces of the sliders, for the
    /// platform at `setpoint` and the sliders at `along` (ignored for a leg without). The torques
    /// are those nearest to `wanted`, N m: all zero for the least norm.
    ///
    /// # Errors
    /// The [`Status`] that leaves the setpoint without a motion. A motion that is returned holds
    /// no infinity and nothing that is not a number.
    pub fn evaluate(
        &self,
        setpoint: &Setpoint<N>,
        along: &[Along<N>; LEGS],
        wanted: &[N; LEGS],
    ) -> Result<RelativeMotion<N, LEGS>, Status> {
        let rotation = Rotation::new(setpoint.pose.angle);
        let moved = self.each(|index, leg| {
            let (motion, a) = leg.motion(index, setpoint, &rotation, &along[index])?;
            let gravity = self.gravity - a;
            let load = leg.inertia.load(&leg.leg.dyad, &motion, &InPlane(gravity));
            Ok((motion, load, gravity))
        })?;
        let legs = moved.each_ref().map(|moved| moved.0);
        let position = legs.each_ref().map(|leg| leg.position);
        let balance = self.balance(&position);
        let parallel = self.parallel(&balance);
        // The rows of A are rounded at the size of the links.
        if !(parallel > N::UNIT_ROUNDOFF + N::UNIT_ROUNDOFF) {
            return Err(Status::ParallelSingular);
        }

        let mut demand = self.payload.demand(setpoint, &rotation);
        let c1 = position[0].platform_joint;
        demand.moment -= cross(c1, demand.force);
        for (motion, load, _) in &moved {
            if let Some(q) = load.distal_over_l2_sq {
                let (c, r2) = (motion.position.platform_joint, motion.position.links.r2);
                demand.force += perpendicular(r2) * q;
                demand.moment += dot(c - c1, r2) * q;
            }
        }
        let at_motor = moved
            .each_ref()
            .map(|(_, load, _)| load.at_motor.unwrap_or(N::ZERO));
        let along_links = self.share(&balance, &demand, &position, &at_motor, wanted);

        let torque =
            |leg: usize| position[leg].links.r1_cross_r2 * along_links[leg] + at_motor[leg];
        let motors = core::array::from_fn(|index| Motor {
            angle: self.legs[index]
                .leg
                .dyad
                .proximal_angle(&position[index].links),
            rate: legs[index].rates.proximal,
            acceleration: legs[index].accelerations.proximal,
            torque: torque(index),
        });
        let joints: [JointForces<N>; LEGS] = core::array::from_fn(|index| {
            let (motion, load, gravity) = &moved[index];
            self.legs[index]
                .masses
                .forces(motion, along_links[index], load, *gravity)
        });
        let sliders = core::array::from_fn(|index| {
            let (direction, mass) = self.legs[index].slider?;
            let carriage = along[index].acceleration - dot(self.gravity, direction);
            let force = dot(direction, joints[index].base) + mass * carriage;
            Some(SliderDrive {
                force,
                power: force * along[index].velocity,
            })
        });

        // A sum with a part that is not finite is not finite.
        let mut sum = N::ZERO;
        for (motor, joints) in motors.iter().zip(&joints) {
            let motor: &Motor<N> = motor;
            sum += motor.acceleration + motor.torque + joints.base.x + joints.base.y;
        }
        for slider in sliders.iter().flatten() {
            let slider: &SliderDrive<N> = slider;
            sum += slider.force + slider.power;
        }
        if !sum.is_finite() {
            return Err(Status::OutOfRange);
        }
        Ok(RelativeMotion {
            motors,
            sliders,
            legs,
            along: along_links,
            joints,
            parallel,
        })
    }

    /// `of_leg` of every leg, or the first failure.
    fn each<T: Copy>(
        &self,
        mut of_leg: impl FnMut(usize, &RelativeLeg<N>) -> Result<T, Status>,
    ) -> Result<[T; LEGS], Status> {
        let mut all = [of_leg(0, &self.legs[0])?; LEGS];
        for (index, leg) in self.legs.iter().enumerate().skip(1) {
            all[index] = of_leg(index, leg)?;
        }
        Ok(all)
    }

    /// The matrix with rows [r2x, r2y, (c - c1) x r2 / arm].
    fn balance(&self, position: &[LegPosition<N>; LEGS]) -> Factors<N, LEGS> {
        let c1 = position[0].platform_joint;
        let mut columns = [[N::ZERO; LEGS]; LEGS];
        for (index, leg) in position.iter().enumerate() {
            let r2 = leg.links.r2;
            columns[0][index] = r2.x;
            columns[1][index] = r2.y;
            columns[2][index] = cross(leg.platform_joint - c1, r2).div(self.arm);
        }
        Factors::new(columns, 3)
    }

    fn parallel(&self, balance: &Factors<N, LEGS>) -> N {
        if self.greatest > N::ZERO {
            (balance.volume() * self.arm).div(self.greatest)
        } else {
            N::ZERO
        }
    }

    /// The forces along the distal links that hold `demand` with motor torques nearest to `wanted`.
    fn share(
        &self,
        balance: &Factors<N, LEGS>,
        demand: &Demand<N>,
        position: &[LegPosition<N>; LEGS],
        at_motor: &[N; LEGS],
        wanted: &[N; LEGS],
    ) -> [N; LEGS] {
        let mut w = [N::ZERO; LEGS];
        w[0] = demand.force.x;
        w[1] = demand.force.y;
        w[2] = demand.moment.div(self.arm);
        let mut forces = balance.least_norm(&w);
        let spare = LEGS - 3;
        if spare == 0 {
            return forces;
        }
        // Forces that hold each other, and the torques that they take.
        let held = |index: usize| {
            let mut unit = [N::ZERO; LEGS];
            unit[3 + index] = N::ONE;
            balance.of_q(unit)
        };
        let torques = |forces: &[N; LEGS]| -> [N; LEGS] {
            core::array::from_fn(|leg| position[leg].links.r1_cross_r2 * forces[leg])
        };
        let mut taken = [[N::ZERO; LEGS]; LEGS];
        for (index, column) in taken.iter_mut().enumerate().take(spare) {
            *column = torques(&held(index));
        }
        let base = torques(&forces);
        let missing = core::array::from_fn(|leg| wanted[leg] - at_motor[leg] - base[leg]);
        let z = Factors::new(taken, spare).least_squares(missing);
        for (index, &z) in z.iter().enumerate().take(spare) {
            for (force, held) in forces.iter_mut().zip(held(index)) {
                *force += held * z;
            }
        }
        forces
    }
}

#[cfg(test)]
mod tests;
