//! A scene's job as the moves that a client offers to a machine.

use crate::words::Units;
use nalgebra::Vector3;
use trirrr_core::message::{Move, Transmit};
use trirrr_core::setpoint::Pose;
use trirrr_scene::{self as scene, Scene};

/// The moves of a scene's job in the number type `N` and in `units`, numbered from 0.
pub fn moves<N: Transmit>(scene: &Scene, units: &Units) -> Vec<Move<N>> {
    let moves = scene.job.moves.iter().zip(0..);
    moves
        .map(|(each, number)| offer(each, number, units))
        .collect()
}

fn offer<N: Transmit>(each: &scene::Move, number: u32, units: &Units) -> Move<N> {
    let Units {
        length_m, time_s, ..
    } = *units;
    // Of the float types both are 1, and dividing by that changes nothing.
    let pose = |pose: &Pose<f64>| {
        Pose::from_f64(
            pose.position.x / length_m,
            pose.position.y / length_m,
            pose.angle,
        )
    };
    let velocity = |v: &Vector3<f64>| {
        let speed = length_m / time_s;
        [v.x / speed, v.y / speed, v.z * time_s].map(N::from_f64)
    };
    let (power, speed) = match each.tool {
        Some(tool) => (tool.power, tool.speed_m_s * time_s / length_m),
        None => (0.0, 0.0),
    };
    Move {
        number,
        from: pose(&each.from),
        to: pose(&each.to),
        start_velocity: velocity(&each.start_velocity),
        end_velocity: velocity(&each.end_velocity),
        ticks: each.duration_ticks,
        tool_power: N::from_f64(power),
        tool_speed: N::from_f64(speed),
    }
}
