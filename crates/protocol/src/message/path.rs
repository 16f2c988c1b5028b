//! Paths that a machine plans itself.

use super::Transmit;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;

/// A piece of a path. It begins where the path ends so far: at the end of the last piece, or, for the first one, at
/// rest in `Status.end`. D follows the curve; alpha goes from one end to the other with the parameter of the curve.
/// Only an image whose scene has `plans_paths` takes it; others answer `NoPaths`.
///
/// `Done` means that the machine keeps the piece, `QueueFull` that there is no room yet. The machine plans as soon as
/// it has room for no more, or has the last piece. It plans as long as `Status.room` is positive. In `Idle` that ends
/// before the last piece of a long path: **`Start` once `Status.room` is 0**, or once the last piece is given and a
/// move is admitted, and offer the same piece again while the moves are played. A host that waits for room without
/// `Start` waits for ever. A piece without a length counts, and leads nowhere. Its moves are numbered from
/// `Status.next` on, and each gets its Verdict. `Status.planning` is true until the last one is admitted. The machine
/// stops where two pieces meet at an angle; round the corner by a Bezier curve if it is not to. Where there is no way,
/// a Verdict with the number `Status.next` has the violation, `at` is the parameter of the piece, and `Status.piece`
/// its number: that piece and all behind it are dropped, the motion comes to rest before it where it can, and the next
/// path begins where it rests. So does a path after a stop or a fault, which drop all that is planned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct PathPiece<N: Number> {
    /// Counts the pieces one by one, modulo 2^32; `Status.piece` says which is expected.
    pub number: u32,
    /// The curve.
    pub curve: PathCurve<N>,
    /// Greatest speed of D, positive; 0 for none.
    pub feed: N,
    /// The tool's power, as in a [`Move`](super::Move).
    pub tool_power: N,
    /// Speed of the tool at which it has that power, as in a [`Move`](super::Move).
    pub tool_speed: N,
    /// True for the last piece of the path.
    pub last: bool,
}

/// The curve of a piece.
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
