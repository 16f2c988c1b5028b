//! Least times of seven problems, computed by convex optimisation (`min_time.csv`).

use nalgebra::Vector2;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{LinkParameters, Parameters, example};
use trirrr_core::model::{Dynamic, Model};
use trirrr_core::setpoint::Pose;
use trirrr_core::torque::links::{Horizontal, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::cell::Planner;
use trirrr_plan::course::{Effort, PathPiece, Plan};
use trirrr_plan::moves::*;
use trirrr_plan::piece::Piece;
use trirrr_protocol::message::Move;
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
                    ..*link
                };
            }
        }
    }
    parameters
}

fn planned<M: Model<N = f64>>(
    parameters: &Parameters,
    limits: &LimitParameters,
    feed: Option<f64>,
    pieces: &[Piece<f64>],
) -> Plan {
    let limits = Limits::build(limits).expect("limits");
    let planner = Planner::<M>::build(parameters, limits, 1.0 / 60.0).expect("a machine");
    let pieces: Vec<PathPiece> = pieces
        .iter()
        .enumerate()
        .map(|(source, &piece)| PathPiece {
            piece,
            feed_m_s: feed,
            source,
        })
        .collect();
    let sampling = Sampling {
        period_s: 1e-3,
        tolerance_m: 1e-5,
        tolerance_rad: 1e-4,
        resolution_m: 1e-16,
        ticks_min: 1,
    };
    let mut admission = Admission::<M>::build(parameters, limits, 60_000, 1e-3).expect("a machine");
    let mut rounds = 0;
    let mut judge = |moves: &[PlannedMove]| -> Vec<Judged> {
        rounds += 1;
        let all: Vec<Judged> = moves
            .iter()
            .enumerate()
            .map(|(i, m)| {
                admission.offer(&Move {
                    number: i as u32,
                    from: m.from,
                    to: m.to,
                    start_velocity: m.start_velocity.into(),
                    end_velocity: m.end_velocity.into(),
                    ticks: m.ticks,
                    tool_power: 0.0,
                    tool_speed: 0.0,
                });
                loop {
                    match admission.step() {
                        Verdict::Undecided => {}
                        Verdict::Refused(v) => {
                            if std::env::var("V").is_ok() {
                                println!(
                                    "  {i} {} ticks {:?} at {} {:?}",
                                    m.ticks,
                                    v.what,
                                    v.at,
                                    v.value / v.limit
                                );
                            }
                            break Judged::Exceeded(v.value / v.limit - 1.0);
                        }
                        _ => break Judged::Kept,
                    }
                }
            })
            .collect();
        println!(
            "round {rounds}: {} moves, {} refused",
            moves.len(),
            all.iter().filter(|j| **j != Judged::Kept).count()
        );
        all
    };
    let planned =
        plan_moves(&planner, &pieces, Effort::default(), sampling, &mut judge).expect("a plan");
    if std::env::var("D").is_ok() {
        let plan0 = trirrr_plan::course::plan(&planner, &pieces, Effort::default()).unwrap();
        let run = &plan0.runs[0];
        let mut t = 0.0;
        for k in 0..run.cells.len() {
            let l = run.cells[k].length();
            let (y, z) = (run.squares[k], run.squares[k + 1]);
            t += 2.0 * l / (y.sqrt() + z.sqrt());
            println!(
                "D {k} {:?} len {l:.3e} x {y:.6} max {:.6} a {:.5} t {t:.5} {:?}",
                run.places[k],
                run.squares_max[k],
                (z - y) / 2.0 / l,
                run.acting(k)
            );
        }
    }
    println!("{} moves {} ticks", planned.moves.len(), planned.ticks());
    planned.plan
}

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

#[test]
fn the_bracket_holds_the_least_times() {
    for line in include_str!("min_time.csv")
        .lines()
        .skip(1)
        .filter(|l| std::env::var("P").map_or(true, |p| l.starts_with(&p)))
    {
        // The path is quoted and has commas.
        let (problem, rest) = line.split_once(',').expect("a name");
        let (links, rest) = rest.split_once(',').expect("links");
        let (_, numbers) = rest.rsplit_once("\",").expect("a quoted path");
        let numbers: Vec<Option<f64>> = numbers.split(',').map(|n| n.parse().ok()).collect();
        let [torque, rate, acceleration, feed, time] = numbers[..] else {
            panic!("{line}");
        };
        let limits = LimitParameters {
            rate_rad_s: rate.map(|l| [l; 3]),
            acceleration_rad_s2: acceleration.map(|l| [l; 3]),
            torque_nm: torque.map(|l| [l; 3]),
            ..LimitParameters::default()
        };
        let began = std::time::Instant::now();
        let pieces = path(problem);
        let plan = match links {
            "1" => planned::<Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>>(
                &machine(true),
                &limits,
                feed,
                &pieces,
            ),
            _ => planned::<Dynamic<f64, Centred<f64>, Massless>>(
                &machine(false),
                &limits,
                feed,
                &pieces,
            ),
        };
        let cells: usize = plan.runs.iter().map(|run| run.cells.len()).sum();
        let time = time.expect("a time");
        println!(
            "{problem}: reference {time:.5}, plan {:.5} ({:+.4} %), bound {:.5} ({:+.4} %), {cells} cells, {} runs {:?}",
            plan.duration_s(),
            100.0 * (plan.duration_s() / time - 1.0),
            plan.least_s(),
            100.0 * (plan.least_s() / time - 1.0),
            plan.runs.len(),
            began.elapsed(),
        );
    }
}
