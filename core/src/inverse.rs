//! Inverse kinematics: motion of the legs for a pose, velocity and acceleration of the platform.
//!
//! [`Leg`] has three stages, each of which uses the results before it. The tick solves one leg at a
//! time, so that few values are alive at once.
//!
//! | stage | thesis, corrected |
//! |---|---|
//! | position, by vectors | (3.2) to (3.9) |
//! | joint rates | (3.11) to (3.14) |
//! | joint accelerations | (3.17) to (3.21) |

use crate::dyad::{Accelerations, DyadPosition, OutOfReach, Rates, Rrr};
use crate::machine::{Geometry, Leg};
use crate::number::Number;
use crate::setpoint::{Pose, Setpoint};
use crate::status::Status;
use nalgebra::{Vector2, Vector3};

/// The platform's rotation, resolved once for the three legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<N> {
    sin: N,
    cos: N,
}

/// Places of the joints of one leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegPosition<N: Number> {
    /// c: from the platform's reference point D to the platform joint C, in the fixed frame.
    pub platform_joint: Vector2<N>,
    /// The two links.
    pub links: DyadPosition<N>,
}

/// Places of the joints of all legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<N: Number> {
    /// The three legs.
    pub legs: [LegPosition<N>; 3],
}

impl<N: Number> Rotation<N> {
    /// The rotation by `angle`.
    #[inline(always)]
    pub fn new(angle: N::Angle) -> Self {
        let (sin, cos) = N::sin_cos(angle);
        Self { sin, cos }
    }

    /// `v`, given in the platform's frame, in the fixed frame.
    #[inline(always)]
    pub fn apply(&self, v: Vector2<N>) -> Vector2<N> {
        Vector2::new(
            N::ab_minus_cd(v.x, self.cos, v.y, self.sin),
            N::ab_plus_cd(v.y, self.cos, v.x, self.sin),
        )
    }
}

impl<N: Number> Geometry<N> {
    /// Solves the three legs for `pose`. One sine and cosine serve all three.
    ///
    /// # Errors
    /// [`Status::Unreachable`] or [`Status::SerialSingular`] with the first leg concerned;
    /// [`Status::OutOfRange`] where a leg with two equal links is folded so far that its division
    /// by d^2 leaves the number type.
    #[inline]
    pub fn position(&self, pose: &Pose<N>) -> Result<Position<N>, Status> {
        if !(N::within_reach_range(pose.position.x) && N::within_reach_range(pose.position.y)) {
            return Err(Status::OutOfRange);
        }
        let rotation = Rotation::new(pose.angle);
        let solve = |index: usize| {
            let leg = self.legs[index].position(index, pose.position, &rotation)?;
            // The tick itself checks its results instead, once, at its end.
            // Each by itself: in fixed point the sum of what is in range need not be.
            let (r1, r2) = (leg.links.r1, leg.links.r2);
            if [r1.x, r1.y, r2.x, r2.y].into_iter().all(N::is_finite) {
                Ok(leg)
            } else {
                Err(Status::OutOfRange)
            }
        };
        Ok(Position {
            legs: [solve(0)?, solve(1)?, solve(2)?],
        })
    }

    /// theta_i1, the motor angles at `position`: directions A -> B in (-pi, pi].
    #[inline]
    pub fn motor_angles(&self, position: &Position<N>) -> [N::Angle; 3] {
        let dyads = self.legs.each_ref().map(|leg| &leg.dyad);
        Rrr::proximal_angles(dyads, position.legs.each_ref().map(|leg| &leg.links))
    }
}

/// Motion of the links of one leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMotion<N: Number> {
    /// Places of the joints.
    pub position: LegPosition<N>,
    /// Angular velocities of the links.
    pub rates: Rates<N>,
    /// Angular accelerations of the links.
    pub accelerations: Accelerations<N>,
}

impl<N: Number> LegMotion<N> {
    /// Returns `true` if the next stages' products of this motion stay in range. Rates occur there
    /// as squares.
    #[inline(always)]
    pub fn fits(&self) -> bool {
        self.joints_fit() && N::in_range([self.accelerations.distal])
    }

    /// [`fits`](Self::fits) without torques: the distal link's acceleration is not read, so the
    /// compiler leaves it out.
    #[inline(always)]
    pub fn joints_fit(&self) -> bool {
        let (rates, acc) = (&self.rates, &self.accelerations);
        N::in_range([
            rates.proximal * rates.proximal,
            rates.distal * rates.distal,
            acc.proximal,
        ])
    }
}

impl<N: Number> LegPosition<N> {
    /// theta_i2, the direction B -> C in (-pi, pi].
    pub fn distal_angle(&self) -> N::Angle {
        N::atan2(self.links.r2.y, self.links.r2.x)
    }

    /// Velocity of the platform joint when the platform moves with `velocity`.
    #[inline(always)]
    pub fn velocity(&self, velocity: &Vector3<N>) -> Vector2<N> {
        N::arm_velocity(velocity.xy(), velocity.z, self.platform_joint)
    }

