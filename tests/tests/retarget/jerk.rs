//! Retargets within limits of jerk, judged by the third derivatives of the independent model.

use crate::drawn::{Setting, setpoint};
use crate::judge::{coordinates, state};
use crate::session::{at_tick, moves, outcome, path};
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::QuinticMove;
use trirrr_service::admission::{Retarget, Retargeted};
use trirrr_tests::draw::{Draw, machines};
use trirrr_tests::instant::{QuinticEnds, State, jerks};
use trirrr_tests::random::share;

/// Counts of a machine's retargets.
#[derive(Default)]
struct Tally {
    /// From rest, planned without a limit of jerk.
    free: u32,
    /// Of these, planned with one.
    planned: u32,
    /// From a motion under way.
    moving: u32,
    /// Of these, planned.
    cut: u32,
    /// Largest part of a limit of jerk.
    largest: f64,
}

/// Largest part of a limit of jerk along `moves`.
fn part_of_jerk(setting: &Setting, moves: &[QuinticMove<f64>]) -> f64 {
    let limits = setting.limits.jerk_rad_s3.expect("a limit");
    let mut most = 0.0f64;
    for each in moves {
        let common = &each.common;
        let end = |pose, velocity, acceleration| State {
            pose: coordinates(pose),
            velocity,
            acceleration,
        };
        let quintic = QuinticEnds {
            states: [
                end(&common.from, common.start_velocity, each.start_acceleration),
                end(&common.to, common.end_velocity, each.end_acceleration),
            ],
            duration_s: f64::from(common.ticks) * setting.period_s,
        };
        for sample in 0..=200 {
            let part = f64::from(sample) / 200.0;
            let found = jerks(
                &setting.parameters,
                &quintic.at(part),
                quintic.jerk_at(part),
            );
            for (jerk, limit) in found.into_iter().zip(limits) {
                most = most.max(jerk.abs() / limit);
            }
        }
    }
    most
}

struct Session<'a> {
    setting: &'a Setting,
    limited: &'a Setting,
    draw: &'a mut Draw,
}

impl ModelVisitor<f64> for Session<'_> {
    type Output = Tally;

    fn visit<M: Model<N = f64>>(self) -> Tally {
        let Self {
            setting,
            limited,
            draw,
        } = self;
        let mut tally = Tally::default();
        let rest = |pose| State {
            pose,
            ..State::default()
        };
        let aim = |setting: &Setting, [from, to]: [&Setpoint<f64>; 2]| {
            let mut retarget = Retarget::<M>::over(path::<M>(setting), from, to);
            match outcome(&mut retarget).0 {
                Retargeted::Planned(_) => Some(moves(&retarget)),
                _ => None,
            }
        };
        for _ in 0..4 {
            let start = setpoint(&rest(setting.start));
            let target = setpoint(&rest(setting.target(setting.start, draw).pose));
            if aim(setting, [&start, &target]).is_none_or(|moves| moves.is_empty()) {
                continue;
            }
            tally.free += 1;
            let Some(moves) = aim(limited, [&start, &target]) else {
                println!("{:?} {start:?} {target:?}", limited.limits);
                continue;
            };
            tally.planned += 1;
            tally.largest = tally.largest.max(part_of_jerk(limited, &moves));
            let ticks: u32 = moves.iter().map(|each| each.common.ticks).sum();
            let from = at_tick(
                &moves,
                (draw.within(0.1, 0.9) * f64::from(ticks)) as u32,
                setting.period_s,
            );
            let back = setpoint(&rest(setting.target(state(&from).pose, draw).pose));
            tally.moving += 1;
            if let Some(moves) = aim(limited, [&from, &back]) {
                tally.cut += 1;
                tally.largest = tally.largest.max(part_of_jerk(limited, &moves));
            }
        }
        tally
    }
}

#[test]
fn retargets_keep_limits_of_jerk() {
    let mut draw = Draw::new(71);
    let mut all = Tally::default();
    let settings =
        machines(73).filter_map(|case| Setting::draw(&case, &mut Draw::new(case.size.to_bits())));
    for setting in settings.take(share(80) as usize) {
        let acceleration = setting.limits.acceleration_rad_s2.unwrap_or([100.0; 3]);
        let per_time = draw.log_within(3.0, 300.0);
        let mut limited = setting.clone();
        limited.limits.jerk_rad_s3 = Some(acceleration.map(|limit| per_time * limit));
        let session = Session {
            setting: &setting,
            limited: &limited,
            draw: &mut draw,
        };
        let tally = ModelKind::of(&setting.parameters, true).visit(session);
        all.free += tally.free;
        all.planned += tally.planned;
        all.moving += tally.moving;
        all.cut += tally.cut;
        all.largest = all.largest.max(tally.largest);
    }
    let Tally {
        free,
        planned,
        moving,
        cut,
        largest,
    } = all;
    println!(
        "from rest {planned} of {free} planned, from a motion {cut} of {moving}; largest part of a jerk {largest:.9}"
    );
    assert!(largest <= 1.0 && largest > 0.9, "{largest}");
    assert_eq!(planned, free);
    assert!(2 * cut > moving, "{cut} of {moving}");
}
