//! Random jobs: a machine, limits and a path that suit each other, as the text of a scene.

use crate::geometry::Drawn;
use crate::scene_text::{header, job_text, limits_text, machine_text};
use core::f64::consts::{PI, TAU};
use trirrr_core::machine::Parameters;
use trirrr_tests::draw::Draw;
use trirrr_tests::instant::{Coordinates, Instant, State};
use trirrr_tests::random::Case;
use trirrr_tests::workspace::{Workspace, machine};

/// Places on each piece that are looked at while it is drawn.
pub(crate) const PLACES: u32 = 64;

/// A job that is feasible at some pace, by samples and with room.
pub(crate) struct DrawnJob {
    pub(crate) parameters: Parameters,
    pub(crate) start: Coordinates,
    pub(crate) pieces: Vec<Drawn>,
    /// Greatest speed of D on each piece.
    pub(crate) feeds: Vec<Option<f64>>,
    pub(crate) corner_m: Option<f64>,
    /// The planner chooses alpha; the file then gives alpha at the end of all pieces, or of none.
    pub(crate) free_alpha: Option<GivenEnds>,
    pub(crate) text: String,
}

/// alpha in the file of a path whose alpha is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GivenEnds {
    All,
    None,
}

/// A random piece from `from`, of about `size`; `tangent` is the direction in which the path comes.
fn piece(
    draw: &mut Draw,
    from: Coordinates,
    tangent: Option<f64>,
    size: f64,
    turn: f64,
) -> (Drawn, f64) {
    let heading = tangent
        .filter(|_| draw.chance(0.5))
        .unwrap_or_else(|| draw.within(0.0, TAU));
    let alpha = match draw.chance(0.4) {
        true => from[2],
        false => from[2] + turn * draw.within(-1.0, 1.0),
    };
    let ahead = |from: Coordinates, heading: f64, size: f64, alpha: f64| {
        [
            from[0] + size * heading.cos(),
            from[1] + size * heading.sin(),
            alpha,
        ]
    };
    match draw.within(0.0, 4.2) {
        kind if kind < 1.4 => (
            Drawn::Line {
                to: ahead(from, heading, size, alpha),
            },
            heading,
        ),
        kind if kind < 2.4 => {
            let turn = draw.within(0.2, TAU) * if draw.chance(0.5) { 1.0 } else { -1.0 };
            let radius = size / turn.abs().min(PI);
            let centre = ahead(from, heading + turn.signum() * 0.5 * PI, radius, 0.0);
            let centre = [centre[0], centre[1]];
            (
                Drawn::Arc {
                    centre,
                    turn,
                    alpha,
                },
                heading + turn,
            )
        }
        kind if kind < 3.3 => {
            let last = heading + draw.within(-2.0, 2.0);
            let between = |draw: &mut Draw| from[2] + (alpha - from[2]) * draw.within(-0.3, 1.3);
            let a = ahead(from, heading, size * draw.within(0.2, 0.6), between(draw));
            let b = ahead(
                a,
                heading + draw.within(-1.5, 1.5),
                size * draw.within(0.2, 0.6),
                between(draw),
            );
            let c = ahead(b, last, size * draw.within(0.2, 0.6), alpha);
            (
                Drawn::Bezier {
                    controls: [a, b, c],
                },
                last,
            )
        }
        kind if kind < 4.1 => {
            let mut through = Vec::new();
            let (mut at, mut way) = (from, heading);
            for _ in 0..2 + draw.within(0.0, 4.0) as usize {
                way += draw.within(-1.2, 1.2);
                let alpha = at[2] + 0.3 * (alpha - from[2]) * draw.within(-0.5, 1.0);
                at = ahead(at, way, size * draw.within(0.15, 0.5), alpha);
                through.push(at);
            }
            (Drawn::Spline { through }, draw.within(0.0, TAU))
        }
        _ => {
            let turned = from[2] + turn * draw.within(-1.0, 1.0);
            (
                Drawn::Line {
                    to: [from[0], from[1], turned],
                },
                heading,
            )
        }
    }
}

/// Draws a job on `case` or on a machine of a shipped scene; none where its start is no place to begin from.
pub(crate) fn draw(case: &Case, draw: &mut Draw) -> Option<DrawnJob> {
    let (parameters, start, turn) = machine(case, draw);
    let reach = (0..3)
        .map(|leg| parameters.legs[leg].proximal_m + parameters.legs[leg].distal_m)
        .fold(f64::INFINITY, f64::min);
    let least = |draw: &mut Draw| {
        if draw.chance(0.3) {
            0.02
        } else {
            draw.log_within(0.02, 0.2)
        }
    };
    let state = State {
        pose: start,
        ..State::default()
    };
    let workspace = Workspace {
        parameters: &parameters,
        serial_min: least(draw),
        parallel_min: least(draw),
        side: Instant::kinematics(&parameters, &state).side,
    };
    if !workspace.holds(start) {
        return None;
    }
    let count = 1 + draw.within(0.0, 1.0).powi(2).mul_add(6.0, 0.0) as usize;
    let scale = draw.log_within(0.003, 0.25);
    let (mut pieces, mut from, mut tangent) = (Vec::new(), start, None);
    let mut turns = false;
    for _ in 0..8 * count {
        let shortest = if draw.chance(0.1) { 0.01 } else { 0.2 };
        let size = reach * scale * draw.log_within(shortest, 1.5);
        let (next, ahead) = piece(draw, from, tangent, size, turn * (scale * 4.0).min(1.0));
        let inside =
            (0..=PLACES).all(|i| workspace.holds(next.at(from, f64::from(i) / f64::from(PLACES))));
        if inside {
            let end = next.end(from);
            turns |= matches!(next, Drawn::Line { .. }) && end[..2] == from[..2];
            from = end;
            tangent = Some(ahead);
            pieces.push(next);
        }
        if pieces.len() == count {
            break;
        }
    }
    if pieces.is_empty() {
        return None;
    }
    let job_feed = draw.chance(0.4).then(|| reach * draw.log_within(0.02, 3.0));
    let feeds: Vec<_> = pieces
        .iter()
        .map(|_| {
            draw.chance(0.15)
                .then(|| reach * draw.log_within(0.02, 3.0))
                .or(job_feed)
        })
        .collect();
    let corner_m = draw
        .chance(0.5)
        .then(|| reach * draw.log_within(1e-5, 1e-2));
    // A piece along which D stands needs an alpha, and the curve of a spline depends on those that are given.
    let splines = pieces
        .iter()
        .any(|each| matches!(each, Drawn::Spline { .. }));
    let free_alpha = (!turns && draw.chance(0.15)).then(|| match splines || draw.chance(0.5) {
        true => GivenEnds::All,
        false => GivenEnds::None,
    });
    let [serial_min, parallel_min] = [workspace.serial_min, workspace.parallel_min];
    let mut job = DrawnJob {
        parameters,
        start,
        pieces,
        feeds,
        corner_m,
        free_alpha,
        text: String::new(),
    };
    let mut text = header(draw);
    text += &machine_text(&job.parameters);
    text += &limits_text(&job, draw, reach, [serial_min, parallel_min]);
    let tolerances = [
        reach * draw.log_within(3e-6, 1e-3),
        draw.log_within(1e-5, 1e-2),
    ];
    text += &job_text(&job, tolerances);
    job.text = text;
    Some(job)
}
