//! Angles over an interval.

use super::{Float, TaylorModel};
use crate::admission::Enclose;
use core::ops::{Add, Neg, Sub};
use trirrr_core::number::Arithmetic;
use trirrr_core::to_source;

/// An angle over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleModel<N: Enclose> {
    pub(super) radians: TaylorModel<N>,
}

to_source!([N: Enclose] AngleModel [N] in trirrr_service::admission { radians: TaylorModel<N> });

impl<N: Enclose> AngleModel<N> {
    /// An angle of the tick, the same at all times.
    pub fn of(angle: N::Angle) -> Self {
        let radians = <Float<N>>::radians(N::angle_bound(angle));
        let conversion = N::conversion(radians.abs());
        let radians = TaylorModel {
            error: conversion + conversion,
            ..TaylorModel::point(radians)
        };
        Self { radians }
    }
}

impl<N: Enclose> Add for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            radians: self.radians + other.radians,
        }
    }
}

impl<N: Enclose> Neg for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            radians: -self.radians,
        }
    }
}

impl<N: Enclose> Sub for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            radians: self.radians - other.radians,
        }
    }
}
