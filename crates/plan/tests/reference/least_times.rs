//! Least times of seven problems, computed by convex optimisation (`min_time.csv`).

use crate::judge::excess;
use crate::problems::{Problem, from_outline, machine, path, problems};
use nalgebra::Vector2;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::Parameters;
use trirrr_core::model::{Dynamic, Model};
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::cell::{Limited, Obstacle, Planner};
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::{Effort, PathPiece, PathRefusal};
use trirrr_plan::moves::{Judged, PlannedMove, PlannedMoves, Sampling, plan_moves};
use trirrr_plan::piece::Piece;
use trirrr_service::admission::Admission;
use trirrr_service::paces::Ramp;

/// Ticks of 1 ms, and tolerances of 10 um and 0.1 mrad.
const SAMPLING: Sampling = Sampling {
    period_s: 1e-3,
    tolerance_m: 1e-5,
    tolerance_rad: 1e-4,
    resolution_m: f64::EPSILON,
    resolution_rad: f64::EPSILON,
    ticks_min: 4,
    ticks_shortest: 1,
};

/// A hold takes a tenth of a second where there is room.
const RAMP_TICKS: u16 = 100;

fn path_pieces(pieces: &[Piece<f64>], feed_m_s: Option<f64>) -> Vec<PathPiece> {
    let piece = |(source, &piece)| PathPiece {
        piece,
        feed_m_s,
        source,
        stops: false,
        setting: 0,
    };
    pieces.iter().enumerate().map(piece).collect()
}

/// Plans with the admission of binary64 as the judge.
fn planned<M: Model<N = f64>>(
    parameters: &Parameters,
    limits: &LimitParameters,
    pieces: &[PathPiece],
) -> Result<PlannedMoves, PathRefusal> {
    let limits = Limits::build(limits).expect("limits");
    let planner = Planner::<M>::build(parameters, limits, 0.0).expect("a machine");
    let mut admission = Admission::<M, Quintics>::build(
        parameters,
        limits,
        Ramp::within(RAMP_TICKS, None),
        SAMPLING.period_s,
    )
    .expect("a machine");
    let mut judged = |each: &PlannedMove| {
        let by = excess(&mut admission, &each.ends, each.ticks);
        by.map_or(Judged::Kept, |by| Judged::Exceeded(by, Limited::Number))
    };
    plan_moves(&planner, pieces, Effort::default(), SAMPLING, |moves| {
        moves.iter().map(&mut judged).collect()
    })
}

type WithLinks = Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>;
type WithoutLinks = Dynamic<f64, Centred<f64>, Massless>;

/// The least times of the file are good to 3e-5 of themselves.
#[test]
fn the_bracket_holds_the_least_times_and_moves_come_near() {
    for problem in problems() {
        let pieces = path_pieces(&path(&problem.name), problem.feed_m_s);
        let parameters = machine(problem.links);
        let planned = match problem.links {
            true => planned::<WithLinks>(&parameters, &problem.limits, &pieces),
            false => planned::<WithoutLinks>(&parameters, &problem.limits, &pieces),
        };
        let planned = planned.unwrap_or_else(|refusal| panic!("{}: {refusal:?}", problem.name));
        let (plan, time) = (&planned.plan, problem.time_s);
        let played = planned.ticks() as f64 * SAMPLING.period_s;
        println!(
            "{:20} reference {time:.5} bound {:.5} plan {:.5} moves {played:.3} ({} of them): {:.4} of the reference",
            problem.name,
            plan.least_s(),
            plan.duration_s(),
            planned.moves.len(),
            played / time,
        );
        assert_eq!(plan.runs.len(), 1, "{}", problem.name);
        assert!(plan.least_s() <= time * (1.0 + 3e-5), "{}", problem.name);
        assert!(plan.least_s() >= time * 0.995, "{}", problem.name);
        assert!(plan.duration_s() >= time * (1.0 - 3e-5), "{}", problem.name);
        assert!(played <= 1.02 * time, "{}", problem.name);
        let [first, .., last] = &planned.moves[..] else {
            panic!("{}: one move", problem.name);
        };
        assert_eq!(first.ends.from, pieces[0].piece.at(0.0).pose);
        let end = pieces[pieces.len() - 1].piece.end();
        assert!((last.ends.to.position - end.position).amax() < 1e-12);
        for pair in planned.moves.windows(2) {
            let [before, after] = [pair[0].ends, pair[1].ends];
            assert_eq!(before.to, after.from);
            assert_eq!(before.velocities[1], after.velocities[0]);
            let accelerations = [before, after].map(|ends| ends.accelerations.expect("quintics"));
            assert_eq!(accelerations[0][1], accelerations[1][0]);
        }
    }
}

