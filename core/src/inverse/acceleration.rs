//! Joint accelerations: thesis (3.17) to (3.21), corrected.

use super::LegPosition;
use crate::linkage::rrr::{Accelerations, Rates};
use crate::machine::Leg;
use crate::number::{Number, perpendicular};
use crate::setpoint::Setpoint;

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
        let c = position.platform_joint;
        let (alpha_rate, a) = (setpoint.velocity.z, setpoint.acceleration);
        let a_c = a.xy() + (perpendicular(c) * a.z - c * (alpha_rate * alpha_rate));
        self.dyad.accelerations(&position.links, rates, a_c)
    }
}
