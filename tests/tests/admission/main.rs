//! Admission against dense samples of the tick itself: what is admitted keeps its limits at every
//! instant, what is refused does not, and what is said about it is so.

mod certain;
mod dense;
mod first;
mod input;
mod jerk;
mod judge;
mod moves;
mod paces;
mod rounding;
mod scenes;
mod shortest;
mod singular;
mod study;
mod types;

use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::Move;

/// The thesis's move in `ticks` ticks.
fn thesis_move<N: Number>(ticks: u32) -> Move<N> {
    Move {
        number: 0,
        from: Pose::from_f64(0.21, 0.22, core::f64::consts::PI / 20.0),
        to: Pose::from_f64(0.28, 0.28, core::f64::consts::PI / 15.0),
        start_velocity: [N::ZERO; 3],
        end_velocity: [N::ZERO; 3],
        ticks,
        tool_power: N::ZERO,
        tool_speed: N::ZERO,
    }
}
