//! Limits of jerk: the independent model's third derivatives, at paces of a hold, and jumps of the acceleration.

use crate::judge::{Setting, judge};
use crate::moves::{bent, in_type, random_move};
use crate::thesis_move;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_protocol::message::{AnyMove, Bounded, LeastDuration, Move};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::{Draw, machines};
use trirrr_tests::instant::{Instant, QuinticEnds, State, jerks};
use trirrr_tests::random::share;

/// Largest jerk of each motor at so many instants, at paces from rest to normal speed that change at the ramp's rate; none
/// where the motion is not clear of singularities.
fn greatest(setting: &Setting, offered: &AnyMove<f64>, samples: u32) -> Option<[f64; 3]> {
    let common = offered.common();
    let [start, end] = offered.accelerations()?;
    let pose = |at: &trirrr_core::setpoint::Pose<f64>| [at.position.x, at.position.y, at.angle];
    let state = |pose, velocity, acceleration| State {
        pose,
        velocity,
        acceleration,
    };
    let quintic = QuinticEnds {
        states: [
            state(pose(&common.from), common.start_velocity, start),
            state(pose(&common.to), common.end_velocity, end),
        ],
        duration_s: f64::from(common.ticks) * setting.period_s,
    };
    let ramp = 1.0 / (f64::from(setting.ramp.ticks) * setting.period_s);
    let (mut most, mut side) = ([0.0f64; 3], None);
    for sample in 0..=samples {
        let part = f64::from(sample) / f64::from(samples);
        let state = quintic.at(part);
        let instant = Instant::kinematics(&setting.parameters, &state);
        let clear = instant.parallel > 0.02 && instant.serial.iter().all(|&serial| serial > 0.02);
        if !clear || *side.get_or_insert(instant.side) != instant.side {
            return None;
        }
        let steady = jerks(&setting.parameters, &state, quintic.jerk_at(part));
        for motor in 0..3 {
            for percent in 0..=100 {
                let u = f64::from(percent) / 100.0;
                for slope in [ramp, -ramp] {
                    let jerk =
                        u * (steady[motor] * u * u + 3.0 * instant.acceleration[motor] * slope);
                    most[motor] = most[motor].max(jerk.abs());
                }
            }
        }
    }
    Some(most)
}

/// Random quintics with a limit of jerk about what they need.
struct Tally {
    kept: u32,
    broken: u32,
    refused: f64,
}

fn study(count: usize, samples: u32) -> Tally {
    let mut draw = Draw::new(61);
    let mut tally = Tally {
        kept: 0,
        broken: 0,
        refused: 0.0,
    };
    for case in machines(67).take(count) {
        let (cubic, period_s, ramp_ticks) = random_move(&case, &mut draw);
        let offered = bent(&cubic, period_s, &mut draw);
        let mut setting = Setting {
            parameters: case.parameters,
            limits: LimitParameters::default(),
            ramp: Ramp::fixed(ramp_ticks),
            period_s,
        };
        let Some(most) = greatest(&setting, &offered, samples) else {
            continue;
        };
        let away = draw.log_within(1e-6, 1.0);
        let kept = draw.chance(0.5);
        let part = if kept { 1.0 + away } else { 1.0 / (1.0 + away) };
        setting.limits.jerk_rad_s3 = Some(most.map(|most| part * most));
        match (judge(&setting, offered).verdict, kept) {
            (Ok(()), true) => tally.kept += 1,
            (Ok(()), false) => panic!("{away} beyond: {setting:?} {offered:?}"),
            (Err(violation), true) => {
                // At rest, and there alone, the acceleration may not begin.
                match violation.what {
                    Bounded::AccelerationJump => {}
                    _ => tally.refused = tally.refused.max(away),
                }
            }
            (Err(violation), false) => {
                let what = violation.what;
                let jerk = what == Bounded::Jerk || what == Bounded::AccelerationJump;
                assert!(jerk, "{violation:?}");
                tally.broken += 1;
            }
        }
    }
    let Tally {
        kept,
        broken,
        refused,
    } = tally;
    println!(
        "{kept} kept and admitted, {broken} broken and refused, kept by {refused:e} and refused at most"
    );
    tally
}

