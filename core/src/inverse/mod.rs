//! Inverse kinematics: motion of the legs for a pose, velocity and acceleration of the platform.
//!
//! [`Leg`] has three stages, each of which uses the results before it: position, velocity,
//! acceleration. The tick solves one leg at a time, so that few values are alive at once.
//!
//! [`Leg`]: crate::machine::Leg

mod acceleration;
mod position;
mod velocity;

pub use position::{LegPosition, Position, Rotation};

use crate::dyad::{Accelerations, Rates};
use crate::number::Number;

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
