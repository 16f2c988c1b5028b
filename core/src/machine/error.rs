//! Why a machine was refused.

use core::fmt;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A quantity of the machine's description that can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(missing_docs)] // the variants are named after the fields they stand for
pub enum Quantity {
    Base,
    ProximalLength,
    DistalLength,
    /// l1 + l2 of a leg: the longest length it has to do with.
    Reach,
    JointRadius,
    JointAngle,
    ProximalMass,
    ProximalCentreOfMass,
    ProximalInertia,
    DistalMass,
    DistalCentreOfMass,
    DistalInertia,
    RotorInertia,
    /// The largest size that det A can have (see [`greatest_det_a`]).
    ///
    /// [`greatest_det_a`]: crate::singularity::greatest_det_a
    GreatestDetA,
    PlatformMass,
    PlatformInertia,
    PlatformCentreOfMass,
    Gravity,
    WrenchForce,
    WrenchTorque,
    SliderDirection,
    SliderMass,
    RateLimit,
    AccelerationLimit,
    TorqueLimit,
    PowerLimit,
    SerialDistance,
    ParallelDistance,
}

/// A machine's description that cannot be built: which quantity, of which leg, its value, why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildError {
    /// What is wrong.
    pub quantity: Quantity,
    /// The leg it belongs to, from 0, if it belongs to one.
    pub leg: Option<usize>,
    /// The value that was refused.
    pub value: f64,
    /// What the value should have been.
    pub expected: &'static str,
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.quantity)?;
        if let Some(leg) = self.leg {
            write!(f, " of leg {}", leg + 1)?;
        }
        write!(f, " is {}, expected {}", self.value, self.expected)
    }
}

impl core::error::Error for BuildError {}
