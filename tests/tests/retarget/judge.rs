//! Judgement of planned motions and of refusals by the independent model.

use crate::drawn::Setting;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::QuinticMove;
use trirrr_service::admission::{Blocked, RetargetRefusal};
use trirrr_tests::instant::{Coordinates, QuinticEnds, State};

pub(crate) fn coordinates(pose: &Pose<f64>) -> Coordinates {
    [pose.position.x, pose.position.y, pose.angle]
}

pub(crate) fn state(setpoint: &Setpoint<f64>) -> State {
    State {
        pose: coordinates(&setpoint.pose),
        velocity: setpoint.velocity.into(),
        acceleration: setpoint.acceleration.into(),
    }
}

/// Checks that the moves lead from `start` to `target` in one chain, and returns the largest part of a limit at so many
/// instants.
pub(crate) fn largest_part(
    setting: &Setting,
    [start, target]: [&Setpoint<f64>; 2],
    moves: &[QuinticMove<f64>],
    samples: u32,
) -> f64 {
    let ends = |each: &QuinticMove<f64>| {
        let common = &each.common;
        [
            State {
                pose: coordinates(&common.from),
                velocity: common.start_velocity,
                acceleration: each.start_acceleration,
            },
            State {
                pose: coordinates(&common.to),
                velocity: common.end_velocity,
                acceleration: each.end_acceleration,
            },
        ]
    };
    let ticks: u32 = moves.iter().map(|each| each.common.ticks).sum();
    let (mut at, mut most) = (state(start), 0.0f64);
    for each in moves {
        let states = ends(each);
        assert_eq!(states[0], at, "a chain");
        at = states[1];
        let quintic = QuinticEnds {
            states,
            duration_s: f64::from(each.common.ticks) * setting.period_s,
        };
        let own = samples * each.common.ticks / ticks + 2;
        for sample in 0..=own {
            let state = quintic.at(f64::from(sample) / f64::from(own));
            most = most.max(setting.part(&state));
        }
    }
    assert_eq!(at, state(target), "the target");
    most
}

/// Returns true if a refusal is true: something does break a limit, but for `room` of it.
pub(crate) fn is_true(
    setting: &Setting,
    [start, target]: [&Setpoint<f64>; 2],
    refusal: &RetargetRefusal<f64>,
) -> bool {
    let broken = |state: &State| setting.part(state) >= 1.0 - 1e-6;
    match refusal.blocked {
        Blocked::Start => broken(&state(start)),
        Blocked::Target => broken(&state(target)),
        Blocked::Stop => !stops(setting, &state(start)),
        Blocked::Arrival => {
            let target = state(target);
            let reversed = target.velocity.map(|v| -v);
            !stops(
                setting,
                &State {
                    velocity: reversed,
                    ..target
                },
            )
        }
        Blocked::Way => {
            let [from, to] = refusal.way.map(|pose| coordinates(&pose));
            (0..=2000).any(|sample| {
                let part = f64::from(sample) / 2000.0;
                let pose = core::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * part);
                broken(&State {
                    pose,
                    ..State::default()
                })
            })
        }
    }
}

/// Looks for a motion to rest in many durations: with a deceleration that rises, stays and falls, more or less
/// suddenly, over whole ticks.
fn stops(setting: &Setting, start: &State) -> bool {
    let mut durations: Vec<u32> = (0..200)
        .map(|step| (2.0 * 1.08f64.powi(step)) as u32)
        .collect();
    durations.dedup();
    durations
        .into_iter()
        .filter(|ticks| f64::from(*ticks) * setting.period_s < 100.0)
        .any(|ticks| {
            [0.02, 0.1, 0.2, 0.35, 0.5].into_iter().any(|part| {
                let ramp = (part * f64::from(ticks)).floor().max(1.0);
                let duration_s = f64::from(ticks) * setting.period_s;
                let keeps = |step: u32| {
                    let at = f64::from(step) / 100.0;
                    let state = braking(start, duration_s, ramp / f64::from(ticks), at);
                    setting.part(&state) < 0.999
                };
                // The middle and the start break most.
                [50, 20, 80, 5].into_iter().all(keeps) && (0..=100).all(keeps)
            })
        })
}

/// State after the fraction `at` of a motion to rest, whose acceleration goes to a constant in `part` of the duration,
/// stays, and goes to zero in as long; integrated step by step.
fn braking(start: &State, duration_s: f64, part: f64, at: f64) -> State {
    let mut state = *start;
    let ramp = part * duration_s;
    for axis in 0..3 {
        let (v0, a0) = (start.velocity[axis], start.acceleration[axis]);
        let hold = -(v0 + 0.5 * a0 * ramp) / (duration_s - ramp);
        let acceleration = |t: f64| {
            if t < ramp {
                a0 + (hold - a0) * t / ramp
            } else if t < duration_s - ramp {
                hold
            } else {
                hold * (duration_s - t) / ramp
            }
        };
        // Simpson's rule, exact but for the bends.
        let steps = 60;
        let h = at * duration_s / f64::from(steps);
        let (mut way, mut v) = (0.0, v0);
        for step in 0..steps {
            let t = f64::from(step) * h;
            let [a, b, c] = [t, t + 0.5 * h, t + h].map(acceleration);
            let middle = v + h * (5.0 * a + 8.0 * b - c) / 24.0;
            let end = v + h * (a + 4.0 * b + c) / 6.0;
            way += h * (v + 4.0 * middle + end) / 6.0;
            v = end;
        }
        state.pose[axis] = start.pose[axis] + way;
        state.velocity[axis] = v;
        state.acceleration[axis] = acceleration(at * duration_s);
    }
    state
}
