//! Joint accelerations: thesis (3.17) to (3.21), corrected.

use super::LegPosition;
use crate::dyad::{Accelerations, Rates};
use crate::machine::Leg;
use crate::number::{Number, perpendicular};
use crate::setpoint::Setpoint;
use nalgebra::Vector2;

impl<N: Number> LegPosition<N> {
    /// Acceleration of the platform joint when the platform moves as `setpoint` says.
    #[inline(always)]
    pub fn acceleration(&self, setpoint: &Setpoint<N>) -> Vector2<N> {
        let c = self.platform_joint;
        let (alpha_rate, a) = (setpoint.velocity.z, setpoint.acceleration);
        let centripetal = alpha_rate * alpha_rate;
        let part = |a: N, across: N, c: N, alpha: N| {
            N::round(a.widen() + N::sum_ab_minus_cd(across, alpha, c, centripetal))
        };
        let across = perpendicular(c);
        Vector2::new(part(a.x, across.x, c.x, a.z), part(a.y, across.y, c.y, a.z))
    }
}

impl<N: Number> Leg<N> {
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
}