/// Ticks of the moves of a problem with this limit of jerk.
fn ticks_with_jerk(problem: &Problem, jerk: Option<f64>) -> u64 {
    let pieces = path_pieces(&path(&problem.name), problem.feed_m_s);
    let parameters = machine(problem.links);
    let limits = LimitParameters {
        jerk_rad_s3: jerk.map(|jerk| [jerk; 3]),
        ..problem.limits
    };
    let planned = match problem.links {
        true => planned::<WithLinks>(&parameters, &limits, &pieces),
        false => planned::<WithoutLinks>(&parameters, &limits, &pieces),
    };
    let planned = planned.unwrap_or_else(|refusal| panic!("{}: {refusal:?}", problem.name));
    planned.ticks()
}

/// A limit of jerk that hardly acts costs what its smoothing takes, and a narrow one more.
#[test]
fn a_limit_of_jerk_costs_time() {
    let problem = &problems()[1];
    let without = ticks_with_jerk(problem, None);
    let [wide, narrow] = [10_000.0, 1000.0].map(|jerk| ticks_with_jerk(problem, Some(jerk)));
    println!("{without} ticks, {wide} and {narrow} with limits of jerk");
    assert!(wide > without && wide <= without + 8, "{wide} {without}");
    assert!(
        narrow > wide && narrow as f64 <= 1.06 * without as f64,
        "{narrow} {without}"
    );
}

#[test]
#[ignore = "prints a table of docs/planning.md"]
fn times_with_limits_of_jerk() {
    for problem in problems() {
        let limits = [None, Some(10_000.0), Some(3000.0), Some(1000.0)];
        let ticks = limits.map(|jerk| ticks_with_jerk(&problem, jerk));
        // The narrower the limit, the longer; at most 1.6 times as long as without.
        assert!(ticks.is_sorted(), "{}: {ticks:?}", problem.name);
        assert!(5 * ticks[3] <= 8 * ticks[0], "{}: {ticks:?}", problem.name);
        let times = ticks.map(|ticks| format!("{:.3}", ticks as f64 * SAMPLING.period_s));
        println!("{:20} {}", problem.name, times.join(" "));
    }
}

/// Every tick of the moves, computed by the tick itself, keeps the limits, and lies on the path to the tolerance.
#[test]
fn moves_keep_limits_and_path() {
    let problem = problems()
        .into_iter()
        .find(|each| each.name == "outline_torque");
    let problem = problem.expect("the outline");
    let pieces = path_pieces(&path(&problem.name), None);
    let parameters = machine(true);
    let planned = planned::<WithLinks>(&parameters, &problem.limits, &pieces).expect("a plan");
    let tick = Tick::<WithLinks>::build(&parameters).expect("a machine");
    let (mut worst, mut away): (f64, f64) = (0.0, 0.0);
    // Torques at the end of the move before, and the largest step from one move to the next.
    let (mut before, mut step): (Option<[f64; 3]>, f64) = (None, 0.0);
    let torques = |setpoint| {
        tick.evaluate(&setpoint)
            .expect("a motion")
            .motors
            .map(|motor| motor.torque)
    };
    for each in &planned.moves {
        let segment = each.segment(SAMPLING.period_s);
        let [start, end] = [0.0, 1.0].map(|s| torques(segment.at_fraction(s)));
        for (before, start) in before.iter().flatten().zip(start) {
            step = step.max((start - before).abs());
        }
        before = Some(end);
        for part in 0..=8 * each.ticks {
            let setpoint = segment.at_fraction(f64::from(part) / f64::from(8 * each.ticks));
            let motion = tick.evaluate(&setpoint).expect("a motion");
            for motor in &motion.motors {
                worst = worst
                    .max(motor.torque.abs() / 0.3)
                    .max(motor.rate.abs() / 5.0);
            }
            away = away.max(from_outline(setpoint.pose.position));
        }
    }
    println!(
        "largest part of a limit {worst:.6}, largest distance from the path {away:.3e} m, largest step of a torque between moves {:.3e} of its limit",
        step / 0.3
    );
    assert!(step <= 1e-9 * 0.3, "{step}");
    assert!(worst <= 1.0 && worst > 0.99, "{worst}");
    assert!(away <= SAMPLING.tolerance_m && away > 0.0, "{away}");
}

