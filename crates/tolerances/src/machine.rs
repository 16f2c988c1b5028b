//! The machine that was commanded, and the machine that is there.

use crate::coefficients::{AnyModel, BoxCoefficients, UncertainLeg};
use crate::model::BoxModel;
use crate::parameter::HalfWidths;
use nalgebra::{Vector2, Vector3};
use trirrr_core::dyad::{Accelerations, DyadPosition, Rates};
use trirrr_core::inverse::{LegMotion, LegPosition, Rotation};
use trirrr_core::machine::{BuildError, Geometry, Parameters};
use trirrr_core::number::{Arithmetic, WideArithmetic, cross, dot, perpendicular};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;

/// The machine of a scene with its tolerances.
pub(crate) struct UncertainMachine {
    nominal: Geometry<BoxModel>,
    legs: [UncertainLeg; 3],
    /// The core's pipeline with every coefficient over the box.
    tick: Tick<AnyModel>,
}

/// A leg as it is commanded.
pub(crate) struct CommandedLeg {
    motion: LegMotion<BoxModel>,
    /// Deviation of the platform joint from D, in the fixed frame, that turns with the platform.
    joint: Vector2<BoxModel>,
    /// A -> B with its deviation.
    r1: Vector2<BoxModel>,
    /// Deviation of the elbow B, in the fixed frame.
    elbow: Vector2<BoxModel>,
}

/// A leg where the platform is.
#[derive(Clone, Copy)]
pub(crate) struct RealLeg {
    /// D -> C.
    pub(crate) c: Vector2<BoxModel>,
    /// B -> C.
    pub(crate) r2: Vector2<BoxModel>,
    /// By how much B -> C differs from the commanded one.
    off: Vector2<BoxModel>,
}

impl UncertainMachine {
    /// # Errors
    /// The first quantity of the nominal machine that is refused.
    pub(crate) fn build(
        parameters: &Parameters,
        half_widths: &HalfWidths,
    ) -> Result<Self, BuildError> {
        let nominal = Geometry::<BoxModel>::build(parameters)?;
        let coefficients = BoxCoefficients {
            parameters,
            half_widths,
        };
        Ok(Self {
            nominal,
            legs: [0, 1, 2].map(|leg| coefficients.leg(leg)),
            tick: coefficients.tick(&nominal),
        })
    }

    /// The motion of the nominal machine for `setpoint`: what the motors are commanded.
    ///
    /// # Errors
    /// The status that leaves the setpoint, somewhere in the box, without a motion.
    pub(crate) fn commanded(
        &self,
        setpoint: &Setpoint<BoxModel>,
    ) -> Result<[CommandedLeg; 3], Status> {
        let rotation = Rotation::new(setpoint.pose.angle);
        let solve = |index: usize| {
            let (leg, uncertain) = (&self.nominal.legs()[index], &self.legs[index]);
            let position = leg.position(index, setpoint.pose.position, &rotation)?;
            let rates = leg.rates(&position, &setpoint.velocity);
            let accelerations = leg.accelerations(&position, &rates, setpoint);
            let r1 = position.links.r1;
            // r1 turned by the motor's error and stretched: (1 + stretch) R r1 - r1.
            let (sin, less) = sin_and_cos_less_one(uncertain.angle);
            let along = uncertain.stretch + (BoxModel::ONE + uncertain.stretch) * less;
            let across = (BoxModel::ONE + uncertain.stretch) * sin;
            let off = r1 * along + perpendicular(r1) * across;
            Ok(CommandedLeg {
                motion: LegMotion {
                    position,
                    rates,
                    accelerations,
                },
                joint: rotation.apply(uncertain.joint),
                r1: r1 + off,
                elbow: uncertain.base + off,
            })
        };
        Ok([solve(0)?, solve(1)?, solve(2)?])
    }

    /// The legs where the platform is off by `error` from the commanded pose. Every difference from the commanded
    /// machine is of the size of the tolerances, so that nothing of the machine's size cancels.
    pub(crate) fn real_legs(
        &self,
        commanded: &[CommandedLeg; 3],
        error: &Vector3<BoxModel>,
    ) -> [RealLeg; 3] {
        let (sin, less) = sin_and_cos_less_one(error.z);
        commanded.each_ref().map(|leg| {
            let position = &leg.motion.position;
            let c = position.platform_joint + leg.joint;
            let c_off = leg.joint + c * less + perpendicular(c) * sin;
            let off = error.xy() + c_off - leg.elbow;
            RealLeg {
                c: position.platform_joint + c_off,
                r2: position.links.r2 + off,
                off,
            }
        })
    }

    /// By how much the loops do not close: (r2^2 - l2^2) / 2 of each leg.
    pub(crate) fn residuals(
        &self,
        commanded: &[CommandedLeg; 3],
        real: &[RealLeg; 3],
    ) -> [BoxModel; 3] {
        [0, 1, 2].map(|leg| {
            let (r2, off) = (commanded[leg].motion.position.links.r2, real[leg].off);
            dot(r2, off) + BoxModel::HALF * dot(off, off) - self.legs[leg].half_distal_sq
        })
    }

