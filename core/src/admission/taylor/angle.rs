//! Angles over an interval.

use super::Roundoffs;
use crate::number::Number;
use core::ops::{Add, Neg, Sub};

/// An angle over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleModel<N: Number> {
    pub(super) constant: N::Angle,
    /// In radians.
    pub(super) linear: N,
    /// In radians.
    pub(super) error: N,
}

impl<N: Number> AngleModel<N> {
    /// The same at all times.
    pub fn point(angle: N::Angle) -> Self {
        Self {
            constant: angle,
            linear: N::ZERO,
            error: N::ZERO,
        }
    }
}

impl<N: Number> Add for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant + other.constant;
        let linear = self.linear + other.linear;
        let error = self.error + other.error;
        let size = N::radians(constant).abs() + linear.abs() + (error + error);
        Self {
            constant,
            linear,
            error: error + Roundoffs::Two.of(size),
        }
    }
}

impl<N: Number> Neg for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Number> Sub for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}
