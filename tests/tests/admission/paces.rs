//! Rates of a hold: those that the admission finds keep the limits, and hardly more would.

use crate::dense::{Density, extremes, visit_paced};
use crate::judge::{Judged, Setting, judge};
use crate::moves::{bent, random_move};
use trirrr_core::limits::LimitParameters;
use trirrr_protocol::message::AnyMove;
use trirrr_service::paces::{Pace, Ramp};
use trirrr_tests::draw::{Draw, machines};
use trirrr_tests::random::share;

/// Limits that are as near to what the move needs at a constant pace.
fn limited(setting: &mut Setting, offered: &AnyMove<f64>, draw: &mut Draw) -> bool {
    let density = Density {
        samples: 300,
        every_speed: false,
    };
    let mut steady = *setting;
    steady.ramp = Ramp::fixed(u16::MAX);
    steady.period_s = setting.period_s;
    let found = extremes(&steady, *offered, density);
    if !found.possible {
        return false;
    }
    let mut motors = |values: [f64; 3]| {
        let good = values.iter().all(|&value| value > 0.0);
        (good && draw.chance(0.6))
            .then(|| values.map(|value| value * (1.0 + draw.log_within(0.01, 3.0))))
    };
    setting.limits = LimitParameters {
        serial_distance_min: 0.0,
        parallel_distance_min: 0.0,
        rate_rad_s: motors(found.rate),
        acceleration_rad_s2: motors(found.acceleration),
        torque_nm: motors(found.torque),
        power_w: motors(found.power),
        jerk_rad_s3: None,
    };
    true
}

/// Of random moves with limits a hundredth to three times above what a constant pace needs: the tick keeps them at every
/// instant, at the rates proven there and every pace. Most moves would break a limit with the ramp's own rate.
#[test]
fn proven_rates_keep_the_limits() {
    let mut draw = Draw::new(41);
    let (mut admitted, mut lowered, mut parts) = (0, 0, 0);
    for (index, case) in machines(43).take(share(450) as usize).enumerate() {
        let (cubic, period_s, ramp_ticks) = random_move(&case, &mut draw);
        let offered = match index % 2 {
            0 => AnyMove::from(&cubic),
            _ => bent(&cubic, period_s, &mut draw),
        };
        let mut setting = Setting {
            parameters: case.parameters,
            limits: LimitParameters::default(),
            ramp: Ramp::within(ramp_ticks, None),
            period_s,
        };
        if !limited(&mut setting, &offered, &mut draw) {
            continue;
        }
        let Judged { verdict, paces, .. } = judge(&setting, offered);
        if verdict.is_err() {
            continue;
        }
        admitted += 1;
        let ticks = offered.common().ticks;
        let found = visit_paced(&setting, &offered, &paces, 400);
        // Powers are greatest between the paces that are looked at, by less than this.
        assert!(
            found.excess(&setting) < 1e-9,
            "{setting:?} {offered:?} {paces:?}"
        );
        let all = (0..ticks.min(1000)).map(|tick| paces.at(ticks, tick));
        parts += all.clone().count();
        lowered += all.filter(|pace| *pace != Pace::FULL).count();
    }
    println!("{admitted} admitted; {lowered} of {parts} ticks have lower rates");
    assert!(admitted > share(100) && lowered * 4 > parts && lowered < parts);
}