/// An L with a corner: a stop, or a curve within the tolerance that is faster.
#[test]
fn a_corner_is_a_stop_unless_it_is_rounded() {
    let pose = Pose::from_f64;
    let corner = Vector2::new(0.28, 0.25);
    let pieces = [
        Piece::line(pose(0.22, 0.25, 0.4), pose(0.28, 0.25, 0.4)),
        Piece::line(pose(0.28, 0.25, 0.4), pose(0.28, 0.31, 0.4)),
    ];
    let limits = LimitParameters {
        torque_nm: Some([0.3; 3]),
        ..LimitParameters::default()
    };
    let sharp = path_pieces(&pieces, None);
    let tolerance = 1e-3;
    let round = round_corners(&sharp, tolerance);
    assert_eq!(round.len(), 3);
    let curve = round[1].piece;
    let nearest = (0..=1000).map(|i| curve.at(f64::from(i) / 1000.0).pose.position - corner);
    let nearest = nearest
        .map(|off| off.x.hypot(off.y))
        .fold(f64::INFINITY, f64::min);
    assert!(
        nearest <= tolerance * 1.5 && nearest > 0.5 * tolerance,
        "{nearest}"
    );
    let parameters = machine(true);
    let stops = planned::<WithLinks>(&parameters, &limits, &sharp).expect("a plan");
    let flows = planned::<WithLinks>(&parameters, &limits, &round).expect("a plan");
    assert_eq!((stops.plan.runs.len(), flows.plan.runs.len()), (2, 1));
    assert!(flows.ticks() < stops.ticks());
}

