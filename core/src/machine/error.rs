//! Refusal of a machine's description.

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
    /// l1 + l2 of a leg, its longest length.
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
    /// [`Parameters::greatest_det_a`](super::Parameters::greatest_det_a).
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
    JerkLimit,
    /// Angle between what a drive counts and where its motor stands.
    EncoderOffset,
}

/// Refusal of a machine's description: the quantity, its leg, its value, and the expected value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildError {
    /// The quantity that is refused.
    pub quantity: Quantity,
    /// The leg of the quantity, from 0; `None` for a quantity of the whole machine.
    pub leg: Option<usize>,
    /// The value that was refused.
    pub value: f64,
    /// Description of an acceptable value.
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
