//! Reasons why a dyad has no solution.

use super::rrr::OutOfReach;
use core::fmt;

/// Reason why a dyad, or a mechanism made of dyads, has no solution for a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkageStatus {
    /// The dyad cannot be assembled: its ends are too far apart or too close. Input that is not a
    /// number ends here too.
    Unreachable,
    /// The dyad can be assembled but its links have no defined velocity: two solutions coincide,
    /// or the links are free to move although both ends stand still.
    Singular,
    /// A result exceeds the range of the number type.
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

impl fmt::Display for LinkageStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreachable => "the dyad cannot be assembled: its ends are out of reach",
            Self::Singular => "the dyad is singular: its links have no defined velocity",
            Self::OutOfRange => "a result exceeds the range of the number type",
        })
    }
}

impl core::error::Error for LinkageStatus {}
