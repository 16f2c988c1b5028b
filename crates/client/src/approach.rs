//! Ways to the start of a job: from beside it, and from anywhere.

use crate::describe::Units;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Move, Recovery, Transmit};

/// A machine is beside a pose if D is nearer than this, m,
const NEAR_M: f64 = 5e-4;

/// and alpha, rad.
const NEAR_RAD: f64 = 5e-3;

/// Duration of the way, s: slow, for the motors move one by one.
const WAY_S: f64 = 0.2;

/// Returns the way to `start` for a machine that stands at `stands`, beside it: a machine that was measured stands nowhere exactly. `None` if it stands
/// there, or farther away.
pub fn short_way<N: Transmit>(
    stands: &Pose<N>,
    start: &Pose<N>,
    units: &Units,
) -> Option<Recovery<N>> {
    let off = stands.displacement(start).map(N::to_f64);
    let is_near = off.x.hypot(off.y) * units.length_m < NEAR_M && off.z.abs() < NEAR_RAD;
    (is_near && stands != start).then(|| Recovery {
        to: *start,
        ticks: (WAY_S * units.tick_rate_hz).ceil().max(1.0) as u32,
    })
}

/// Greatest speed of D on the way from anywhere, m/s,
const WAY_M_S: f64 = 0.05;

/// and of alpha, rad/s: slow, for nobody has drawn this way.
const WAY_RAD_S: f64 = 0.5;

/// Returns the straight way to `start` from `stands`, with the tool off, as move `number`.
pub(crate) fn straight_way<N: Transmit>(
    number: u32,
    stands: &Pose<N>,
    start: &Pose<N>,
    units: &Units,
) -> Move<N> {
    let way = stands.displacement(start).map(N::to_f64);
    let linear_s = way.x.hypot(way.y) * units.length_m / WAY_M_S;
    // A cubic from rest to rest is 1.5 times as fast half way as in the mean.
    let seconds = 1.5 * linear_s.max(way.z.abs() / WAY_RAD_S);
    // From float to integer the cast saturates, and the machine refuses so many.
    let ticks = (seconds.max(WAY_S) * units.tick_rate_hz).ceil() as u32;
    Move::rest_to_rest(number, *stands, *start, ticks)
}
