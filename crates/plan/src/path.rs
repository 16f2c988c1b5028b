//! A path as a planner takes it: pieces, places on them, and the place where it is refused.

use crate::cell::Obstacle;
use crate::piece::{Piece, joint};
use trirrr_core::setpoint::Pose;

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPlace {
    /// Index of the piece.
    pub piece: usize,
    /// Parameter of the piece, 0 to 1.
    pub p: f64,
}

/// A piece of a path with what goes for it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// The geometry.
    pub piece: Piece<f64>,
    /// Greatest speed of D, m/s, if it is limited.
    pub feed_m_s: Option<f64>,
    /// Number of the piece in the user's path, from 0.
    pub source: usize,
    /// The motion stops where the piece begins, even where it could go on.
    pub stops: bool,
    /// Number of the tool's setting along the piece: a move ends where it changes.
    pub setting: usize,
}

impl PathPiece {
    /// Scale of x = (dp/dt)^2 from the end of `before` to the start of this piece; none where the motion stops between
    /// the two.
    pub(crate) fn joint(&self, before: &Self) -> Option<f64> {
        match self.stops {
            true => None,
            false => joint(&before.piece, &self.piece),
        }
    }
}

/// Refusal of a path: no motion along it keeps the limits, or none was found to be proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathRefusal {
    /// The first place found.
    pub place: PathPlace,
    /// Pose there.
    pub pose: Pose<f64>,
    /// The reason.
    pub obstacle: Obstacle,
}

impl PathRefusal {
    /// Refuses the path of `pieces` at `place`.
    pub(crate) fn at(place: PathPlace, pieces: &[PathPiece], obstacle: Obstacle) -> Self {
        Self {
            place,
            pose: pieces[place.piece].piece.at(place.p).pose,
            obstacle,
        }
    }
}
