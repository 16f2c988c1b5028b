//! Least times of seven problems, computed by convex optimisation (`min_time.csv`).

use nalgebra::Vector2;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{LinkParameters, Parameters, example};
use trirrr_core::model::{Dynamic, Model};
use trirrr_core::setpoint::{Ends, Pose, Quintics};
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::cell::{Obstacle, Planner};
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::{Effort, PathPiece, PathRefusal};
use trirrr_plan::moves::{Judged, PlannedMove, PlannedMoves, Sampling, plan_moves};
use trirrr_plan::piece::Piece;
use trirrr_protocol::message::{AnyMove, Move};
use trirrr_service::Ramp;
use trirrr_service::admission::{Admission, Verdict};

fn machine(links: bool) -> Parameters {
    let mut parameters = example();
    if links {
        for leg in &mut parameters.legs {
            for (link, length) in [
                (&mut leg.proximal, leg.proximal_m),
                (&mut leg.distal, leg.distal_m),
            ] {
                *link = LinkParameters {
                    mass_kg: 0.05,
                    com_m: 0.5 * length,
                    inertia_kgm2: 0.05 * length * length / 12.0,
                };
            }
        }
    }
    parameters
}

/// Ticks of 1 ms, and tolerances of 10 um and 0.1 mrad.
const SAMPLING: Sampling = Sampling {
    period_s: 1e-3,
    tolerance_m: 1e-5,
    tolerance_rad: 1e-4,
    resolution_m: f64::EPSILON,
    ticks_min: 1,
};

/// A hold takes a tenth of a second where there is room.
const RAMP_TICKS: u16 = 100;

fn path_pieces(pieces: &[Piece<f64>], feed_m_s: Option<f64>) -> Vec<PathPiece> {
    let piece = |(source, &piece)| PathPiece {
        piece,
        feed_m_s,
        source,
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
        let Ends {
            from,
            to,
            velocities,
            accelerations,
        } = each.ends;
        let [start_velocity, end_velocity] = velocities.map(Into::into);
        let common = Move {
            start_velocity,
            end_velocity,
            ..Move::rest_to_rest(0, from, to, each.ticks)
        };
        assert!(admission.offer_any(&AnyMove::new(common, accelerations)));
        loop {
            if let Some(violation) = admission.violation() {
                return Judged::Exceeded(violation.value / violation.limit - 1.0);
            }
            if admission.step() == Verdict::Admitted {
                return Judged::Kept;
            }
        }
    };
    plan_moves(&planner, pieces, Effort::default(), SAMPLING, |moves| {
        moves.iter().map(&mut judged).collect()
    })
}

type WithLinks = Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>;
type WithoutLinks = Dynamic<f64, Centred<f64>, Massless>;

fn outline() -> Vec<Piece<f64>> {
    let mut at = Pose::from_f64(0.25, 0.245, 0.4);
    let mut pieces = Vec::new();
    let line = |at: &mut Pose<f64>, x: f64, y: f64| {
        let to = Pose::from_f64(x, y, 0.4);
        let piece = Piece::line(*at, to);
        *at = to;
        piece
    };
    let quarter = core::f64::consts::FRAC_PI_2;
    let (x0, x1, y0, y1, r) = (0.18, 0.32, 0.245, 0.335, 0.02);
    pieces.push(line(&mut at, x1 - r, y0));
    for (centre, to) in [
        ((x1 - r, y0 + r), Some((x1, y1 - r))),
        ((x1 - r, y1 - r), Some((x0 + r, y1))),
        ((x0 + r, y1 - r), Some((x0, y0 + r))),
        ((x0 + r, y0 + r), Some((0.25, y0))),
    ] {
        let arc = Piece::arc(at, Vector2::new(centre.0, centre.1), quarter, 0.4);
        at = arc.end();
        pieces.push(arc);
        if let Some((x, y)) = to {
            pieces.push(line(&mut at, x, y));
        }
    }
    pieces
}

fn circle(x: f64, y: f64, radius: f64, from: f64, alpha: f64) -> Vec<Piece<f64>> {
    let (sin, cos) = from.sin_cos();
    let start = Pose::from_f64(x + radius * cos, y + radius * sin, alpha);
    vec![Piece::arc(
        start,
        Vector2::new(x, y),
        core::f64::consts::TAU,
        alpha,
    )]
}

fn path(problem: &str) -> Vec<Piece<f64>> {
    use core::f64::consts::{FRAC_PI_2, PI};
    let pose = Pose::from_f64;
    match problem {
        "thesis_line_torque" | "thesis_line_all" => vec![Piece::line(
            pose(0.21, 0.22, PI / 20.0),
            pose(0.28, 0.28, PI / 15.0),
        )],
        "circle_torque" => circle(0.25, 0.29, 0.05, 0.0, 0.4),
        "circle_feed" => circle(0.25, 0.29, 0.025, -FRAC_PI_2, 0.3),
        "bezier_rate" => vec![Piece::bezier([
            pose(0.2, 0.25, 0.2),
            pose(0.2, 0.35, 0.2),
            pose(0.3, 0.2, 0.5),
            pose(0.3, 0.32, 0.5),
        ])],
        "outline_torque" | "outline_feed" => outline(),
        other => panic!("unknown problem {other}"),
    }
}

/// A problem of the file.
struct Problem {
    name: String,
    links: bool,
    limits: LimitParameters,
    feed_m_s: Option<f64>,
    time_s: f64,
}

fn problems() -> Vec<Problem> {
    let read = |line: &str| {
        // The path is quoted and has commas.
        let (name, rest) = line.split_once(',').expect("a name");
        let (links, rest) = rest.split_once(',').expect("links");
        let (_, numbers) = rest.rsplit_once("\",").expect("a quoted path");
        let numbers: Vec<Option<f64>> = numbers.split(',').map(|n| n.parse().ok()).collect();
        let [torque, rate, acceleration, feed_m_s, time_s] = numbers[..] else {
            panic!("{line}");
        };
        Problem {
            name: name.into(),
            links: links == "1",
            limits: LimitParameters {
                rate_rad_s: rate.map(|limit| [limit; 3]),
                acceleration_rad_s2: acceleration.map(|limit| [limit; 3]),
                torque_nm: torque.map(|limit| [limit; 3]),
                ..LimitParameters::default()
            },
            feed_m_s,
            time_s: time_s.expect("a time"),
        }
    };
    let problems: Vec<Problem> = include_str!("min_time.csv")
        .lines()
        .skip(1)
        .map(read)
        .collect();
    assert_eq!(problems.len(), 7);
    problems
}

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

/// Distance from the outline: the rectangle shrunk by the radius of its corners, plus that radius.
fn from_outline(at: Vector2<f64>) -> f64 {
    let (centre, half, radius) = (Vector2::new(0.25, 0.29), Vector2::new(0.05, 0.025), 0.02);
    let off = (at - centre).abs() - half;
    let outside = off.x.max(0.0).hypot(off.y.max(0.0)) + off.x.max(off.y).min(0.0);
    (outside - radius).abs()
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
