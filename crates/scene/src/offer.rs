//! Moves of a scene's job, as a client offers them to a service.

use crate::Scene;
use crate::job::JobMove;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_protocol::message::{AnyMove, Move, Transmit};

/// Moves for which the service of a host has room; that of a board has no more. The longest move follows from it.
pub const CAPACITY: usize = 128;

/// Returns the moves of a scene's job in the number type `N` and in `units`, numbered from 0.
pub fn moves<N: Transmit>(scene: &Scene, units: &Units) -> Vec<AnyMove<N>> {
    let job = scene.job.in_units(units);
    let moves = job.moves.iter().zip(0..);
    moves.map(|(each, number)| offer(each, number)).collect()
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
