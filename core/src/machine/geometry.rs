//! The geometry that the tick reads, built once from [`Parameters`].

use super::{BuildError, Parameters};
use crate::dyad::Rrr;
use crate::number::{Arithmetic, Number};
use crate::to_source;
use nalgebra::Vector2;

/// One leg: base joint, platform joint, and the dyad between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<N: Number> {
    /// Base joint A in the fixed frame.
    pub(crate) base: Vector2<N>,
    /// Platform joint relative to D, in the platform's frame.
    pub(crate) joint: Vector2<N>,
    /// Proximal and distal link.
    pub(crate) dyad: Rrr<N>,
}

to_source!([N: Number] Leg [N] in trirrr_core::machine {
    base: Vector2<N>,
    joint: Vector2<N>,
    dyad: Rrr<N>,
});

/// The geometry of the three legs in the number type `N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<N: Number> {
    /// The three legs.
    pub(crate) legs: [Leg<N>; 3],
}

to_source!([N: Number] Geometry [N] in trirrr_core::machine { legs: [Leg<N>; 3] });

impl<N: Number> Leg<N> {
    /// Returns the same leg with its base joint A at `base`.
    pub fn at(&self, base: Vector2<N>) -> Self {
        Self { base, ..*self }
    }

    /// Returns the base joint A in the fixed frame.
    pub fn base(&self) -> Vector2<N> {
        self.base
    }

    /// Returns the platform joint relative to D, in the platform's frame.
    pub fn joint(&self) -> Vector2<N> {
        self.joint
    }

    /// Returns the proximal and the distal link.
    pub fn dyad(&self) -> &Rrr<N> {
        &self.dyad
    }
}

impl<N: Number> Geometry<N> {
    /// Returns the three legs.
    pub fn legs(&self) -> &[Leg<N>; 3] {
        &self.legs
    }

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
