//! Inputs without a motion, targets that are reached already, and a target that moves on.

use crate::drawn::Setting;
use crate::drawn::setpoint;
use crate::judge::largest_part;
use crate::session::{at_tick, moves, outcome, path};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::Bounded;
use trirrr_service::admission::{Blocked, Retarget, Retargeted};
use trirrr_tests::instant::{Coordinates, Instant, State};
use trirrr_tests::random::share;

const START: Coordinates = [0.25, 0.27, 0.3];

fn thesis() -> Setting {
    let parameters = example();
    let at_rest = State {
        pose: START,
        ..State::default()
    };
    Setting {
        parameters,
        limits: LimitParameters {
            rate_rad_s: Some([4.0; 3]),
            acceleration_rad_s2: Some([60.0; 3]),
            torque_nm: Some([0.3; 3]),
            ..LimitParameters::default()
        },
        period_s: 1e-3,
        start: START,
        turn: 0.5,
        reach: 0.4,
        side: Instant::of(&parameters, &at_rest).side,
    }
}

fn at(pose: Coordinates, velocity: Coordinates) -> Setpoint<f64> {
    setpoint(&State {
        pose,
        velocity,
        ..State::default()
    })
}

fn retarget(start: &Setpoint<f64>, target: &Setpoint<f64>) -> Retarget<Dynamic<f64>> {
    Retarget::over(path(&thesis()), start, target)
}

fn refusal(start: &Setpoint<f64>, target: &Setpoint<f64>) -> (Blocked, Bounded) {
    let mut retarget = retarget(start, target);
    let (Retargeted::Refused(refusal), _) = outcome(&mut retarget) else {
        panic!("a motion from {start:?} to {target:?}");
    };
    assert_eq!(retarget.planned(0), None);
    (refusal.blocked, refusal.violation.what)
}

#[test]
fn the_state_itself_is_a_target_without_moves() {
    let start = at(START, [0.1, -0.05, 0.2]);
    let mut retarget = retarget(&start, &start);
    assert_eq!(outcome(&mut retarget).0, Retargeted::Planned(0));
    assert_eq!(retarget.planned(0), None);
}

#[test]
fn what_is_no_number_is_refused() {
    let good = at(START, [0.0; 3]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut pose = START;
            pose[axis] = bad;
            let mut velocity = [0.0; 3];
            velocity[axis] = bad;
            let mut accelerated = good;
            accelerated.acceleration[axis] = bad;
            for bad in [at(pose, [0.0; 3]), at(START, velocity), accelerated] {
                assert_eq!(refusal(&good, &bad), (Blocked::Target, Bounded::Range));
                assert_eq!(refusal(&bad, &good), (Blocked::Start, Bounded::Range));
            }
        }
    }
}

#[test]
fn states_beyond_limits_are_refused_by_name() {
    let start = at(START, [0.0; 3]);
    let far = at([1.0, 0.27, 0.3], [0.0; 3]);
    assert_eq!(refusal(&start, &far), (Blocked::Target, Bounded::Reach));
    let fast = at([0.26, 0.27, 0.3], [5.0, 0.0, 0.0]);
    assert_eq!(refusal(&start, &fast), (Blocked::Target, Bounded::Rate));
    assert_eq!(refusal(&fast, &start), (Blocked::Start, Bounded::Rate));
    // The platform turned until det A has the other sign.
    let side = |turn: f64| {
        let pose = [START[0], START[1], turn];
        let state = State {
            pose,
            ..State::default()
        };
        Instant::of(&example(), &state)
    };
    let turn = (1..300)
        .map(|step| f64::from(step) * 0.01)
        .find(|&turn| side(turn).side != thesis().side && side(turn).parallel > 0.02)
        .expect("another side");
    let turned = at([START[0], START[1], turn], [0.0; 3]);
    assert_eq!(
        refusal(&start, &turned),
        (Blocked::Target, Bounded::ParallelDistance)
    );
}

/// A circle, a new target every 20 ms, each from the state in which the last motion is by then.
#[test]
fn a_moving_target_is_followed() {
    let setting = thesis();
    let mut state = at(START, [0.0; 3]);
    let mut follow = retarget(&state, &state);
    let (mut farthest, mut most) = (0.0f64, 0.0f64);
    for step in 0..share(4000) {
        let (sin, cos) = (f64::from(step) * 0.02 * 1.5).sin_cos();
        let pose = [0.25 + 0.04 * cos, 0.27 + 0.04 * sin, 0.3 + 0.1 * sin];
        let target = at(pose, [-0.06 * sin, 0.06 * cos, 0.15 * cos]);
        follow.aim(&state, &target);
        let (Retargeted::Planned(_), _) = outcome(&mut follow) else {
            panic!("{step}: {:?}", outcome(&mut follow).0);
        };
        let chain = moves(&follow);
        most = most.max(largest_part(&setting, [&state, &target], &chain, 50));
        let ticks: u32 = chain.iter().map(|each| each.common.ticks).sum();
        state = at_tick(&chain, ticks.min(20), setting.period_s);
        if step > 100 {
            let off = state.pose.displacement(&target.pose);
            farthest = farthest.max(off.xy().norm());
        }
    }
    println!("largest part of a limit {most:.6}, farthest {farthest:.6} m");
    assert!(most <= 1.0, "{most}");
    assert!(farthest < 1e-3, "{farthest}");
}
