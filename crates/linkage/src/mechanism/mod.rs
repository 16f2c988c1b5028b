//! Mechanisms: a driven crank, then dyads in solving order.
//!
//! | mechanism | composition |
//! |---|---|
//! | [`four_bar`] | crank + RRR |
//! | [`five_bar`] | two cranks + RRR |
//! | [`slider_crank`] | crank + RRP; also driven by an eccentric disc |
//! | [`scotch_yoke`] | crank + PPR |
//! | [`quick_return`] | crank + RPR + RRP |
//! | [`slotted_quick_return`] | crank + RPR + PRP |
//! | [`fairbairn`] | crank + RRR + RRR |
//! | [`inserter`] | crank + RRR + RRP |
//! | [`two_loop`] | crank + RRR + RPR |
//! | [`serial_arm`] | open chain; its inverse is an RRR |
//!
//! Each is built from `Dimensions` and has one function, `at`, from its drives to the
//! [motions](super::LinkMotion) of its links. Every point of every link follows from those by
//! [`LinkMotion::point`](super::LinkMotion::point): coupler curves, velocities, accelerations.
//!
//! Cranks turn about the origin unless something else is said. The `SHIPPED` dimensions are this
//! crate's own choice; with them every crank can turn fully.

pub mod fairbairn;
pub mod five_bar;
pub mod four_bar;
pub mod inserter;
pub mod quick_return;
pub mod scotch_yoke;
pub mod serial_arm;
pub mod slider_crank;
pub mod slotted_quick_return;
pub mod two_loop;

use super::{Drive, LinkMotion, PointMotion};
use core::fmt;
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number};

/// A dimension that no mechanism can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DimensionError {
    /// Field of the `Dimensions`.
    pub name: &'static str,
    /// Value refused.
    pub value: f64,
    /// Expected value.
    pub wanted: &'static str,
}

impl fmt::Display for DimensionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}: {}", self.name, self.value, self.wanted)
    }
}

impl core::error::Error for DimensionError {}

/// Refuses lengths that are not positive.
fn lengths<const K: usize>(values: [(&'static str, f64); K]) -> Result<(), DimensionError> {
    check(values, "a length has to be positive and finite", |value| {
        value > 0.0 && value.is_finite()
    })
}

/// Refuses what is not finite.
fn finite<const K: usize>(values: [(&'static str, f64); K]) -> Result<(), DimensionError> {
    check(values, "it has to be finite", f64::is_finite)
}

/// Refuses a sign that is none.
fn branch(name: &'static str, value: f64) -> Result<(), DimensionError> {
    let wanted = "a branch has to be +1 or -1";
    check([(name, value)], wanted, |value| value.abs() == 1.0)
}

fn check<const K: usize>(
    values: [(&'static str, f64); K],
    wanted: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), DimensionError> {
    for (name, value) in values {
        if !holds(value) {
            return Err(DimensionError {
                name,
                value,
                wanted,
            });
        }
    }
    Ok(())
}

/// A driven link about a fixed centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crank<N> {
    /// Its fixed joint.
    pub centre: Vector2<N>,
    /// From the centre to the tip, m.
    pub length: N,
}

impl<N: Number> Crank<N> {
    /// The crank of `length` about `centre`.
    pub fn new(centre: Vector2<f64>, length: f64) -> Self {
        Self {
            centre: centre.map(N::from_f64),
            length: N::from_f64(length),
        }
    }

    /// The crank as `drive` turns it; origin at the centre, x axis towards the tip.
    #[inline]
    pub fn at(&self, drive: &Drive<N>) -> LinkMotion<N> {
        drive.link(PointMotion::fixed(self.centre))
    }

    /// The tip of the crank that moves as `link`.
    #[inline]
    pub fn tip(&self, link: &LinkMotion<N>) -> PointMotion<N> {
        link.point(Vector2::new(self.length, N::ZERO))
    }
}

/// A fixed guide through `point` at `angle` (rad).
fn fixed_guide<N: Number>(point: Vector2<f64>, angle: f64) -> LinkMotion<N> {
    let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
    LinkMotion::fixed(
        point.map(N::from_f64),
        Vector2::new(N::from_f64(cos), N::from_f64(sin)),
    )
}

/// The smaller of two distances.
fn smaller<N: Number>(a: N, b: N) -> N {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn names_what_is_wrong() {
        let error = lengths([("rod", 1.0), ("crank", -0.5)]).unwrap_err();
        let message = "crank is -0.5: a length has to be positive and finite";
        assert_eq!(error.to_string(), message);
        assert!(lengths([("rod", f64::NAN)]).is_err());
        assert!(finite([("offset", f64::INFINITY)]).is_err());
        assert!(finite([("offset", -1.0)]).is_ok());
        assert!(branch("branch", 0.5).is_err());
        assert!(branch("branch", -1.0).is_ok());
    }
}
