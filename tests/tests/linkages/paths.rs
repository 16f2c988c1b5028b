//! Points of links over a turn: coupler curves, and velocities and accelerations by Rivals'
//! theorem against differences of the positions and of the velocities.

use super::agreement::drive;
use core::f64::consts::TAU;
use nalgebra::Vector2;
use trirrr_core::number::Arithmetic;
use trirrr_linkage::closure::Input;
use trirrr_linkage::mechanism::{fairbairn, inserter, quick_return, two_loop};
use trirrr_linkage::{Drive, LinkMotion, PointMotion};
use trirrr_tests::bound::Worst;

/// The crank at time `t`: turning, and faster and faster.
fn crank(t: f64) -> Drive<f64> {
    drive(&Input {
        value: 0.3 + t + 0.1 * t * t,
        rate: 1.0 + 0.2 * t,
        acceleration: 0.2,
    })
}

/// Compares the motion of `point` with central differences over 2e-5 s, whose error is a few
/// 1e-10 of truncation and of rounding each.
fn compare(name: &str, point: impl Fn(&Drive<f64>) -> PointMotion<f64>) {
    let mut worst = Worst::default();
    let step = 1e-5;
    for k in 0..200 {
        let t = f64::from(k) * (0.75 * TAU / 200.0);
        let (before, now, after) = (
            point(&crank(t - step)),
            point(&crank(t)),
            point(&crank(t + step)),
        );
        let place = || format!("{name} at {t}");
        let velocity = (after.position - before.position) / (2.0 * step);
        let acceleration = (after.velocity - before.velocity) / (2.0 * step);
        worst.compare(place, (velocity - now.velocity).abs().max(), 1e-9);
        let error = (acceleration - now.acceleration).abs().max();
        worst.compare(place, error, 1e-9);
    }
    worst.assert_within(name, 1e-3..=1.0);
}

#[test]
fn any_point_of_any_link() {
    let local = Vector2::new(0.12, -0.07);
    let linkage = two_loop::TwoLoop::new(&two_loop::SHIPPED).unwrap();
    type Link = fn(&two_loop::Motion<f64>) -> LinkMotion<f64>;
    let links: [(&str, Link); 5] = [
        ("crank", |at| at.crank),
        ("coupler", |at| at.coupler),
        ("rocker", |at| at.rocker),
        ("upper half of the telescope", |at| at.upper),
        ("lower half of the telescope", |at| at.lower),
    ];
    for (name, link) in links {
        compare(name, |drive| link(&linkage.at(drive).unwrap()).point(local));
    }
}

#[test]
fn sliders_and_tracing_points() {
    let guide = fairbairn::Fairbairn::new(&fairbairn::SHIPPED).unwrap();
    compare("tracing point", |drive| guide.at(drive).unwrap().tracer);
    let linkage = inserter::Inserter::new(&inserter::SHIPPED).unwrap();
    compare("pusher", |drive| linkage.at(drive).unwrap().pusher.origin);
    let linkage = quick_return::QuickReturn::new(&quick_return::SHIPPED).unwrap();
    compare("ram", |drive| linkage.at(drive).unwrap().ram.origin);
}

/// The coupler's point reaches from the crank's circle to the rocker's arc and closes after a turn.
#[test]
fn the_coupler_curve_is_closed() {
    let dimensions = inserter::SHIPPED;
    let linkage = inserter::Inserter::<f64>::new(&dimensions).unwrap();
    let at = |angle: f64| {
        let drive = Drive {
            angle,
            rate: 1.0,
            acceleration: 0.0,
        };
        linkage.at(&drive).unwrap()
    };
    for k in 0..360 {
        let motion = at(f64::from(k) * (TAU / 360.0));
        let near = motion.coupler.point(Vector2::new(0.0, 0.0)).position;
        let far = motion.coupler.point(Vector2::new(dimensions.coupler, 0.0));
        let radius = near.x.hypot(near.y);
        assert!((radius - dimensions.crank).abs() < 1e-16, "{radius}");
        let arm = far.position - dimensions.pivot;
        let error = arm.x.hypot(arm.y) - dimensions.rocker;
        assert!(error.abs() < 4.0 * f64::UNIT_ROUNDOFF, "{error}");
    }
    let point = |angle| at(angle).coupler.point(dimensions.coupler_point).position;
    assert!((point(0.0) - point(TAU)).abs().max() < 1e-15);
}
