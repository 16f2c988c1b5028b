//! One evaluation: motion, torques of the motors, forces of the sliders.

use super::machine::{Relative, RelativeLeg};
use crate::inverse::{LegMotion, Rotation};
use crate::number::{Number, cross, dot, perpendicular};
use crate::reaction::JointForces;
use crate::setpoint::Setpoint;
use crate::status::Status;
use crate::tick::Motor;
use crate::torque::links::InPlane;
use crate::torque::payload::Payload;
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

impl<N: Number> RelativeLeg<N> {
    /// The leg's motion and what its base joint is accelerated with.
    pub(super) fn motion(
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
        let rates = leg.rates(&position, &relative.velocity);
        let accelerations = leg.accelerations(&position, &rates, &relative);
        let motion = LegMotion {
            position,
            rates,
            accelerations,
        };
        Ok((motion, a))
    }
}

impl<N: Number, const LEGS: usize> Relative<N, LEGS> {
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
}
