//! Half a unit in the last place of a number type, quantity by quantity.

use crate::inputs::Quantity;
use core::f64::consts::TAU;
use trirrr_core::number::{Fixed, Number};
use trirrr_core::units::Units;

/// Rule by which a number type rounds, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounding {
    /// Relative to the value: u.
    Relative(f64),
    /// By the same amount whatever the value: 2^-30 of the units given, 2^-33 of a turn.
    Absolute(Units),
}

impl Rounding {
    /// The rounding of `N`, which runs in `units`.
    pub fn of<N: Number>(units: Units) -> Self {
        match N::PROPAGATES_NON_FINITE {
            true => Self::Relative(N::UNIT_ROUNDOFF.to_f64()),
            false => Self::Absolute(units),
        }
    }

    /// Half a unit in the last place of a quantity of this size.
    pub fn half_unit(&self, quantity: Quantity, size: f64) -> f64 {
        match self {
            Self::Relative(u) => u * size,
            Self::Absolute(units) => match quantity.dimension() {
                Some([length, time, mass]) => 0.5 * Fixed::UNIT * units.of(length, time, mass),
                None => TAU * 0.5f64.powi(33),
            },
        }
    }

    /// A unit in the last place of a length of this size.
    pub fn last_place(&self, size: f64) -> f64 {
        // Of a float, that of the power of two below.
        2.0 * self.half_unit(Quantity::Length, size.log2().floor().exp2())
    }
}
