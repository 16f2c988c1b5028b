//! Angles as turns.

use crate::to_source;
use core::ops::{Add, Neg, Sub};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// An angle in 2^-32 of a turn, 1.46e-9 rad: 2^31 turns of either sign. Whole turns are the upper
/// word, so that wrapping costs nothing.
///
/// | operator | does |
/// |---|---|
/// | `+`, `-`, unary `-` | exact; saturate |
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema,
)]
#[repr(transparent)]
pub struct Turns(pub i64);

to_source!(pub Turns in trirrr_core::number::fixed; 0);

impl Turns {
    /// The angle nearest to `radians`; 0 for a value that is not a number.
    pub(super) fn from_radians(radians: f64) -> Self {
        // The conversion saturates.
        Self(super::nearest(radians * (4_294_967_296.0 / core::f64::consts::TAU)) as i64)
    }

    /// The angle in radians, rounded to `f64`.
    pub(super) fn to_radians(self) -> f64 {
        self.0 as f64 * (core::f64::consts::TAU / 4_294_967_296.0)
    }
}

impl Add for Turns {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Turns {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Turns {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}