    /// Acceleration of the platform joint when the platform moves as `setpoint` says.
    #[inline(always)]
    pub fn acceleration(&self, setpoint: &Setpoint<N>) -> Vector2<N> {
        let (alpha_rate, a) = (setpoint.velocity.z, setpoint.acceleration);
        N::arm_acceleration(a.xy(), a.z, alpha_rate * alpha_rate, self.platform_joint)
    }
}

impl<N: Number> LegMotion<N> {
    /// Jerk of the platform joint when the platform moves as `setpoint` says, with the jerk `jerk`.
    ///
    /// With c the arm of the joint: j + (alpha''' - alpha'^3) E c - 3 alpha' alpha'' c.
    fn platform_joint_jerk(&self, setpoint: &Setpoint<N>, jerk: &Vector3<N>) -> Vector2<N> {
        let (rate, acceleration) = (setpoint.velocity.z, setpoint.acceleration.z);
        let inwards = rate * acceleration;
        N::arm_acceleration(
            jerk.xy(),
            jerk.z - rate * rate * rate,
            inwards + inwards + inwards,
            self.position.platform_joint,
        )
    }
}

impl OutOfReach {
    /// Returns the status of a tick whose leg `index` is refused.
    #[inline(always)]
    pub fn of_leg(self, index: usize) -> Status {
        match self {
            Self::Unreachable => Status::Unreachable { leg: index },
            Self::Singular => Status::SerialSingular { leg: index },
        }
    }
}

impl<N: Number> Leg<N> {
    /// Solves the leg, number `index`, for the platform at `position` with `rotation`, in the
    /// leg's own branch of the working mode.
    ///
    /// # Errors
    /// [`Status::Unreachable`] or [`Status::SerialSingular`].
    #[inline(always)]
    pub fn position(
        &self,
        index: usize,
        position: Vector2<N>,
        rotation: &Rotation<N>,
    ) -> Result<LegPosition<N>, Status> {
        let (platform_joint, span) = self.span(position, rotation);
        Self::placed(index, platform_joint, self.dyad.position(span))
    }

    /// As [`position`](Self::position), for callers that
    /// [look at their results](crate::number::DyadKernel::intersect_circles_unchecked).
    #[inline(always)]
    pub(crate) fn position_unchecked(
        &self,
        index: usize,
        position: Vector2<N>,
        rotation: &Rotation<N>,
    ) -> Result<LegPosition<N>, Status> {
        let (platform_joint, span) = self.span(position, rotation);
        Self::placed(index, platform_joint, self.dyad.position_unchecked(span))
    }

    /// Returns c, and A -> C.
    #[inline(always)]
    pub fn span(&self, position: Vector2<N>, rotation: &Rotation<N>) -> (Vector2<N>, Vector2<N>) {
        let platform_joint = N::turn_arm(self.joint, rotation.sin, rotation.cos);
        let span = Vector2::new(
            N::span(position.x, self.base.x, platform_joint.x),
            N::span(position.y, self.base.y, platform_joint.y),
        );
        (platform_joint, span)
    }

    #[inline(always)]
    fn placed(
        index: usize,
        platform_joint: Vector2<N>,
        links: Result<DyadPosition<N>, OutOfReach>,
    ) -> Result<LegPosition<N>, Status> {
        match links {
            Ok(links) => Ok(LegPosition {
                platform_joint,
                links,
            }),
            Err(refused) => Err(refused.of_leg(index)),
        }
    }

    /// The link rates at `position` when the platform moves with `velocity` (vx, vy, alphadot).
    #[inline(always)]
    pub fn rates(&self, position: &LegPosition<N>, velocity: &Vector3<N>) -> Rates<N> {
        self.dyad
            .rates(&position.links, position.velocity(velocity))
    }

    /// Rate of the motor alone, as of [`rates`](Self::rates).
    pub fn motor_rate(&self, position: &LegPosition<N>, velocity: &Vector3<N>) -> N {
        self.dyad
            .proximal_rate(&position.links, position.velocity(velocity))
    }

    /// Acceleration of the motor alone, as of [`accelerations`](Self::accelerations).
    pub fn motor_acceleration(
        &self,
        position: &LegPosition<N>,
        rates: &Rates<N>,
        setpoint: &Setpoint<N>,
    ) -> N {
        self.dyad
            .proximal_acceleration(&position.links, rates, position.acceleration(setpoint))
    }

    /// The link accelerations at `position`, where the links turn with `rates`, when the platform
    /// moves as `setpoint` says.
    #[inline(always)]
    pub fn accelerations(
        &self,
        position: &LegPosition<N>,
        rates: &Rates<N>,
        setpoint: &Setpoint<N>,
    ) -> Accelerations<N> {
        self.dyad
            .accelerations(&position.links, rates, position.acceleration(setpoint))
    }

    /// Jerk of the motor while the leg moves with `motion`, and the platform as `setpoint` says, with the jerk `jerk`.
    pub fn motor_jerk(
        &self,
        motion: &LegMotion<N>,
        setpoint: &Setpoint<N>,
        jerk: &Vector3<N>,
    ) -> N {
        let LegMotion {
            position,
            rates,
            accelerations,
        } = motion;
        let jerk = motion.platform_joint_jerk(setpoint, jerk);
        self.dyad
            .proximal_jerk(&position.links, rates, accelerations, jerk)
    }
}
