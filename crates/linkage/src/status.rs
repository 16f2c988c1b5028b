//! Reasons why a dyad has no solution.

use thiserror::Error;
use trirrr_core::dyad::OutOfReach;

/// Reason why a dyad has no solution for the motion of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum LinkageStatus {
    /// The dyad cannot be assembled: its ends are too far apart or too close. Input that is not a
    /// number ends here too.
    #[error("the dyad cannot be assembled: its ends are out of reach")]
    Unreachable,
    /// The dyad can be assembled but its links have no defined velocity: two solutions coincide,
    /// or the links are free to move although both ends stand still.
    #[error("the dyad is singular: its links have no defined velocity")]
    Singular,
    /// A result exceeds the range of the number type.
    #[error("a result exceeds the range of the number type")]
    OutOfRange,
}

impl From<OutOfReach> for LinkageStatus {
    fn from(reason: OutOfReach) -> Self {
        match reason {
            OutOfReach::Unreachable => Self::Unreachable,
            OutOfReach::Singular => Self::Singular,
        }
    }
}
