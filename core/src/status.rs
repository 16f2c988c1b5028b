//! Failure of an evaluation.

use core::fmt;

/// Reason why a setpoint has no motion. Legs are numbered 0 to 2 here and 1 to 3 in messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The platform joint is further from the motor than the leg is long, or closer than it folds.
    Unreachable {
        /// The leg.
        leg: usize,
    },
    /// The leg is exactly stretched or folded: its joint rates are not defined.
    SerialSingular {
        /// The leg.
        leg: usize,
    },
    /// The lines of the three distal links meet in one point or are parallel, to within the
    /// rounding of the number type: the torques are not defined.
    ParallelSingular,
    /// A result is beyond the range of the number type.
    OutOfRange,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Status::Unreachable { leg } => write!(f, "unreachable: leg {}", leg + 1),
            Status::SerialSingular { leg } => write!(f, "serial singular: leg {}", leg + 1),
            Status::ParallelSingular => write!(f, "parallel singular"),
            Status::OutOfRange => write!(f, "out of range of the number type"),
        }
    }
}

impl core::error::Error for Status {}
