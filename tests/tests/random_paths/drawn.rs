//! Random jobs: a machine, limits and a path that suit each other, as the text of a scene.

use crate::geometry::{Coordinates, Drawn};
use crate::scene_text::{header, job_text, limits_text, machine_text};
use crate::truth::{Instant, State};
use core::f64::consts::{PI, TAU};
use nalgebra::Vector2;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};
use trirrr_tests::draw::{Draw, within_a_turn};
use trirrr_tests::random::Case;

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
    pub(crate) text: String,
}

/// Two machines with the whole of their workspace, and any machine about a pose.
fn machine(case: &Case, draw: &mut Draw) -> (Parameters, Coordinates, f64) {
    let family = draw.within(0.0, 3.0);
    if family < 1.0 {
        let case = within_a_turn(case);
        let mut parameters = case.parameters;
        for leg in &mut parameters.legs {
            // A rotor belongs to a drive.
            leg.rotor_inertia_kgm2 = 0.0;
        }
        let pose = case.setpoint.pose;
        let start = [pose.position.x, pose.position.y, pose.angle];
        return (parameters, start, 0.3);
    }
    let thesis = family < 2.0;
    let rods = draw.chance(0.5).then(|| draw.log_within(0.01, 0.3));
    let (bases, lengths, radius, elbow) = match thesis {
        true => (
            [[0.0, 0.433], [0.5, 0.433], [0.25, 0.0]],
            [0.2, 0.2],
            0.02,
            Elbow::Positive,
        ),
        false => (
            [[0.0, 0.7], [0.8, 0.7], [0.4, 0.0]],
            [0.3, 0.36],
            0.06,
            Elbow::Negative,
        ),
    };
    let angles = [150.0f64, 30.0, 270.0].map(f64::to_radians);
    let link = |length: f64| {
        rods.map_or(LinkParameters::default(), |mass| {
            LinkParameters::uniform_rod(mass, length)
        })
    };
    let legs = [0, 1, 2].map(|index: usize| LegParameters {
        base_m: Vector2::from(bases[index]),
        proximal_m: lengths[0],
        distal_m: lengths[1],
        joint_radius_m: radius,
        joint_angle_rad: angles[index],
        elbow,
        proximal: link(lengths[0]),
        distal: link(lengths[1]),
        rotor_inertia_kgm2: 0.0,
    });
    let mass = draw.log_within(0.1, 2.0);
    let pair = |draw: &mut Draw, part: f64, size: f64| match draw.chance(part) {
        true => Vector2::new(draw.within(-size, size), draw.within(-size, size)),
        false => Vector2::zeros(),
    };
    let parameters = Parameters {
        legs,
        platform: PlatformParameters {
            mass_kg: mass,
            inertia_kgm2: mass * draw.log_within(1e-3, 2e-2),
            com_m: pair(draw, 0.3, 0.02),
        },
        gravity_m_s2: match draw.chance(0.3) {
            true => Vector2::new(0.0, -9.81),
            false => Vector2::zeros(),
        },
        wrench_force_n: pair(draw, 0.2, 1.0),
        wrench_torque_nm: if draw.chance(0.2) {
            draw.within(-0.05, 0.05)
        } else {
            0.0
        },
    };
    let start = match thesis {
        true => [
            draw.within(0.19, 0.31),
            draw.within(0.21, 0.33),
            draw.within(-0.1, 0.6),
        ],
        false => [
            draw.within(0.3, 0.5),
            draw.within(0.3, 0.5),
            draw.within(-0.5, 0.1),
        ],
    };
    (parameters, start, 0.6)
}

/// Distances that the job has to keep, and the side of the parallel singularity.
struct Workspace<'a> {
    parameters: &'a Parameters,
    serial_min: f64,
    parallel_min: f64,
    side: bool,
}

impl Workspace<'_> {
    /// With room: what is drawn is feasible between the places too.
    fn holds(&self, at: Coordinates) -> bool {
        let state = State {
            pose: at,
            ..State::default()
        };
        let instant = Instant::kinematics(self.parameters, &state);
        instant
            .serial
            .into_iter()
            .all(|serial| serial > 1.25 * self.serial_min)
            && instant.parallel > 1.25 * self.parallel_min
            && instant.side == self.side
    }
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
    for _ in 0..8 * count {
        let shortest = if draw.chance(0.1) { 0.01 } else { 0.2 };
        let size = reach * scale * draw.log_within(shortest, 1.5);
        let (next, ahead) = piece(draw, from, tangent, size, turn * (scale * 4.0).min(1.0));
        let inside =
            (0..=PLACES).all(|i| workspace.holds(next.at(from, f64::from(i) / f64::from(PLACES))));
        if inside {
            from = next.end(from);
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
    let [serial_min, parallel_min] = [workspace.serial_min, workspace.parallel_min];
    let mut job = DrawnJob {
        parameters,
        start,
        pieces,
        feeds,
        corner_m,
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
