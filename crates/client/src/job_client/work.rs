//! Work of a job: moves, with levels or without, here or supplied, or a path.

use super::supply::{MoveChecksum, SuppliedMoves};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, JobLabel, LEVELS, LevelPiece, PathPiece, Transmit};
use trirrr_protocol::wire::checksum;
use trirrr_scene::{JobLevels, JobOutputs};

/// Work of a job.
#[derive(Clone, Debug)]
pub enum JobWork<N: Transmit> {
    /// Moves.
    Moves(Vec<AnyMove<N>>),
    /// Moves, some of which have levels of the tool's power.
    Listed {
        /// The moves.
        moves: Vec<AnyMove<N>>,
        /// Their levels.
        levels: JobLevels,
    },
    /// Moves that the owner of the client supplies as the job goes on.
    Supplied(SuppliedMoves<N>),
    /// A path that the machine plans itself.
    Path {
        /// Pose at its start.
        start: Pose<N>,
        /// Pieces, the last one marked.
        pieces: Vec<PathPiece<N>>,
    },
}

impl<N: Transmit> JobWork<N> {
    /// The work of `moves` with these levels.
    pub fn of(moves: Vec<AnyMove<N>>, levels: &JobLevels) -> Self {
        match levels.is_empty() {
            true => Self::Moves(moves),
            false => Self::Listed {
                moves,
                levels: levels.clone(),
            },
        }
    }

    /// Returns all moves, if the client has them: not those of a path, or of a job that is supplied as it goes on.
    pub fn moves(&self) -> Option<&[AnyMove<N>]> {
        match self {
            Self::Moves(moves) | Self::Listed { moves, .. } => Some(moves),
            Self::Supplied(_) | Self::Path { .. } => None,
        }
    }

    /// Returns the moves that the client has, and the index of the first; none of a path.
    pub(super) fn here(&self) -> Option<(&[AnyMove<N>], u32)> {
        match self {
            Self::Supplied(moves) => Some(moves.here()),
            work => work.moves().map(|moves| (moves, 0)),
        }
    }

    /// Returns the levels of the moves, if there are any.
    pub(super) fn levels(&self) -> Option<&JobLevels> {
        match self {
            Self::Listed { levels, .. } => Some(levels),
            Self::Moves(_) | Self::Supplied(_) | Self::Path { .. } => None,
        }
    }

    /// Returns the number of items: moves, or pieces.
    pub fn items(&self) -> u32 {
        // A machine counts them in 32 bits.
        match self {
            Self::Moves(moves) | Self::Listed { moves, .. } => moves.len() as u32,
            Self::Supplied(moves) => moves.items(),
            Self::Path { pieces, .. } => pieces.len() as u32,
        }
    }

    /// Returns the label of the job under `name`. Its checksum is over all items.
    pub fn label(&self, name: &str) -> JobLabel {
        // Every part has a length that is known beforehand.
        let add = |sum: u32, part: Option<u32>| checksum(&(sum, part)).unwrap_or_default();
        let of_moves = |moves: &[AnyMove<N>]| {
            let mut check = MoveChecksum::default();
            moves.iter().for_each(|each| check.add(each));
            check.value()
        };
        let check = match self {
            Self::Moves(moves) => of_moves(moves),
            Self::Listed { moves, levels } => {
                let pieces = levels.levels.chunks(LEVELS);
                let pieces = pieces.map(|part| checksum(&LevelPiece::new(0, part)));
                let sum = pieces.fold(of_moves(moves), add);
                levels.ranges.iter().map(checksum).fold(sum, add)
            }
            Self::Supplied(moves) => moves.check().value(),
            Self::Path { pieces, .. } => pieces.iter().map(checksum).fold(0, add),
        };
        JobLabel {
            name: trirrr_service::name(name),
            items: self.items(),
            check,
        }
    }
}

/// Returns the label of the job with which the outputs `outputs` change. Its checksum is over those, too, if there are any.
pub fn switched_label(label: JobLabel, outputs: &JobOutputs) -> JobLabel {
    let changes = outputs.changes().iter();
    // Every part has a length that is known beforehand.
    let check = changes.fold(label.check, |sum, (index, bits)| {
        checksum(&(sum, *index, bits.on, bits.off)).unwrap_or_default()
    });
    JobLabel { check, ..label }
}

impl<N: Transmit> From<Vec<AnyMove<N>>> for JobWork<N> {
    fn from(moves: Vec<AnyMove<N>>) -> Self {
        Self::Moves(moves)
    }
}
