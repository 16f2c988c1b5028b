//! Follows a target that moves on a circle: every 20 ms a new target, from the state in which the last motion is by then.
//! Then compares motions from rest to rest with the lower bound of any motion along the straight way.
//!
//! `cargo run --release -p trirrr-plan --example follow -- 1000`; the argument is the number of motions from rest to rest.

use std::error::Error;
use std::time::Instant;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::{Ends, Pose, Quintics, Segment, Setpoint};
use trirrr_plan::cell::Planner;
use trirrr_plan::course::{Effort, PathPiece, plan};
use trirrr_plan::piece::Piece;
use trirrr_service::admission::{Path, Retarget, Retargeted};
use trirrr_service::paces::Ramp;

type Machine = Dynamic<f64>;

const PERIOD_S: f64 = 1e-3;
/// Ticks from one target to the next.
const EVERY: u32 = 20;
const TARGETS: u32 = 1000;
/// Ticks of a hold where the limits leave room.
const RAMP_TICKS: u16 = 100;

fn setpoint(pose: [f64; 3], velocity: [f64; 3]) -> Setpoint<f64> {
    let [x, y, alpha] = pose;
    Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: velocity.into(),
        acceleration: [0.0; 3].into(),
    }
}

/// Plans a motion; returns its number of moves and its steps.
fn planned(retarget: &mut Retarget<Machine>) -> Result<(usize, u32), String> {
    let mut steps = 1;
    loop {
        match retarget.step() {
            Retargeted::Undecided => steps += 1,
            Retargeted::Planned(moves) => return Ok((moves, steps)),
            Retargeted::Refused(refusal) => return Err(format!("{refusal:?}")),
        }
    }
}

fn ticks(retarget: &Retarget<Machine>, moves: usize) -> u32 {
    let each = (0..moves).filter_map(|index| retarget.planned(index));
    each.map(|each| each.common.ticks).sum()
}

/// The state so many ticks after the start of the planned motion, or at its end.
fn state_after(retarget: &Retarget<Machine>, moves: usize, mut tick: u32) -> Option<Setpoint<f64>> {
    let mut state = None;
    for each in (0..moves).filter_map(|index| retarget.planned(index)) {
        let common = each.common;
        let ends = Ends::<f64, Quintics> {
            from: common.from,
            to: common.to,
            velocities: [common.start_velocity, common.end_velocity].map(Into::into),
            accelerations: Some([each.start_acceleration, each.end_acceleration]),
        };
        state = Some(Segment::new(&ends, common.ticks, PERIOD_S).at(tick));
        if tick <= common.ticks {
            break;
        }
        tick -= common.ticks;
    }
    state
}

/// The value below which `part` of all lie.
fn quantile<T: Copy + PartialOrd>(values: &mut [T], part: f64) -> T {
    values.sort_by(|a, b| a.partial_cmp(b).expect("no NaN"));
    values[((part * values.len() as f64) as usize).min(values.len() - 1)]
}

fn follow(path: Path<Machine>) -> Result<(), Box<dyn Error>> {
    let mut state = setpoint([0.21, 0.25, 0.2], [0.0; 3]);
    let mut retarget = Retarget::over(path, &state, &state);
    let (mut steps, mut seconds, mut farthest_m) = (Vec::new(), Vec::new(), 0.0f64);
    for index in 0..TARGETS {
        let (sin, cos) = (0.06 * f64::from(index)).sin_cos();
        let pose = [0.25 + 0.04 * cos, 0.27 + 0.04 * sin, 0.3];
        let target = setpoint(pose, [-0.1 * sin, 0.1 * cos, 0.0]);
        let begin = Instant::now();
        retarget.aim(&state, &target);
        let (moves, each) = planned(&mut retarget)?;
        seconds.push(begin.elapsed().as_secs_f64());
        steps.push(each);
        let left = ticks(&retarget, moves);
        state = state_after(&retarget, moves, left.min(EVERY)).unwrap_or(state);
        // It has to catch up first.
        if index > 100 {
            let off = state.pose.displacement(&target.pose);
            farthest_m = farthest_m.max(off.x.hypot(off.y));
        }
    }
    println!(
        "{TARGETS} targets, followed to {:.2} mm; steps: median {}, most {}; median {:.0} us",
        1e3 * farthest_m,
        quantile(&mut steps, 0.5),
        quantile(&mut steps, 1.0),
        1e6 * quantile(&mut seconds, 0.5)
    );
    Ok(())
}

fn compare(
    path: Path<Machine>,
    planner: &Planner<Machine>,
    count: usize,
) -> Result<(), Box<dyn Error>> {
    let mut seed = 1u32;
    let mut random = |low: f64, high: f64| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        low + (high - low) * f64::from(seed >> 8) / f64::from(1u32 << 24)
    };
    let mut pose = || [random(0.2, 0.3), random(0.22, 0.32), random(0.0, 0.5)];
    let still = setpoint(pose(), [0.0; 3]);
    let mut retarget = Retarget::over(path, &still, &still);
    let (mut ratios, mut lengths) = (Vec::new(), Vec::new());
    while ratios.len() < count {
        let [start, target] = [pose(), pose()].map(|pose| setpoint(pose, [0.0; 3]));
        retarget.aim(&start, &target);
        let (moves, _) = planned(&mut retarget)?;
        let line = [PathPiece {
            piece: Piece::line(start.pose, target.pose),
            feed_m_s: None,
            source: 0,
            stops: false,
            setting: 0,
        }];
        let bound_s = plan(planner, &line, Effort::default())
            .map_err(|refusal| format!("{refusal:?}"))?
            .least_s();
        ratios.push(f64::from(ticks(&retarget, moves)) * PERIOD_S / bound_s);
        lengths.push(moves);
    }
    println!(
        "{count} motions from rest to rest over the bound: median {:.3}, 90 % {:.3}, most {:.3}; moves: median {}",
        quantile(&mut ratios, 0.5),
        quantile(&mut ratios, 0.9),
        quantile(&mut ratios, 1.0),
        quantile(&mut lengths, 0.5)
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let count = std::env::args()
        .nth(1)
        .map_or(Ok(1000), |count| count.parse())?;
    let some = LimitParameters {
        rate_rad_s: Some([1.0; 3]),
        acceleration_rad_s2: Some([60.0; 3]),
        torque_nm: Some([0.3; 3]),
        ..LimitParameters::default()
    };
    let accelerations = LimitParameters {
        rate_rad_s: None,
        ..some
    };
    for (name, parameters) in [
        ("rate, acceleration, torque", some),
        ("acceleration, torque", accelerations),
    ] {
        println!("limits: {name}");
        let limits = Limits::build(&parameters)?;
        let path = Path::build(&example(), limits, Ramp::within(RAMP_TICKS, None), PERIOD_S)?;
        follow(path)?;
        compare(path, &Planner::build(&example(), limits, 0.0)?, count)?;
    }
    Ok(())
}