    /// Torques of the motors when they turn as commanded, each off by a constant angle, and the legs stand as `real`.
    /// The platform's velocity and acceleration follow from those of the motors.
    ///
    /// # Errors
    /// [`Status::SerialSingular`] where the working mode of a leg is not certain, [`Status::ParallelSingular`],
    /// [`Status::OutOfRange`].
    pub(crate) fn torques(
        &self,
        pose: &Pose<BoxModel>,
        commanded: &[CommandedLeg; 3],
        real: &[RealLeg; 3],
    ) -> Result<[BoxModel; 3], Status> {
        let rows = real.map(|leg| jacobian_row(&leg));
        let r1 = commanded.each_ref().map(|leg| leg.r1);
        let crosses = [0, 1, 2].map(|leg| cross(r1[leg], real[leg].r2));
        let inverse_crosses = crosses.map(BoxModel::reciprocal);
        if let Some(leg) = inverse_crosses
            .iter()
            .position(|inverse| !inverse.is_finite())
        {
            return Err(Status::SerialSingular { leg });
        }
        let motors = commanded
            .each_ref()
            .map(|leg| (leg.motion.rates.proximal, leg.motion.accelerations.proximal));
        // r2 . (v + E c w) = r2 . E r1 rate
        let velocity = solve(&rows, [0, 1, 2].map(|leg| crosses[leg] * motors[leg].0));
        // Of r2: the difference of the velocities of C and B, which is at right angles to r2.
        let turning = [0, 1, 2].map(|leg| {
            velocity.xy() + perpendicular(real[leg].c) * velocity.z
                - perpendicular(r1[leg]) * motors[leg].0
        });
        let rates = [0, 1, 2]
            .map(|leg| cross(real[leg].r2, turning[leg]) * self.legs[leg].inverse_distal_sq);
        // The same, once more derived.
        let centripetal = velocity.z * velocity.z;
        let right = [0, 1, 2].map(|leg| {
            let (rate, acceleration) = motors[leg];
            crosses[leg] * acceleration - dot(turning[leg], turning[leg])
                + dot(real[leg].r2, real[leg].c) * centripetal
                - dot(real[leg].r2, r1[leg]) * (rate * rate)
        });
        let acceleration = solve(&rows, right);
        let legs = [0, 1, 2].map(|leg| {
            let (c, r2, r1) = (real[leg].c, real[leg].r2, r1[leg]);
            let (rate, angular) = motors[leg];
            let of_c = acceleration.xy() + perpendicular(c) * acceleration.z - c * centripetal;
            let of_b = perpendicular(r1) * angular - r1 * (rate * rate);
            LegMotion {
                position: LegPosition {
                    platform_joint: c,
                    links: DyadPosition {
                        r1,
                        r2,
                        r1_cross_r2: crosses[leg],
                        inverse_cross: inverse_crosses[leg],
                        r1_dot_r2: dot(r1, r2),
                    },
                },
                rates: Rates {
                    proximal: rate,
                    distal: rates[leg],
                },
                accelerations: Accelerations {
                    proximal: angular,
                    distal: cross(r2, of_c - of_b) * self.legs[leg].inverse_distal_sq,
                },
            }
        });
        let setpoint = Setpoint {
            pose: *pose,
            velocity,
            acceleration,
        };
        self.tick
            .torques(&legs, &setpoint, &Rotation::new(pose.angle))
    }
}

impl CommandedLeg {
    /// Rate that the motor is commanded.
    pub(crate) fn rate(&self) -> BoxModel {
        self.motion.rates.proximal
    }
}

/// Derivatives of a leg's residual by x, y and alpha: [r2, c x r2], a row of A.
pub(crate) fn jacobian_row(leg: &RealLeg) -> Vector3<BoxModel> {
    Vector3::new(leg.r2.x, leg.r2.y, cross(leg.c, leg.r2))
}

/// sin(angle) and cos(angle) - 1; the latter from half the angle, so that small angles keep their digits.
fn sin_and_cos_less_one(angle: BoxModel) -> (BoxModel, BoxModel) {
    let (sin, _) = BoxModel::sin_cos(angle);
    let (half, _) = BoxModel::sin_cos(BoxModel::HALF * angle);
    (sin, -((half + half) * half))
}

/// Solves three equations by Cramer's rule; where the determinant may be zero, nothing is known of the solution.
fn solve(rows: &[Vector3<BoxModel>; 3], right: [BoxModel; 3]) -> Vector3<BoxModel> {
    let [a, b, c] = rows;
    let (b_c, c_a, a_b) = (b.cross(c), c.cross(a), a.cross(b));
    let determinant = a.x * b_c.x + a.y * b_c.y + a.z * b_c.z;
    let inverse = BoxModel::ONE.div(determinant);
    (b_c * right[0] + c_a * right[1] + a_b * right[2]) * inverse
}
