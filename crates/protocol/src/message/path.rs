//! Paths that a machine plans itself.

use super::Transmit;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;

/// A piece of a path. It begins where the path ends so far: at the end of the last piece, or, for the first one, at rest
/// where all moves end. D follows the curve; alpha goes from one end to the other with the parameter of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct PathPiece<N: Number> {
    /// Counts the pieces one by one, modulo 2^32; [`Status`](super::Status) says which is expected.
    pub number: u32,
    /// The curve.
    pub curve: PathCurve<N>,
    /// Greatest speed of D, positive; 0 for none.
    pub feed: N,
    /// The tool's power, as in a [`Move`](super::Move).
    pub tool_power: N,
    /// Speed of the tool at which it has that power, as in a [`Move`](super::Move).
    pub tool_speed: N,
    /// True for the last piece of the path. The machine plans as soon as it has room for no more, or has the last one.
    pub last: bool,
}

/// Curve of a [`PathPiece`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum PathCurve<N: Number> {
    /// A straight line.
    Line {
        /// Its end.
        to: Pose<N>,
    },
    /// A circular arc.
    Arc {
        /// Centre of the circle, (x, y).
        centre: [N; 2],
        /// Angle about the centre, rad, counter-clockwise positive.
        turn: N,
        /// alpha at its end.
        to_angle: N::Angle,
    },
    /// A cubic Bezier curve, of alpha too.
    Bezier {
        /// The two control poses between its ends.
        controls: [Pose<N>; 2],
        /// Its end.
        to: Pose<N>,
    },
}
