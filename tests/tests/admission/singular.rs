//! Paths that leave the reach, or cross a singularity, where no tick looks.

use crate::judge::{Setting, judge};
use trirrr_core::limits::LimitParameters;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Bounded, Move};
use trirrr_service::paces::Ramp;
use trirrr_tests::machines::thesis;

/// Where det A = 0 at (0.245, 0.25) m on the thesis machine, from the reference data.
const SINGULAR_RAD: f64 = -0.753_418_931_929_448_5;

fn setting(serial_distance_min: f64, parallel_distance_min: f64) -> Setting {
    Setting {
        parameters: thesis(),
        limits: LimitParameters {
            serial_distance_min,
            parallel_distance_min,
            ..LimitParameters::default()
        },
        ramp: Ramp::fixed(10),
        period_s: 0.01,
    }
}

fn turn<N: Number>(from: f64, to: f64, velocities: [f64; 2], ticks: u32) -> Move<N> {
    let velocity = |velocity: f64| [N::ZERO, N::ZERO, N::from_f64(velocity)];
    Move {
        from: Pose::from_f64(0.245, 0.25, from),
        to: Pose::from_f64(0.245, 0.25, to),
        start_velocity: velocity(velocities[0]),
        end_velocity: velocity(velocities[1]),
        ..crate::thesis_move(ticks)
    }
}

/// The fraction at which the rest-to-rest cubic has done the part `part` of its way.
fn blend_inverse(part: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle: f64 = (low + high) / 2.0;
        if middle * middle * (3.0 - 2.0 * middle) < part {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// det A changes its sign between the only two ticks of the move.
#[test]
fn a_crossing_between_ticks_is_found_where_it_is() {
    for ticks in [1, 2, 3, 100, 1_000_000] {
        for to in [-0.9, -1.3, -0.76] {
            let offered = turn::<f64>(0.0, to, [0.0, 0.0], ticks);
            let violation = judge(&setting(0.0, 0.0), &offered)
                .verdict
                .expect_err("crosses");
            let label = format!("{violation:?}");
            assert_eq!(violation.what, Bounded::ParallelDistance, "{label}");
            assert_eq!(
                (violation.index, violation.shortest),
                (None, None),
                "{label}"
            );
            // An interval of 2^-20 that holds it, and none before.
            let truth = blend_inverse(SINGULAR_RAD / to);
            assert!(
                (truth - 3e-6..=truth).contains(&violation.at),
                "{truth} {label}"
            );
        }
        let short_of_it = turn::<f64>(0.0, -0.753, [0.0, 0.0], ticks);
        assert_eq!(judge(&setting(0.0, 0.0), &short_of_it).verdict, Ok(()));
    }
}

/// There and back: both ends lie on the same side, so their signs say nothing.
#[test]
fn a_crossing_and_back_is_found() {
    for ticks in [1, 2, 50] {
        let duration = f64::from(ticks) * 0.01;
        // A bulge of v T / 4 about -0.6.
        let bulging = |depth: f64| {
            let v = 4.0 * depth / duration;
            turn::<f64>(-0.6, -0.6, [-v, v], ticks)
        };
        let violation = judge(&setting(0.0, 0.0), &bulging(0.1535))
            .verdict
            .expect_err("crosses");
        assert_eq!(violation.what, Bounded::ParallelDistance, "{violation:?}");
        assert!((0.4..0.5).contains(&violation.at), "{violation:?}");
        assert_eq!(judge(&setting(0.0, 0.0), &bulging(0.1533)).verdict, Ok(()));
        // In binary32 too, to its own precision.
        let bulging = |depth: f64| {
            let v = 4.0 * depth / duration;
            turn::<f32>(-0.6, -0.6, [-v, v], ticks)
        };
        assert!(judge(&setting(0.0, 0.0), &bulging(0.1535)).verdict.is_err());
        assert_eq!(judge(&setting(0.0, 0.0), &bulging(0.152)).verdict, Ok(()));
    }
}

/// Out of reach and back: leg 1's base is at (0, 0.433), its links 0.2 m each, C_1 0.02 m from D.
#[test]
fn a_bulge_out_of_reach_is_found() {
    for ticks in [1, 40] {
        let duration = f64::from(ticks) * 0.01;
        let bulging = |depth: f64| {
            let v = 4.0 * depth / duration;
            let start = crate::thesis_move::<f64>(ticks);
            Move {
                to: start.from,
                start_velocity: [v, 0.0, 0.0],
                end_velocity: [-v, 0.0, 0.0],
                ..start
            }
        };
        assert_eq!(judge(&setting(0.0, 0.0), &bulging(0.05)).verdict, Ok(()));
        let violation = judge(&setting(0.0, 0.0), &bulging(0.4))
            .verdict
            .expect_err("too far");
        let label = format!("{violation:?}");
        assert_eq!(
            (violation.what, violation.shortest),
            (Bounded::Reach, None),
            "{label}"
        );
        assert!(violation.at > 0.0 && violation.at < 0.5, "{label}");
        assert!((violation.limit - 0.4).abs() < 1e-15, "{label}");
        assert!((violation.value - 0.4).abs() < 1e-5, "{label}");
        // A required distance is broken before.
        let clear = judge(&setting(0.1, 0.0), &bulging(0.4))
            .verdict
            .expect_err("too far");
        assert_eq!(
            (clear.what, clear.index),
            (Bounded::SerialDistance, violation.index)
        );
        assert!(clear.at < violation.at && clear.limit == 0.1, "{clear:?}");
        assert!((0.0999..0.1).contains(&clear.value), "{clear:?}");
    }
}
