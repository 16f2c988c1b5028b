//! The shortest duration that would pass: it passes, and what is shorter does not.

use crate::dense::{Density, extremes};
use crate::judge::{Setting, judge};
use crate::moves::random_move;
use trirrr_core::limits::LimitParameters;
use trirrr_protocol::message::{Bounded, LeastDuration, Move};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::{Draw, machines, within_a_turn};

const DENSITY: Density = Density {
    samples: 500,
    every_speed: false,
};

/// Moves that are too fast by a random factor for the limits of their machine.
fn too_fast(seed: u64, rest: bool) -> impl Iterator<Item = (Setting, Move<f64>)> {
    let mut draw = Draw::new(seed);
    machines(seed).filter_map(move |case| {
        let case = within_a_turn(&case);
        let (mut offered, period_s, mut ramp_ticks) = random_move(&case, &mut draw);
        if !rest {
            // Slow at the ends, so that it is the way between that is too fast.
            for velocity in [&mut offered.start_velocity, &mut offered.end_velocity] {
                *velocity = velocity.map(|component| 0.2 * component);
            }
            ramp_ticks = ramp_ticks.saturating_mul(10);
        }
        let mut setting = Setting {
            parameters: case.parameters,
            limits: LimitParameters::default(),
            ramp: Ramp::fixed(ramp_ticks),
            period_s,
        };
        let found = extremes(&setting, &offered, DENSITY);
        if offered.is_rest_to_rest() != rest || !found.possible || found.excess(&setting) > 0.0 {
            return None;
        }
        let mut limit = |values: [f64; 3]| {
            let least = values.iter().all(|&value| value > 0.0);
            let factor = draw.log_within(if rest { 0.02 } else { 0.4 }, 0.9);
            (least && draw.chance(0.5)).then(|| values.map(|value| value * factor))
        };
        setting.limits.rate_rad_s = limit(found.rate);
        setting.limits.acceleration_rad_s2 = limit(found.acceleration);
        setting.limits.torque_nm = limit(found.torque);
        setting.limits.power_w = limit(found.power);
        judge(&setting, &offered)
            .verdict
            .is_err()
            .then_some((setting, offered))
    })
}

fn lasting(offered: &Move<f64>, ticks: u32) -> Move<f64> {
    Move { ticks, ..*offered }
}

#[test]
fn from_rest_to_rest_it_is_the_shortest_of_all() {
    let (mut some, mut none, mut exact) = (0, 0, 0);
    for (setting, offered) in too_fast(21, true).take(60) {
        let violation = judge(&setting, &offered).verdict.expect_err("too fast");
        let label = format!("{violation:?} {setting:?} {offered:?}");
        let Some(LeastDuration {
            enough: shortest,
            too_short,
        }) = violation.shortest
        else {
            // What the machine cannot even hold still, or no duration in reach is slow enough for.
            let slow = lasting(&offered, offered.ticks * 200);
            let excess = extremes(&setting, &slow, DENSITY).excess(&setting);
            assert!(excess > -0.01, "{excess} {label}");
            none += 1;
            continue;
        };
        some += 1;
        let excess =
            |ticks| extremes(&setting, &lasting(&offered, ticks), DENSITY).excess(&setting);
        assert!(shortest > offered.ticks, "{label}");
        assert!((offered.ticks..shortest).contains(&too_short), "{label}");
        assert!(excess(too_short) > 0.0, "{label}");
        exact += u32::from(too_short + 1 == shortest);
        assert_eq!(
            judge(&setting, &lasting(&offered, shortest)).verdict,
            Ok(()),
            "{label}"
        );
        assert!(
            judge(&setting, &lasting(&offered, shortest - 1))
                .verdict
                .is_err(),
            "{label}"
        );
        // By the samples alone: one hundredth shorter is too fast.
        let shorter = shortest - shortest / 100 - 1;
        assert!(excess(shortest) <= 0.0, "{label}");
        assert!(shorter < offered.ticks || excess(shorter) > 0.0, "{label}");
        // And every longer one passes.
        for longer in [
            shortest + 1,
            shortest + shortest / 3,
            shortest.saturating_mul(7),
        ] {
            assert_eq!(
                judge(&setting, &lasting(&offered, longer)).verdict,
                Ok(()),
                "{label}"
            );
        }
    }
    println!("{exact} of {some} durations are exact");
    assert!(some > 20 && none > 3, "{some} {none}");
    assert!(exact * 10 > some * 9, "{exact} of {some}");
}

