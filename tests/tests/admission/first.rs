//! Each limit by itself: kept and broken by little, named, and found where it is first broken.

use crate::dense::{Density, Extremes, extremes, visit};
use crate::judge::{Setting, judge};
use crate::moves::random_move;
use trirrr_core::limits::LimitParameters;
use trirrr_protocol::message::{Bounded, Move};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::{Draw, machines};

const DENSITY: Density = Density {
    samples: 500,
    every_speed: true,
};

/// No limit at all, not even of the distances.
const NONE: LimitParameters = LimitParameters {
    rate_rad_s: None,
    acceleration_rad_s2: None,
    torque_nm: None,
    power_w: None,
    jerk_rad_s3: None,
    serial_distance_min: 0.0,
    parallel_distance_min: 0.0,
};

/// Random moves that are possible, with the extremes of each.
fn possible_moves(seed: u64) -> impl Iterator<Item = (Setting, Move<f64>, Extremes)> {
    let mut draw = Draw::new(seed);
    machines(seed).filter_map(move |case| {
        let (offered, period_s, ramp_ticks) = random_move(&case, &mut draw);
        let setting = Setting {
            parameters: case.parameters,
            limits: NONE,
            ramp: Ramp::fixed(ramp_ticks),
            period_s,
        };
        let found = extremes(&setting, &offered, DENSITY);
        let clear = found.possible && found.least_serial() > 0.01 && found.parallel > 0.01;
        clear.then_some((setting, offered, found))
    })
}

/// One limit, and the value that it is about.
struct Kind {
    what: Bounded,
    of: fn(&Extremes) -> [f64; 3],
    set: fn(&mut LimitParameters, [f64; 3]),
}

const MOTORS: [Kind; 4] = [
    Kind {
        what: Bounded::Rate,
        of: |at| at.rate,
        set: |limits, values| limits.rate_rad_s = Some(values),
    },
    Kind {
        what: Bounded::Acceleration,
        of: |at| at.acceleration,
        set: |limits, values| limits.acceleration_rad_s2 = Some(values),
    },
    Kind {
        what: Bounded::Torque,
        of: |at| at.torque,
        set: |limits, values| limits.torque_nm = Some(values),
    },
    Kind {
        what: Bounded::Power,
        of: |at| at.power,
        set: |limits, values| limits.power_w = Some(values),
    },
];

#[test]
fn a_motors_limit_is_named_where_it_is_first_broken() {
    let mut draw = Draw::new(5);
    for (setting, offered, found) in possible_moves(11).take(12) {
        for kind in &MOTORS {
            let greatest = (kind.of)(&found);
            if greatest.iter().any(|&value| value <= 0.0) {
                continue;
            }
            let with = |limits: [f64; 3]| {
                let mut setting = setting;
                (kind.set)(&mut setting.limits, limits);
                setting
            };
            // The samples miss the greatest power by less than this: between two of 100 speeds a
            // cubic of the speed bulges by less than 3 (1/100)^2 / 8 * 6 of its size.
            let kept = with(greatest.map(|value| value * 1.0005));
            assert_eq!(
                judge(&kept, &offered).verdict,
                Ok(()),
                "{kept:?} {offered:?}"
            );

            let motor = (draw.within(0.0, 3.0) as usize).min(2);
            let mut limits = greatest.map(|value| value * 2.0);
            limits[motor] = greatest[motor] * draw.within(0.3, 0.998);
            let broken = with(limits);
            let violation = judge(&broken, &offered).verdict.expect_err("broken");
            let label = format!("{violation:?}, motor {motor}, {broken:?} {offered:?}");
            assert_eq!(violation.what, kind.what, "{label}");
            assert_eq!(violation.index, Some(motor as u8), "{label}");
            assert_eq!(violation.limit, limits[motor], "{label}");
            let error = violation.error.expect("bounds");
            assert!(violation.certain, "{label}");
            assert!(violation.value - error > violation.limit, "{label}");

            // First beyond the limit, and first near it, by the samples.
            let mut beyond = None;
            let mut near = None;
            visit(&broken, &offered, DENSITY, &mut |at, extremes| {
                let value = (kind.of)(extremes)[motor];
                if value > limits[motor] * 0.999 {
                    near.get_or_insert(at);
                }
                if value > limits[motor] {
                    beyond.get_or_insert(at);
                }
                beyond.is_none()
            });
            let (near, beyond) = (near.expect("broken"), beyond.expect("broken"));
            let earliest = near - 1.0 / f64::from(DENSITY.samples) - 1.0 / 65536.0;
            assert!(
                (earliest..=beyond).contains(&violation.at),
                "{near} {beyond} {label}"
            );
        }
    }
}

