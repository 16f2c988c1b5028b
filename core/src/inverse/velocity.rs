//! Joint rates: thesis (3.11) to (3.14), with the sign of link 2 corrected.

use super::LegPosition;
use crate::linkage::rrr::Rates;
use crate::machine::Leg;
use crate::number::{Number, perpendicular};
use nalgebra::Vector3;

impl<N: Number> Leg<N> {
    /// The link rates at `position` when the platform moves with `velocity` (vx, vy, alphadot).
    #[inline(always)]
    pub fn rates(&self, position: &LegPosition<N>, velocity: &Vector3<N>) -> Rates<N> {
        let v_c = velocity.xy() + perpendicular(position.platform_joint) * velocity.z;
        self.dyad.rates(&position.links, v_c)
    }
}