/// Travels and strokes with rounded corners, of random turns and lengths: the tool's setting changes within the tolerance of its corner, along
/// the path and across it, and nothing between is left out.
#[test]
fn the_tool_changes_at_its_corner() {
    let mut draw = 0x7472_6972_7272_u64;
    let mut random = move || {
        draw ^= draw << 13;
        draw ^= draw >> 7;
        draw ^= draw << 17;
        (draw >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut rounded_corners = 0;
    for _ in 0..1000 {
        let tolerance_m = 1e-6 * 1000.0_f64.powf(random());
        let mut at = Vector2::new(0.25, 0.25);
        let mut heading = 0.0_f64;
        let mut lines = Vec::new();
        for _ in 0..12 {
            // From hardly a turn to one that nearly goes back.
            heading += 3.0 * random().powi(4) * (random() - 0.5).signum();
            let length = 1e-5 * 1000.0_f64.powf(random());
            let to = at + length * Vector2::new(heading.cos(), heading.sin());
            let pose = |at: Vector2<f64>| Pose::from_f64(at.x, at.y, 0.4);
            lines.push(Piece::line(pose(at), pose(to)));
            at = to;
        }
        let mut pieces = path_pieces(&lines, None);
        for (index, piece) in pieces.iter_mut().enumerate() {
            (piece.setting, piece.source) = (index, index);
        }
        let round = round_corners(&pieces, tolerance_m);
        assert_eq!(round[0].setting, 0);
        for pair in round.windows(2) {
            let [before, here] = [&pair[0], &pair[1]];
            let apart = before.piece.end().displacement(&here.piece.at(0.0).pose);
            assert!(apart.norm() < 1e-12, "{apart}");
            if before.setting == here.setting {
                continue;
            }
            assert_eq!(here.setting, before.setting + 1);
            let corner = lines[here.setting].at(0.0).pose;
            let off = corner.displacement(&here.piece.at(0.0).pose);
            rounded_corners += u32::from(off.norm() > 0.0);
            assert!(
                off.xy().norm() <= tolerance_m * (1.0 + 1e-9),
                "{off} {tolerance_m}"
            );
        }
        assert_eq!(round.last().expect("a piece").setting, lines.len() - 1);
    }
    assert!(rounded_corners > 5000, "{rounded_corners}");
}

/// A stroke at 50 mm/min between two travels, its corners rounded: it takes the time of its feed.
#[test]
fn a_slow_piece_beside_fast_ones_keeps_its_feed() {
    let pose = Pose::from_f64;
    let limits = LimitParameters {
        torque_nm: Some([0.3; 3]),
        rate_rad_s: Some([5.0; 3]),
        ..LimitParameters::default()
    };
    let slow = 0.05 / 60.0;
    let pieces = [
        Piece::line(pose(0.225, 0.285, 0.4), pose(0.275, 0.285, 0.4)),
        Piece::line(pose(0.275, 0.285, 0.4), pose(0.275, 0.288, 0.4)),
        Piece::line(pose(0.275, 0.288, 0.4), pose(0.225, 0.285, 0.4)),
    ];
    let mut pieces = path_pieces(&pieces, None);
    pieces[1].feed_m_s = Some(slow);
    for corner_m in [1e-5, 0.0] {
        let pieces = match corner_m > 0.0 {
            true => round_corners(&pieces, corner_m),
            false => pieces.clone(),
        };
        let planned = planned::<WithLinks>(&machine(true), &limits, &pieces).expect("a plan");
        let played_s = planned.ticks() as f64 * SAMPLING.period_s;
        println!(
            "corner {corner_m}: {played_s} s, {} moves",
            planned.moves.len()
        );
        assert!((3.8..4.2).contains(&played_s), "{played_s}");
        let speed = |each: &PlannedMove| {
            let segment = each.segment(SAMPLING.period_s);
            let speeds = (0..=16).map(|part| {
                let velocity = segment.at_fraction(f64::from(part) / 16.0).velocity;
                velocity.x.hypot(velocity.y)
            });
            speeds.fold(0.0, f64::max)
        };
        let is_slow = |each: &&PlannedMove| speed(each) <= slow * (1.0 + 1e-9);
        let ticks: u32 = planned
            .moves
            .iter()
            .filter(is_slow)
            .map(|each| each.ticks)
            .sum();
        assert!(f64::from(ticks) * SAMPLING.period_s > 3.5, "{ticks}");
    }
}

#[test]
fn obstacles_are_named_with_their_place() {
    let pose = Pose::from_f64;
    let limits = LimitParameters {
        torque_nm: Some([0.3; 3]),
        ..LimitParameters::default()
    };
    let refused = |parameters: &Parameters, pieces: &[Piece<f64>]| {
        planned::<WithLinks>(parameters, &limits, &path_pieces(pieces, None))
            .expect_err("an obstacle")
    };
    let parameters = machine(true);
    let far = [
        Piece::line(pose(0.25, 0.25, 0.4), pose(0.3, 0.25, 0.4)),
        Piece::line(pose(0.3, 0.25, 0.4), pose(0.9, 0.25, 0.4)),
    ];
    let refusal = refused(&parameters, &far);
    assert_eq!(refusal.place.piece, 1);
    assert!(matches!(
        refusal.obstacle,
        Obstacle::Reach(_) | Obstacle::SerialDistance(_)
    ));
    assert!(refusal.pose.position.x > 0.3 && refusal.pose.position.x < 0.9);
    // alpha turns through the parallel singularity at about -0.753 rad.
    let through = [Piece::line(pose(0.245, 0.25, 0.2), pose(0.245, 0.25, -1.2))];
    let refusal = refused(&parameters, &through);
    assert_eq!(refusal.obstacle, Obstacle::ParallelDistance);
    assert!(
        (refusal.pose.angle + 0.753_418_931_929).abs() < 0.02,
        "{refusal:?}"
    );
}
