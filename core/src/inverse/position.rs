//! Position: thesis (3.2) to (3.9), by vectors.

use crate::dyad::{DyadPosition, OutOfReach};
use crate::machine::{Geometry, Leg};
use crate::number::Number;
use crate::setpoint::Pose;
use crate::status::Status;
use nalgebra::Vector2;

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
        let platform_joint = rotation.apply(self.joint);
        let span = Vector2::new(
            N::span(position.x, self.base.x, platform_joint.x),
            N::span(position.y, self.base.y, platform_joint.y),
        );
        match self.dyad.position(span) {
            Ok(links) => Ok(LegPosition {
                platform_joint,
                links,
            }),
            Err(OutOfReach::Unreachable) => Err(Status::Unreachable { leg: index }),
            Err(OutOfReach::Singular) => Err(Status::SerialSingular { leg: index }),
        }
    }
}

impl<N: Number> LegPosition<N> {
    /// theta_i2, the direction B -> C in (-pi, pi].
    pub fn distal_angle(&self) -> N::Angle {
        N::atan2(self.links.r2.y, self.links.r2.x)
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
        let angle = |leg: usize| {
            self.legs[leg]
                .dyad
                .proximal_angle(&position.legs[leg].links)
        };
        [angle(0), angle(1), angle(2)]
    }
}
