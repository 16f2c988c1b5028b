//! The geometry that the tick reads, built once from [`Parameters`].

use super::{BuildError, Parameters};
use crate::dyad::Rrr;
use crate::number::{Arithmetic, Number};
use nalgebra::Vector2;

/// One leg: base joint, platform joint, and the dyad between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<N: Number> {
    /// Base joint A in the fixed frame.
    pub base: Vector2<N>,
    /// Platform joint relative to D, in the platform's frame.
    pub joint: Vector2<N>,
    /// Proximal and distal link.
    pub dyad: Rrr<N>,
}

/// The geometry of the three legs in the number type `N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<N: Number> {
    /// The three legs.
    pub legs: [Leg<N>; 3],
}

impl<N: Number> Geometry<N> {
    /// Checks `parameters`, which no later stage repeats, and builds the coefficients. They are
    /// computed in `f64` and rounded once to `N`.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn build(parameters: &Parameters) -> Result<Self, BuildError> {
        parameters.check::<N>()?;
        Ok(Self {
            legs: parameters.legs.map(|leg| {
                let (sin, cos) = <f64 as Arithmetic>::sin_cos(leg.joint_angle_rad);
                Leg {
                    base: leg.base_m.map(N::from_f64),
                    joint: Vector2::new(
                        N::from_f64(leg.joint_radius_m * cos),
                        N::from_f64(leg.joint_radius_m * sin),
                    ),
                    dyad: Rrr::new(leg.proximal_m, leg.distal_m, leg.elbow.sign()),
                }
            }),
        })
    }
}
