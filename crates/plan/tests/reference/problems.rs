//! Seven problems with their least times (`min_time.csv`).

use nalgebra::Vector2;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{LinkParameters, Parameters, example};
use trirrr_core::setpoint::Pose;
use trirrr_plan::piece::Piece;

pub(crate) fn machine(links: bool) -> Parameters {
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

pub(crate) fn outline() -> Vec<Piece<f64>> {
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

pub(crate) fn path(problem: &str) -> Vec<Piece<f64>> {
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
pub(crate) struct Problem {
    pub(crate) name: String,
    pub(crate) links: bool,
    pub(crate) limits: LimitParameters,
    pub(crate) feed_m_s: Option<f64>,
    pub(crate) time_s: f64,
}

pub(crate) fn problems() -> Vec<Problem> {
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
    let problems: Vec<Problem> = include_str!("../min_time.csv")
        .lines()
        .skip(1)
        .map(read)
        .collect();
    assert_eq!(problems.len(), 7);
    problems
}

/// Distance from the outline: the rectangle shrunk by the radius of its corners, plus that radius.
pub(crate) fn from_outline(at: Vector2<f64>) -> f64 {
    let (centre, half, radius) = (Vector2::new(0.25, 0.29), Vector2::new(0.05, 0.025), 0.02);
    let off = (at - centre).abs() - half;
    let outside = off.x.max(0.0).hypot(off.y.max(0.0)) + off.x.max(off.y).min(0.0);
    (outside - radius).abs()
}
