//! Inverse kinematics: from the platform's pose, velocity and acceleration to those of the legs.
//!
//! Three stages, each made from the one before it: position -> velocity -> acceleration, for one
//! leg at a time ([`Leg`]'s functions), so that a leg's intermediate values are done with before
//! the next leg begins. A scene that wants positions only stops at the first.
//!
//! [`Leg`]: crate::machine::Leg

mod acceleration;
mod position;
mod velocity;

pub use position::{LegPosition, Position, Rotation};

use crate::dyad::{Accelerations, Rates};
use crate::number::Number;

/// How the links of one leg move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMotion<N: Number> {
    /// Where the joints are,
    pub position: LegPosition<N>,
    /// how fast the links turn,
    pub rates: Rates<N>,
    /// and how that changes.
    pub accelerations: Accelerations<N>,
}

impl<N: Number> LegMotion<N> {
    /// Whether what the next stages form of this motion stays in range. A rate fits if its square
    /// does.
    #[inline(always)]
    pub fn fits(&self) -> bool {
        self.joints_fit() && N::in_range([self.accelerations.distal])
    }

    /// The same for who forms no torques: the distal link's acceleration is not looked at, and so
    /// need not be computed.
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
