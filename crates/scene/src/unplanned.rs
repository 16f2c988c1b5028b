//! Reasons why a path has no plan.

use crate::obstacle::obstacle;
use crate::tool::NO_SPEED;
use thiserror::Error;
use trirrr_core::machine::BuildError;
use trirrr_plan::course::PathRefusal;

/// Reason why a path has no plan.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unplanned {
    /// The machine or a limit is refused.
    #[error(transparent)]
    Machine(#[from] BuildError),
    /// Each run can be played, but not in units that hold all of them.
    #[error(
        "the number type of the scene has no units for all pieces together; take another number type or two jobs"
    )]
    Units,
    /// An obstacle on the path.
    #[error("{}", obstacle(refusal))]
    Path {
        /// Number of the piece in the file, from 0.
        number: usize,
        /// Place and reason.
        refusal: PathRefusal,
    },
    /// The machine does not stand for a dwell: the service does not admit a stand that the plan allows.
    #[error(
        "the machine cannot stand there: a limit at rest leaves no room for the number type of the scene"
    )]
    Dwell {
        /// Number of the dwell in the file, from 0.
        number: usize,
    },
    /// A dwell is too long for the service.
    #[error("the machine stands for {ticks} ticks; a dwell lasts {longest} at most")]
    LongDwell {
        /// Number of the dwell in the file, from 0.
        number: usize,
        /// Ticks of the dwell, and the most that the service plays.
        ticks: u32,
        /// Most ticks of a move.
        longest: u32,
    },
    /// The tool passes more levels in a tick than the service plays, or D turns back among them.
    #[error(
        "the pixels of the row are too short for the speed: the tool changes at ticks; take a lower speed or a larger pitch"
    )]
    Levels {
        /// Number of the row's part in the file, from 0.
        number: usize,
    },
    /// The power of a tool that is on or off follows the speed.
    #[error("{NO_SPEED}")]
    Tool {
        /// Number of the table in the file, from 0.
        number: usize,
    },
    /// The job is longer than a service counts.
    #[error("the moves take {0} ticks together, at most 4294967295 are allowed")]
    Ticks(u64),
    /// An obstacle whatever alpha is.
    #[error("{}; no other alpha leads past this place", obstacle(refusal))]
    NoAlpha {
        /// Number of the piece in the file, from 0.
        number: usize,
        /// Place and reason, with one alpha.
        refusal: PathRefusal,
    },
}

impl Unplanned {
    /// The same of a whole path, from a block of it that begins at `source` in the file, and at `piece`.
    pub(crate) fn in_block(mut self, source: usize, piece: usize) -> Self {
        match &mut self {
            Self::Path { number, refusal } | Self::NoAlpha { number, refusal } => {
                *number += source;
                refusal.place.piece += piece;
            }
            Self::Dwell { number }
            | Self::LongDwell { number, .. }
            | Self::Levels { number }
            | Self::Tool { number } => {
                *number += source;
            }
            Self::Machine(_) | Self::Units | Self::Ticks(_) => {}
        }
        self
    }
}
