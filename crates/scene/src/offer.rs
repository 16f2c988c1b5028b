//! Moves of a scene's job, as a client offers them to a service.

use crate::Scene;
use crate::job_move::{JobMove, Tool};
use crate::spool::SpooledMoves;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_plan::piece::{Piece, PlaneCurve};
use trirrr_protocol::message::{AnyMove, Move, PathCurve, PathPiece, Transmit};

/// Moves for which the service of a host has room; that of a board has no more. The longest move follows from it.
pub const CAPACITY: usize = 256;

/// Pieces of a path, and cells of their plan, that a service which plans paths holds, on a board as on a host: some 40 KB there.
pub const PIECES: usize = 32;
/// See [`PIECES`].
pub const CELLS: usize = 48;

/// Returns the pieces of a scene's path for a machine that plans it, in the number type `N` and in `units`, numbered from 0.
///
/// # Errors
/// A job without a path; a piece that a machine does not plan.
pub fn pieces<N: Transmit>(scene: &Scene, units: &Units) -> Result<Vec<PathPiece<N>>, String> {
    let path = scene.job.path.as_ref();
    let path = path.ok_or("its job has no path: give it as [[job.path]]")?;
    if let Some(dwell) = path.dwells.first() {
        return Err(format!(
            "job.path[{}]: a machine that plans a path does not dwell on it; send moves",
            dwell.source + 1
        ));
    }
    let pieces = path.pieces.iter().enumerate();
    let offered = pieces.map(|(number, each)| {
        let tool = path.tools[each.source];
        let piece = piece(&each.piece, each.feed_m_s, tool, units);
        let piece = piece.ok_or_else(|| {
            format!(
                "job.path[{}]: a machine plans no arc on which alpha bends; send moves",
                each.source + 1
            )
        })?;
        Ok(PathPiece {
            number: number as u32,
            last: number + 1 == path.pieces.len(),
            ..piece
        })
    });
    offered.collect()
}

/// Returns one piece with its feed and its tool for a machine that plans it, numbered 0 and not the last. `None` for an arc on which
/// alpha bends: a machine plans none.
pub fn piece<N: Transmit>(
    piece: &Piece<f64>,
    feed_m_s: Option<f64>,
    tool: Option<Tool>,
    units: &Units,
) -> Option<PathPiece<N>> {
    let metres = units.length_m();
    let speed = |speed: f64| N::from_f64(speed * units.time_s() / metres);
    let pose = |at: Pose<f64>| {
        Pose::<N>::from_f64(at.position.x / metres, at.position.y / metres, at.angle)
    };
    let [c1, c2, c3] = piece.turning;
    let is_linear = c2 == 0.0 && c3 == 0.0;
    let curve = match piece.curve {
        PlaneCurve::Line { .. } if is_linear => PathCurve::Line {
            to: pose(piece.end()),
        },
        PlaneCurve::Arc { centre, turn, .. } if is_linear => PathCurve::Arc {
            centre: [centre.x, centre.y].map(|each| N::from_f64(each / metres)),
            turn: N::from_f64(turn),
            to_angle: N::angle_from_f64(piece.angle + c1),
        },
        PlaneCurve::Arc { .. } => return None,
        PlaneCurve::Line { .. } | PlaneCurve::Cubic { .. } => {
            let [_, first, second, to] = piece.controls().map(pose);
            PathCurve::Bezier {
                controls: [first, second],
                to,
            }
        }
    };
    Some(PathPiece {
        number: 0,
        curve,
        feed: speed(feed_m_s.unwrap_or(0.0)),
        tool_power: N::from_f64(tool.map_or(0.0, |tool| tool.power)),
        tool_speed: speed(tool.map_or(0.0, |tool| tool.speed_m_s)),
        last: false,
    })
}

/// Returns the moves of a scene's job in the number type `N` and in `units`, numbered from 0.
pub fn moves<N: Transmit>(scene: &Scene, units: &Units) -> Vec<AnyMove<N>> {
    moves_in_units(&scene.job.in_units(units).moves)
}

/// Returns moves that are in the machine's units already in the number type `N`, numbered from 0.
pub fn moves_in_units<N: Transmit>(moves: &[JobMove]) -> Vec<AnyMove<N>> {
    let moves = moves.iter().zip(0..);
    moves.map(|(each, number)| offer(each, number)).collect()
}

/// Returns moves of a job out of its spool in the number type `N`, numbered from `first`. Units are SI, as those of every number type of
/// a job with a spool.
pub fn spooled<N: Transmit>(
    moves: &SpooledMoves,
    first: u32,
) -> impl Iterator<Item = AnyMove<N>> + '_ {
    let moves = moves.moves.iter().zip(first..);
    moves.map(|(each, number)| offer(each, number))
}

/// Returns a move of a job in the number type `N` and in `units`, with the number 0.
pub(crate) fn one<N: Transmit>(each: &JobMove, units: &Units) -> AnyMove<N> {
    offer(&each.in_units(units), 0)
}

/// Converts a pose to the number type `N`.
pub fn pose<N: Transmit>(pose: &Pose<f64>) -> Pose<N> {
    Pose::from_f64(pose.position.x, pose.position.y, pose.angle)
}

fn offer<N: Transmit>(each: &JobMove, number: u32) -> AnyMove<N> {
    let (power, speed) = match each.tool {
        Some(tool) => (tool.power, tool.speed_m_s),
        None => (0.0, 0.0),
    };
    let ends = each.ends::<N>();
    let [start_velocity, end_velocity] = ends.velocities.map(Into::into);
    let common = Move {
        number,
        from: ends.from,
        to: ends.to,
        start_velocity,
        end_velocity,
        ticks: each.duration_ticks,
        tool_power: N::from_f64(power),
        tool_speed: N::from_f64(speed),
    };
    AnyMove::new(common, ends.accelerations)
}
