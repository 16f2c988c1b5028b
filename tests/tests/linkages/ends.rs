//! Random ends of dyads, and what a dyad has to satisfy between them.

use core::f64::consts::PI;
use nalgebra::Vector2;
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::number::cross;
use trirrr_linkage::{DyadMotion, GuideMotion, LinkMotion, LinkageStatus, PointMotion};
use trirrr_tests::bound::Worst;

/// Dyads of each kind.
pub(crate) const CASES: u32 = 10_000;
/// Distance from the singularity above which differences are compared.
pub(crate) const LEAST_DISTANCE: f64 = 0.2;
/// Seconds of the differences.
pub(crate) const STEP: f64 = 1e-5;

pub(crate) type Vector = Vector2<f64>;

pub(crate) fn unit(angle: f64) -> Vector {
    Vector::new(angle.cos(), angle.sin())
}

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector> {
    (-size..size, -size..size).prop_map(|(x, y)| Vector::new(x, y))
}

pub(crate) fn branch() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(-1.0)]
}

pub(crate) fn offset() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), -0.5..0.5]
}

/// An end of a dyad: where it is at time 0 and how it goes on. Half of the guides stand still.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) point: PointMotion<f64>,
    pub(crate) angle: f64,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
}

pub(crate) fn end() -> impl Strategy<Value = End> {
    let turning = prop_oneof![Just((0.0, 0.0)), (-1.0..1.0, -1.0..1.0)];
    (vector(0.7), vector(0.5), vector(0.5), -PI..PI, turning).prop_map(
        |(position, velocity, acceleration, angle, (rate, faster))| End {
            point: PointMotion {
                position,
                velocity,
                acceleration,
            },
            angle,
            rate,
            acceleration: faster,
        },
    )
}

impl End {
    pub(crate) fn point(&self, t: f64) -> PointMotion<f64> {
        let at = &self.point;
        PointMotion {
            position: at.position + at.velocity * t + at.acceleration * (t * t / 2.0),
            velocity: at.velocity + at.acceleration * t,
            acceleration: at.acceleration,
        }
    }

    pub(crate) fn guide(&self, t: f64) -> GuideMotion<f64> {
        LinkMotion {
            origin: self.point(t),
            direction: unit(self.angle + self.rate * t + self.acceleration * (t * t / 2.0)),
            rate: self.rate + self.acceleration * t,
            acceleration: self.acceleration,
        }
    }
}

/// The fastest of all rates of a dyad, with the roots of the accelerations, which have their unit.
fn speed<const S: usize>(at: &DyadMotion<f64, S>) -> f64 {
    let links = [at.first, at.second];
    let of_links = links.iter().flat_map(|link| {
        let (v, a) = (link.origin.velocity, link.origin.acceleration);
        [
            [link.rate, link.acceleration],
            [v.abs().max(), a.abs().max()],
        ]
    });
    let of_slides = at.slides.iter().map(|it| [it.rate, it.acceleration]);
    of_links
        .chain(of_slides)
        .map(|[rate, acceleration]| rate.abs().max(acceleration.abs().sqrt()))
        .fold(0.0, f64::max)
}

/// Compares rates and accelerations with central differences. Their truncation is STEP^2 / 6 of
/// the third derivative in time, of the order of the fourth power of the speed.
///
/// `near` is a further limit of the distance from the singularity, 1 where there is none.
pub(crate) fn moves<const S: usize>(
    worst: &RefCell<Worst>,
    solve: impl Fn(f64) -> Result<DyadMotion<f64, S>, LinkageStatus>,
    near: f64,
    case: &impl core::fmt::Debug,
) {
    let now = solve(0.0).unwrap();
    if now.singularity_distance.min(near) < LEAST_DISTANCE {
        return;
    }
    let (before, after) = (solve(-STEP).unwrap(), solve(STEP).unwrap());
    let compare = |what: &str, error: f64| {
        let place = || format!("{what} of {case:?}");
        let bound = 1e-8 * (1.0 + speed(&now).powi(4));
        worst.borrow_mut().compare(place, error, bound);
    };
    for link in 0..2 {
        let [before, now, after] = [&before, &now, &after].map(|at| [at.first, at.second][link]);
        let turned = (after.direction - before.direction) / (2.0 * STEP);
        let acceleration = (after.rate - before.rate) / (2.0 * STEP);
        compare("rate", cross(now.direction, turned) - now.rate);
        compare("acceleration", acceleration - now.acceleration);
        let (before, now, after) = (before.origin, now.origin, after.origin);
        let velocity = (after.position - before.position) / (2.0 * STEP);
        let acceleration = (after.velocity - before.velocity) / (2.0 * STEP);
        compare("velocity", (velocity - now.velocity).abs().max());
        let error = (acceleration - now.acceleration).abs().max();
        compare("point's acceleration", error);
    }
    for ((before, now), after) in before.slides.iter().zip(&now.slides).zip(&after.slides) {
        let rate = (after.length - before.length) / (2.0 * STEP);
        let acceleration = (after.rate - before.rate) / (2.0 * STEP);
        compare("sliding", rate - now.rate);
        compare("sliding faster", acceleration - now.acceleration);
    }
}

/// Checks what the dyads that could be assembled came to.
pub(crate) fn check(name: &str, motion: RefCell<Worst>) {
    let name = format!("{name} moves");
    motion.into_inner().assert_within(&name, 1e-3..=1.0);
}
