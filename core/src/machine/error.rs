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
    /// Greatest size of [det A](super::Parameters::greatest_det_a).
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

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Base => "base point",
            Self::ProximalLength => "length of the proximal link",
            Self::DistalLength => "length of the distal link",
            Self::Reach => "reach, the length of both links together,",
            Self::JointRadius => "radius of the joint of the platform",
            Self::JointAngle => "angle of the joint of the platform",
            Self::ProximalMass => "mass of the proximal link",
            Self::ProximalCentreOfMass => "centre of mass of the proximal link",
            Self::ProximalInertia => "inertia of the proximal link",
            Self::DistalMass => "mass of the distal link",
            Self::DistalCentreOfMass => "centre of mass of the distal link",
            Self::DistalInertia => "inertia of the distal link",
            Self::RotorInertia => "inertia of the rotor",
            Self::GreatestDetA => "greatest det A",
            Self::PlatformMass => "mass of the platform",
            Self::PlatformInertia => "inertia of the platform",
            Self::PlatformCentreOfMass => "centre of mass of the platform",
            Self::Gravity => "gravity",
            Self::WrenchForce => "force of the wrench",
            Self::WrenchTorque => "torque of the wrench",
            Self::SliderDirection => "direction of the slider",
            Self::SliderMass => "mass of the slider",
            Self::RateLimit => "limit of the rate",
            Self::AccelerationLimit => "limit of the acceleration",
            Self::TorqueLimit => "limit of the torque",
            Self::PowerLimit => "limit of the power",
            Self::SerialDistance => "least distance from the serial singularity",
            Self::ParallelDistance => "least distance from the parallel singularity",
            Self::JerkLimit => "limit of the jerk",
            Self::EncoderOffset => "offset of the encoder",
        })
    }
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
        write!(f, "{}", self.quantity)?;
        if let Some(leg) = self.leg {
            write!(f, " of leg {}", leg + 1)?;
        }
        // An exponent where zeros would hide the size.
        match self.value == 0.0 || (1e-5..1e9).contains(&self.value.abs()) {
            true => write!(f, " is {}", self.value)?,
            false => write!(f, " is {:e}", self.value)?,
        }
        write!(f, ", expected {}", self.expected)
    }
}

impl core::error::Error for BuildError {}