#[test]
fn a_distance_is_named_where_it_is_first_broken() {
    for (setting, offered, found) in possible_moves(12).take(12) {
        for serial in [true, false] {
            let least = if serial {
                found.least_serial()
            } else {
                found.parallel
            };
            let with = |least: f64| {
                let mut setting = setting;
                if serial {
                    setting.limits.serial_distance_min = least;
                } else {
                    setting.limits.parallel_distance_min = least;
                }
                setting
            };
            assert_eq!(judge(&with(least * 0.999), &offered).verdict, Ok(()));
            let limit = least * 1.001;
            if limit >= 1.0 {
                continue;
            }
            let violation = judge(&with(limit), &offered).verdict.expect_err("broken");
            let label = format!("{violation:?} {least} {setting:?} {offered:?}");
            let mut beyond = None;
            visit(&setting, &offered, DENSITY, &mut |at, extremes| {
                let below = match serial {
                    true => extremes.serial.iter().position(|&value| value < limit),
                    false => (extremes.parallel < limit).then_some(0),
                };
                if let Some(leg) = below {
                    beyond.get_or_insert((at, leg));
                }
                beyond.is_none()
            });
            let (beyond, leg) = beyond.expect("broken");
            let (what, index) = match serial {
                true => (Bounded::SerialDistance, Some(leg as u8)),
                false => (Bounded::ParallelDistance, None),
            };
            assert_eq!((violation.what, violation.index), (what, index), "{label}");
            assert_eq!(
                violation.shortest, None,
                "no speed changes the path: {label}"
            );
            assert!(violation.value < limit && violation.value > 0.0, "{label}");
            let earliest = beyond - 1.0 / f64::from(DENSITY.samples) - 2.0 / 65536.0;
            assert!(
                (earliest..=beyond).contains(&violation.at),
                "{beyond} {label}"
            );
        }
    }
}

/// What is within limits at normal speed but not on the ramp of a hold is told apart.
#[test]
fn a_violation_says_whether_it_takes_a_ramp() {
    let mut seen = [0, 0];
    for (setting, offered, found) in possible_moves(13).take(15) {
        let mut steady = setting;
        // A ramp so slow that it changes nothing.
        steady.ramp = Ramp::fixed(u16::MAX);
        steady.period_s = setting.period_s;
        let quiet = extremes(&steady, &offered, DENSITY);
        for (kind, motor) in [(&MOTORS[1], 0), (&MOTORS[2], 1)] {
            let (with_ramp, without) = ((kind.of)(&found)[motor], (kind.of)(&quiet)[motor]);
            if with_ramp < 1.05 * without {
                continue;
            }
            for (limit, ramp) in [((with_ramp + without) / 2.0, true), (without / 1.1, false)] {
                let mut limits = [f64::MAX; 3];
                limits[motor] = limit;
                let mut setting = setting;
                (kind.set)(&mut setting.limits, limits);
                let violation = judge(&setting, &offered).verdict.expect_err("broken");
                assert_eq!(violation.what, kind.what, "{violation:?}");
                if ramp {
                    assert!(violation.ramp, "{violation:?} {setting:?} {offered:?}");
                }
                seen[usize::from(violation.ramp)] += 1;
            }
        }
    }
    assert!(seen[0] > 3 && seen[1] > 5, "{seen:?}");
}
