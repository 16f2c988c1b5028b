//! Joint rates: thesis (3.11) to (3.14), with the sign of link 2 corrected.

use super::LegPosition;
use crate::dyad::Rates;
use crate::machine::Leg;
use crate::number::{Number, perpendicular};
use nalgebra::{Vector2, Vector3};

impl<N: Number> LegPosition<N> {
    /// Velocity of the platform joint when the platform moves with `velocity`.
    #[inline(always)]
    pub fn velocity(&self, velocity: &Vector3<N>) -> Vector2<N> {
        let across = perpendicular(self.platform_joint);
        Vector2::new(
            N::round(velocity.x.widen() + N::product(across.x, velocity.z)),
            N::round(velocity.y.widen() + N::product(across.y, velocity.z)),
        )
    }
}

impl<N: Number> Leg<N> {
    /// The link rates at `position` when the platform moves with `velocity` (vx, vy, alphadot).
    #[inline(always)]
    pub fn rates(&self, position: &LegPosition<N>, velocity: &Vector3<N>) -> Rates<N> {
        self.dyad
            .rates(&position.links, position.velocity(velocity))
    }
}
