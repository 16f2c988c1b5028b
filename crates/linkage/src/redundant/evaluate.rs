//! One evaluation: motion, torques of the motors, forces of the sliders.

use super::machine::{RedundantLeg, RedundantMachine};
use nalgebra::{Vector2, Vector3};
use trirrr_core::inverse::{LegMotion, Rotation};
use trirrr_core::number::{Number, cross, dot, perpendicular};
use trirrr_core::reaction::JointForces;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::tick::Motor;
use trirrr_core::torque::links::InPlane;
use trirrr_core::torque::payload::Payload;

/// State of a slider along its guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderState<N> {
    /// Distance from the given place of the base joint, in the direction of the guide, m.
    pub position: N,
    /// m/s.
    pub velocity: N,
    /// m/s^2.
    pub acceleration: N,
}

impl<N: Number> SliderState<N> {
    /// Returns the state of a slider at rest at `position`, m.
    pub fn at(position: N) -> Self {
        Self {
            position,
            velocity: N::ZERO,
            acceleration: N::ZERO,
        }
    }
}

/// Load of the drive of one slider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderDrive<N> {
    /// Force of the drive on the carriage, N, positive in the direction of the guide.
    pub force: N,
    /// Power of the drive, W.
    pub power: N,
}

/// Motion and loads of a redundant machine at one setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RedundantMotion<N: Number, const LEGS: usize> {
    /// The motors. Angles are absolute: a slider does not turn.
    pub motors: [Motor<N>; LEGS],
    /// The sliders of the legs that have one.
    pub sliders: [Option<SliderDrive<N>>; LEGS],
    /// Motion of the links.
    pub legs: [LegMotion<N>; LEGS],
    /// f_i: force of distal link i on the platform over l2_i, N/m; a positive force pushes.
    pub distal_forces: [N; LEGS],
    /// The forces in the joints.
    pub joints: [JointForces<N>; LEGS],
    /// Scale-free distance to the parallel singularity.
    pub parallel: N,
}

impl<N: Number> RedundantLeg<N> {
    /// Returns the motion of the leg and the acceleration of its base joint.
    pub(super) fn motion(
        &self,
        index: usize,
        setpoint: &Setpoint<N>,
        rotation: &Rotation<N>,
        slider: &SliderState<N>,
    ) -> Result<(LegMotion<N>, Vector2<N>), Status> {
        let leg = self.placed(slider.position);
        let position = leg.position(index, setpoint.pose.position, rotation)?;
        let (v, a) = (
            self.slid(|| slider.velocity),
            self.slid(|| slider.acceleration),
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

impl<N: Number, const LEGS: usize> RedundantMachine<N, LEGS> {
    /// Computes motion and torques of the motors, and forces of the sliders, for the platform at
    /// `setpoint`.
    ///
    /// The entry of `sliders` of a leg without a slider is ignored. The torques are those nearest
    /// to `wanted`, N m; zeros give the torques of least norm.
    ///
    /// # Errors
    /// The [`Status`] of a setpoint without a motion. Every value returned is finite.
    pub fn evaluate(
        &self,
        setpoint: &Setpoint<N>,
        sliders: &[SliderState<N>; LEGS],
        wanted: &[N; LEGS],
    ) -> Result<RedundantMotion<N, LEGS>, Status> {
        let rotation = Rotation::new(setpoint.pose.angle);
        let moved = self.each(|index, leg| {
            let (motion, a) = leg.motion(index, setpoint, &rotation, &sliders[index])?;
            let gravity = self.gravity - a;
            let load = leg.inertia.load(&motion, &InPlane::new(gravity));
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
        let distal_forces =
            self.distribute_torques(&balance, &demand, &position, &at_motor, wanted);

        let torque =
            |leg: usize| position[leg].links.r1_cross_r2 * distal_forces[leg] + at_motor[leg];
        let motors = core::array::from_fn(|index| Motor {
            angle: self.legs[index]
                .leg
                .dyad()
                .proximal_angle(&position[index].links),
            rate: legs[index].rates.proximal,
            acceleration: legs[index].accelerations.proximal,
            torque: torque(index),
        });
        let joints: [JointForces<N>; LEGS] = core::array::from_fn(|index| {
            let (motion, load, gravity) = &moved[index];
            self.legs[index]
                .masses
                .forces(motion, distal_forces[index], load, *gravity)
        });
        let drives = core::array::from_fn(|index| {
            let (direction, mass) = self.legs[index].slider?;
            let carriage = sliders[index].acceleration - dot(self.gravity, direction);
            let force = dot(direction, joints[index].base) + mass * carriage;
            Some(SliderDrive {
                force,
                power: force * sliders[index].velocity,
            })
        });

        // A sum with a part that is not finite is not finite.
        let mut sum = N::ZERO;
        for (motor, joints) in motors.iter().zip(&joints) {
            let motor: &Motor<N> = motor;
            sum += motor.acceleration + motor.torque + joints.base.x + joints.base.y;
        }
        for slider in drives.iter().flatten() {
            let slider: &SliderDrive<N> = slider;
            sum += slider.force + slider.power;
        }
        if !sum.is_finite() {
            return Err(Status::OutOfRange);
        }
        Ok(RedundantMotion {
            motors,
            sliders: drives,
            legs,
            distal_forces,
            joints,
            parallel,
        })
    }
}
