//! What is no move at all, and moves beyond all measure: each is named, and none takes for ever.

use crate::judge::{Judged, Setting, judge};
use crate::thesis_move;
use trirrr_core::limits::LimitParameters;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Bounded, Move};
use trirrr_service::admission::Enclose;
use trirrr_service::paces::Ramp;
use trirrr_tests::machines::thesis;

fn setting() -> Setting {
    Setting {
        parameters: thesis(),
        limits: LimitParameters {
            torque_nm: Some([1.0; 3]),
            power_w: Some([1.0; 3]),
            rate_rad_s: Some([2.0; 3]),
            ..LimitParameters::default()
        },
        ramp: Ramp::fixed(10),
        period_s: 0.01,
    }
}

fn refused<N: Enclose>(offered: &Move<N>) -> (Bounded, Option<u8>) {
    let violation = judge(&setting(), offered).verdict.expect_err("no move");
    (violation.what, violation.index)
}

fn values_that_are_none<N: Enclose>() {
    let good = thesis_move::<N>(100);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for index in 0..3 {
            let mut pose = [0.21, 0.22, 0.15];
            pose[index] = bad;
            let pose = Pose::from_f64(pose[0], pose[1], pose[2]);
            let expected = (Bounded::Range, Some(index as u8));
            assert_eq!(refused(&Move { from: pose, ..good }), expected);
            assert_eq!(refused(&Move { to: pose, ..good }), expected);
            let mut velocity = [N::ZERO; 3];
            velocity[index] = N::from_f64(bad);
            let start = Move {
                start_velocity: velocity,
                ..good
            };
            assert_eq!(refused(&start), expected);
            let end = Move {
                end_velocity: velocity,
                ..good
            };
            assert_eq!(refused(&end), expected);
        }
    }
    assert_eq!(refused(&thesis_move::<N>(0)), (Bounded::Range, None));
}

#[test]
fn values_that_are_no_numbers_are_refused_by_name() {
    values_that_are_none::<f64>();
    values_that_are_none::<f32>();
}

fn far_out<N: Enclose>(most: f64) {
    let good = thesis_move::<N>(100);
    for size in [10.0, 1e6, 1e18, most] {
        for sign in [1.0, -1.0] {
            let value = sign * size;
            let (what, _) = refused(&Move {
                to: Pose::from_f64(value, 0.2, 0.1),
                ..good
            });
            // The way there leaves the reach, or comes too near to a stretched leg just before.
            let on_the_way = [
                Bounded::Reach,
                Bounded::SerialDistance,
                Bounded::ParallelDistance,
                Bounded::Rate,
                Bounded::Torque,
                Bounded::Power,
            ];
            assert!(
                on_the_way.contains(&what) || size == most,
                "{what:?} {value}"
            );
            let what = refused(&Move {
                from: Pose::from_f64(0.2, value, 0.1),
                ..good
            });
            assert!(what.0 == Bounded::Reach, "{what:?} {value}");
            let v = [N::from_f64(value), N::ZERO, N::ZERO];
            refused(&Move {
                end_velocity: v,
                ..good
            });
        }
        let turned = Pose::from_f64(0.21, 0.22, size);
        let (what, index) = refused(&Move { to: turned, ..good });
        if size > 1e15 {
            assert_eq!((what, index), (Bounded::Range, Some(2)), "{size}");
        }
    }
}

#[test]
fn huge_coordinates_are_refused() {
    far_out::<f64>(1e300);
    far_out::<f32>(3e38);
}

#[test]
fn durations_from_one_tick_to_years() {
    let fast = judge(&setting(), &thesis_move::<f64>(1))
        .verdict
        .expect_err("too fast");
    assert!(
        fast.shortest
            .is_some_and(|found| (10..500).contains(&found.enough)),
        "{fast:?}"
    );
    assert_eq!(
        judge(&setting(), &thesis_move::<f64>(u32::MAX)).verdict,
        Ok(())
    );
    assert_eq!(
        judge(&setting(), &thesis_move::<f32>(u32::MAX)).verdict,
        Ok(())
    );
    // The shortest that passes is beyond the longest there is.
    let mut crawling = setting();
    crawling.limits.rate_rad_s = Some([1e-9; 3]);
    let slow = judge(&crawling, &thesis_move::<f64>(1000))
        .verdict
        .expect_err("too fast");
    assert_eq!((slow.what, slow.shortest), (Bounded::Rate, None));
}

/// A move that keeps a limit by next to nothing all along would be halved without end.
#[test]
fn the_work_is_bounded() {
    // Around leg 1's motor at constant speed: its rate is constant but for the cubic's own ripple.
    let mut setting = setting();
    let offered = Move::<f64> {
        start_velocity: [0.07, 0.06, 0.05],
        end_velocity: [0.07, 0.06, 0.05],
        ..thesis_move(100)
    };
    let mut most = 0;
    for k in 0..2000 {
        setting.limits.rate_rad_s = Some([0.2 + f64::from(k) * 1e-3; 3]);
        let Judged { steps, .. } = judge(&setting, &offered);
        most = most.max(steps);
    }
    println!("at most {most} intervals");
    // The check itself at most 4096, and no search takes more than 50 checks.
    assert!(most < 4096, "{most}");
}
