//! Kinds of moves that a scene chooses by type: a scene without quintics has no code for them.

use crate::admission::{Aim, Aiming};
use crate::feature::{Feature, On};
use crate::number::ServiceNumber;
use trirrr_core::setpoint::{Cubics, CurveKind, Quintics};

/// Kinds of moves that a service plays.
pub trait PlayedCurves: CurveKind {
    /// Quintics, and with them retargets.
    type QuinticMoves: Feature;

    /// Work on a retarget.
    type Aim<N: ServiceNumber>: Aiming<N>;

    /// True if a retarget may cut moves.
    const CUTS: bool = Self::QuinticMoves::EXISTS;
}

impl PlayedCurves for Cubics {
    type QuinticMoves = ();
    type Aim<N: ServiceNumber> = ();
}

impl<const JERK: bool> PlayedCurves for Quintics<JERK> {
    type QuinticMoves = On;
    type Aim<N: ServiceNumber> = Option<Aim<N, JERK>>;
}
