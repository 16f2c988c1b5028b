//! Moves of a scene's job, as a client offers them to a service.

use crate::Scene;
use crate::job::JobMove;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_protocol::message::{Move, Transmit};

/// Moves for which the service of a host has room; that of a board has no more. The longest move follows from it.
pub const CAPACITY: usize = 16;

/// Returns the moves of a scene's job in the number type `N` and in `units`, numbered from 0.
pub fn moves<N: Transmit>(scene: &Scene, units: &Units) -> Vec<Move<N>> {
    let job = scene.job.in_units(units);
    let moves = job.moves.iter().zip(0..);
    moves.map(|(each, number)| offer(each, number)).collect()
}

/// Converts a pose to the number type `N`.
pub fn pose<N: Transmit>(pose: &Pose<f64>) -> Pose<N> {
    Pose::from_f64(pose.position.x, pose.position.y, pose.angle)
}

fn offer<N: Transmit>(each: &JobMove, number: u32) -> Move<N> {
    let (power, speed) = match each.tool {
        Some(tool) => (tool.power, tool.speed_m_s),
        None => (0.0, 0.0),
    };
    Move {
        number,
        from: pose(&each.from),
        to: pose(&each.to),
        start_velocity: each.start_velocity.map(N::from_f64).into(),
        end_velocity: each.end_velocity.map(N::from_f64).into(),
        ticks: each.duration_ticks,
        tool_power: N::from_f64(power),
        tool_speed: N::from_f64(speed),
    }
}
