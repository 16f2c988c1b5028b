//! Points of links over a turn: coupler curves, and velocities and accelerations by Rivals'
//! theorem against differences of the positions and of the velocities.

use super::agreement::drive;
use super::compositions;
use core::f64::consts::TAU;
use nalgebra::Vector2;
use trirrr_core::number::Arithmetic;
use trirrr_linkage::closure::ClosureInput;
use trirrr_linkage::{Drive, LinkMotion, PointMotion};
use trirrr_tests::bound::Worst;

/// The crank at time `t`: turning, and faster and faster.
fn crank(t: f64) -> Drive<f64> {
    drive(&ClosureInput {
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
    let names = [
        "crank",
        "coupler",
        "rocker",
        "upper half of the telescope",
        "lower half of the telescope",
    ];
    for (link, name) in names.into_iter().enumerate() {
        compare(name, |drive| {
            let (links, _) = compositions::two_loop(drive).unwrap();
            links[link].point(local)
        });
    }
}

#[test]
fn sliders_and_tracing_points() {
    compare("tracing point", |drive| {
        let ([_, _, _, tracing, _], []) = compositions::fairbairn(drive).unwrap();
        tracing.point(Vector2::new(-0.2, 0.0))
    });
    compare("pusher", |drive| {
        let ([.., pusher], _) = compositions::inserter(drive).unwrap();
        pusher.origin
    });
    compare("ram", |drive| {
        let ([.., ram], _) = compositions::quick_return(drive).unwrap();
        ram.origin
    });
}

/// The coupler's point reaches from the crank's circle to the rocker's arc and closes after a turn.
#[test]
fn the_coupler_curve_is_closed() {
    let coupler = |angle: f64| -> LinkMotion<f64> {
        let drive = Drive {
            angle,
            rate: 1.0,
            acceleration: 0.0,
        };
        let ([_, coupler, ..], _) = compositions::inserter(&drive).unwrap();
        coupler
    };
    for k in 0..360 {
        let coupler = coupler(f64::from(k) * (TAU / 360.0));
        let near = coupler.origin.position;
        let far = coupler.point(Vector2::new(0.2, 0.0)).position;
        let radius = near.x.hypot(near.y);
        assert!((radius - 0.06).abs() < 1e-16, "{radius}");
        let arm = far - Vector2::new(0.22, 0.0);
        let error = arm.x.hypot(arm.y) - 0.14;
        assert!(error.abs() < 4.0 * f64::UNIT_ROUNDOFF, "{error}");
    }
    let point = |angle| coupler(angle).point(Vector2::new(0.15, 0.12)).position;
    assert!((point(0.0) - point(TAU)).abs().max() < 1e-15);
}