#[test]
fn with_end_velocities_it_passes_and_one_tick_less_does_not() {
    let (mut some, mut none) = (0, 0);
    for (setting, offered) in too_fast(22, false).take(60) {
        let violation = judge(&setting, &offered).verdict.expect_err("too fast");
        let Some(LeastDuration {
            enough: shortest, ..
        }) = violation.shortest
        else {
            none += 1;
            for times in [2, 5, 20] {
                let slow = lasting(&offered, offered.ticks * times);
                assert!(
                    judge(&setting, &slow).verdict.is_err(),
                    "{times} {violation:?}"
                );
            }
            continue;
        };
        some += 1;
        let label = format!("{violation:?} {setting:?} {offered:?}");
        assert_eq!(
            judge(&setting, &lasting(&offered, shortest)).verdict,
            Ok(()),
            "{label}"
        );
        assert!(
            judge(&setting, &lasting(&offered, shortest - 1))
                .verdict
                .is_err(),
            "{label}"
        );
    }
    // Velocities at the ends that are too fast by themselves leave none.
    assert!(some > 3 && none > 3, "{some} {none}");
}

/// On the thesis machine the rates of a move from rest to rest go with 1 / T, and its accelerations
/// with 1 / T^2 where holds are too slow to count.
#[test]
fn it_scales_as_the_formulas_say() {
    let offered = crate::thesis_move::<f64>(100);
    let mut setting = Setting {
        parameters: trirrr_tests::machines::thesis(),
        limits: LimitParameters::default(),
        ramp: Ramp::fixed(u16::MAX),
        period_s: 0.01,
    };
    let dense = Density {
        samples: 20_000,
        every_speed: false,
    };
    let found = extremes(&setting, &offered, dense);
    let shortest = |setting: &Setting| {
        let violation = judge(setting, &offered).verdict.expect_err("too fast");
        (violation.what, violation.shortest.map(|found| found.enough))
    };
    let greatest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
    setting.limits.rate_rad_s = Some([greatest(found.rate) / 4.321; 3]);
    assert_eq!(shortest(&setting), (Bounded::Rate, Some(433)));
    setting.limits.rate_rad_s = None;
    setting.limits.acceleration_rad_s2 = Some([greatest(found.acceleration) / 4.321; 3]);
    // sqrt(4.321) = 2.0787; the slowest ramp that there is, 655 s, adds less than a thousandth.
    assert_eq!(shortest(&setting), (Bounded::Acceleration, Some(208)));
    setting.limits.acceleration_rad_s2 = None;
    setting.limits.power_w = Some([greatest(found.power) / 4.321; 3]);
    // The third root of 4.321 is 1.6288.
    assert_eq!(shortest(&setting), (Bounded::Power, Some(163)));
}

/// A vertical machine that cannot carry its platform: no duration helps.
#[test]
fn a_load_at_rest_leaves_none() {
    let parameters =
        trirrr_tests::machines::under_gravity_and_wrench(trirrr_tests::machines::thesis());
    let setting = Setting {
        parameters,
        limits: LimitParameters {
            torque_nm: Some([0.05; 3]),
            ..LimitParameters::default()
        },
        ramp: Ramp::fixed(10),
        period_s: 0.01,
    };
    let violation = judge(&setting, &crate::thesis_move::<f64>(100))
        .verdict
        .expect_err("too heavy");
    assert_eq!(
        (violation.what, violation.shortest),
        (Bounded::Torque, None)
    );
}
