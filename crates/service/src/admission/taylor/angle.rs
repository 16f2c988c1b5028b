//! Angles over an interval.

use super::{Float, Roundoffs};
use crate::admission::Enclose;
use core::ops::{Add, Neg, Sub};
use trirrr_core::number::Arithmetic;
use trirrr_core::to_source;

/// An angle over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleModel<N: Enclose> {
    pub(super) constant: <Float<N> as Arithmetic>::Angle,
    /// In radians.
    pub(super) linear: Float<N>,
    /// In radians.
    pub(super) error: Float<N>,
}

to_source!([N: Enclose] AngleModel [N] in trirrr_service::admission {
    constant: <Float<N> as Arithmetic>::Angle,
    linear: Float<N>,
    error: Float<N>,
});

impl<N: Enclose> AngleModel<N> {
    /// An angle of the tick, the same at all times.
    pub fn of(angle: N::Angle) -> Self {
        let constant = N::angle_bound(angle);
        let conversion = N::conversion(<Float<N>>::radians(constant).abs());
        Self {
            constant,
            linear: <Float<N>>::ZERO,
            error: conversion + conversion,
        }
    }
}

impl<N: Enclose> Add for AngleModel<N> {
    type Output = Self;

    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant + other.constant;
        let linear = self.linear + other.linear;
        let error = self.error + other.error;
        let size = <Float<N>>::radians(constant).abs() + linear.abs() + (error + error);
        Self {
            constant,
            linear,
            error: error + Roundoffs::Two.of::<N>(size),
        }
    }
}

impl<N: Enclose> Neg for AngleModel<N> {
    type Output = Self;

    #[inline(never)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Enclose> Sub for AngleModel<N> {
    type Output = Self;

    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}