#[test]
fn a_limit_of_jerk_is_kept_between_samples_and_paces() {
    let Tally {
        kept,
        broken,
        refused,
    } = study(share(400) as usize, 500);
    assert!(
        kept >= share(50) && broken >= share(50) && refused < 1e-3,
        "{kept} {broken} {refused}"
    );
}

#[test]
#[ignore = "takes minutes"]
fn a_limit_of_jerk_is_kept_by_ten_thousand_moves() {
    study(10_000, 2_000);
}

fn thesis_setting(jerk: f64) -> Setting {
    Setting {
        parameters: example(),
        limits: LimitParameters {
            jerk_rad_s3: Some([jerk; 3]),
            ..LimitParameters::default()
        },
        ramp: Ramp::within(100, None),
        period_s: 0.001,
    }
}

/// A cubic from rest begins with a jump of the acceleration.
#[test]
fn a_cubic_from_rest_is_refused_for_its_jump() {
    let cubic = thesis_move::<f64>(1000);
    for (jerk, at) in [(10.0, 0.0), (1e5, 0.0)] {
        let verdict = judge(&thesis_setting(jerk), &cubic).verdict;
        let violation = verdict.expect_err("a jump");
        assert_eq!(
            (violation.what, violation.at),
            (Bounded::AccelerationJump, at)
        );
        assert!(violation.certain && !violation.ramp);
        assert!((violation.limit - 1e-3 / 256.0 * jerk).abs() < 1e-9 * jerk);
    }
    let smooth = AnyMove::new(cubic, Some([[0.0; 3]; 2]));
    assert_eq!(judge(&thesis_setting(1e4), smooth).verdict, Ok(()));
    // From a velocity it has no jump where it runs on evenly, and none where it stands.
    let way = cubic.from.displacement(&cubic.to);
    let even = Move {
        start_velocity: way.into(),
        end_velocity: way.into(),
        ..cubic
    };
    assert_eq!(judge(&thesis_setting(1e4), &even).verdict, Ok(()));
    let wait = Move {
        to: cubic.from,
        ..cubic
    };
    assert_eq!(judge(&thesis_setting(1e-3), &wait).verdict, Ok(()));
}

/// A quintic may not come to rest with an acceleration: what is behind it may never come.
#[test]
fn a_quintic_does_not_end_at_rest_with_an_acceleration() {
    let smooth = thesis_move::<f64>(1000);
    let bent = AnyMove::new(smooth, Some([[0.0; 3], [0.1, 0.0, 0.0]]));
    let violation = judge(&thesis_setting(1e4), bent)
        .verdict
        .expect_err("a jump");
    assert_eq!(
        (violation.what, violation.at),
        (Bounded::AccelerationJump, 1.0)
    );
}

/// A refusal for jerk names the shortest duration, in all number types.
#[test]
fn the_shortest_duration_keeps_the_jerk() {
    fn of<N: trirrr_service::admission::Enclose>(setting: &Setting) -> (Bounded, LeastDuration) {
        let offered = |ticks| {
            let smooth = AnyMove::new(thesis_move::<f64>(ticks), Some([[0.0; 3]; 2]));
            in_type::<N>(&smooth)
        };
        let violation = judge(setting, offered(300)).verdict.expect_err("too fast");
        let shortest = violation.shortest.expect("slower would do");
        assert_eq!(judge(setting, offered(shortest.enough)).verdict, Ok(()));
        assert!(
            judge(setting, offered(shortest.enough - 1))
                .verdict
                .is_err()
        );
        (violation.what, shortest)
    }
    let setting = thesis_setting(40.0);
    let (what, exact) = of::<f64>(&setting);
    assert_eq!(what, Bounded::Jerk);
    let (what, short) = of::<f32>(&setting);
    assert_eq!(what, Bounded::Jerk);
    assert!(
        short.enough.abs_diff(exact.enough) <= 1,
        "{short:?} {exact:?}"
    );
}
