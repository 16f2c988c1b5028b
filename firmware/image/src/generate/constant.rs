//! Values as Rust source.

use std::fmt::Debug;

/// Imports of the types of a scene's constants.
const NAMES: &str = "\
use nalgebra::Vector2;
use trirrr_service::admission::{Path, TaylorModel};
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::dyad::{Rrr, Triangle};
use trirrr_core::machine::Elbow::{Negative, Positive};
use trirrr_core::machine::{
    Geometry, Leg, LegParameters, LinkParameters, Parameters, PlatformParameters,
};
use trirrr_protocol::message::{Board, Clock::Host, Start::Power};
use trirrr_core::model::{Dynamic, Kinematic};
use trirrr_core::number::fixed::{Factor, Length, Sum, Turns};
use trirrr_core::number::{Coarse, Fixed};
use trirrr_service::Contact::{Stall, Switch, Unfelt};
use trirrr_service::{
    Coefficients, HomingAxis, HomingCoefficients, HomingTimes, SceneIdentity, Settings,
};
use trirrr_core::setpoint::Pose;
use trirrr_core::singularity::Distances;
use trirrr_core::tick::Tick;
use trirrr_core::torque::balance::Balance;
use trirrr_core::torque::links::{Horizontal, InPlane, Massive, MassiveLeg, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset};
use trirrr_core::units::Units;
";

/// `value` as an expression that gives the same bits: the `Debug` of types whose fields are open is
/// their source, and a float is written with the digits that tell it from all others. Only nalgebra's
/// vectors, which are columns of one column, have to be named.
pub(super) fn constant(value: &impl Debug) -> String {
    let text = format!("{value:?}");
    let text = text.replace("[[", "Vector2::new(").replace("]]", ")");
    format!("{{\n#[allow(unused_imports)]\nuse constants::*;\n{text}\n}}")
}

/// A module with the names that [`constant`] uses.
pub(super) fn names() -> String {
    format!(
        "#[allow(unused_imports)]\nmod constants {{\n{}}}",
        NAMES.replace("use ", "pub(super) use ")
    )
}
