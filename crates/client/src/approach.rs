//! Way to the start of a job from beside it.

use crate::describe::Units;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Recovery, Transmit};

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
