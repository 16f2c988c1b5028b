//! Moves as the background keeps them until they are judged, of the kinds that the scene plays.

use crate::admission::{Aim, Aiming};
use crate::background::Retargeting;
use crate::levels::LevelKind;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::splice::{Optional, Present, SpliceChannels, SpliceQueues};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Cubics, CurveKind, Ends, Pose, Quintics};
use trirrr_protocol::message::{
    AnyMove, Command, Content, Goal, Move, PathPiece, QuinticContent, QuinticMove, Request, Unread,
};

/// Kinds of moves that a service plays.
pub trait PlayedCurves: CurveKind {
    /// Type as which a quintic move in a request is read.
    type Request<N: ServiceNumber>: Content<QuinticMove<N>>
        + QuinticContent<Goal: Content<Goal<N>>, Piece: Content<PathPiece<N>>>;

    /// Work on a retarget.
    type Aim<N: ServiceNumber>: Aiming<N>;

    /// Memory of splices.
    type Splices<N: ServiceNumber>: SpliceChannels<N, Self>;

    /// Retarget by command, and moves of it that are ordered.
    type Retargeting<N: ServiceNumber>: Optional<Retargeting<N>>;

    /// True if a retarget may cut moves.
    const CUTS: bool;

    /// No retarget by command.
    fn retargeting<N: ServiceNumber>(stands: Pose<N>) -> Self::Retargeting<N>;

    /// A quintic move as a service reads it.
    fn request<N: ServiceNumber>(quintic: &QuinticMove<N>) -> Self::Request<N>;
}

impl PlayedCurves for Cubics {
    type Request<N: ServiceNumber> = Unread<QuinticMove<N>>;
    type Aim<N: ServiceNumber> = ();
    type Splices<N: ServiceNumber> = ();
    type Retargeting<N: ServiceNumber> = ();
    const CUTS: bool = false;

    #[inline(always)]
    fn retargeting<N: ServiceNumber>(_: Pose<N>) {}

    #[inline(always)]
    fn request<N: ServiceNumber>(_: &QuinticMove<N>) -> Unread<QuinticMove<N>> {
        Unread::CONTENT
    }
}

impl<const JERK: bool> PlayedCurves for Quintics<JERK> {
    type Request<N: ServiceNumber> = QuinticMove<N>;
    type Aim<N: ServiceNumber> = Option<Aim<N, JERK>>;
    type Splices<N: ServiceNumber> = SpliceQueues<N, Self>;
    type Retargeting<N: ServiceNumber> = Present<Retargeting<N>>;
    const CUTS: bool = true;

    fn retargeting<N: ServiceNumber>(stands: Pose<N>) -> Present<Retargeting<N>> {
        Present(Retargeting::new(stands))
    }

    fn request<N: ServiceNumber>(quintic: &QuinticMove<N>) -> QuinticMove<N> {
        *quintic
    }
}

/// Types as which a service of the scene `S` reads quintics, batches, power lists and updates.
type ContentsOf<S> = (
    <<S as Scene>::Curves as PlayedCurves>::Request<<S as Scene>::N>,
    <S as Scene>::Batch,
    <<S as Scene>::Levels as LevelKind<<S as Scene>::N>>::Request,
    <S as Scene>::Update,
);

/// Command as a service of the scene `S` reads it.
pub type CommandOf<S> = Command<<S as Scene>::N, <S as Scene>::Replacement, ContentsOf<S>>;

/// Offer of a move to a service of the scene `S`.
pub fn command_of<S: Scene>(offered: &AnyMove<S::N>) -> CommandOf<S> {
    match offered {
        AnyMove::Cubic(cubic) => Command::Move(*cubic),
        AnyMove::Quintic(quintic) => Command::Quintic(S::Curves::request(quintic)),
    }
}

/// Request as a service of the scene `S` reads it.
pub type RequestOf<S> = Request<<S as Scene>::N, <S as Scene>::Replacement, ContentsOf<S>>;

/// A move of the kinds `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Offered<N: Number, K: CurveKind> {
    pub(crate) common: Move<N>,
    pub(crate) accelerations: K::Accelerations<N>,
}

impl<N: Number, K: CurveKind> Offered<N, K> {
    pub(crate) fn cubic(common: &Move<N>) -> Self {
        Self {
            common: *common,
            accelerations: K::none(),
        }
    }

    /// The move, if the machine plays quintics.
    #[inline(always)]
    pub(crate) fn of_quintic(quintic: &QuinticMove<N>) -> Option<Self> {
        let accelerations = [quintic.start_acceleration, quintic.end_acceleration];
        Some(Self {
            common: quintic.common,
            accelerations: K::some(accelerations)?,
        })
    }

    /// The move, if the machine plays its kind.
    pub(crate) fn of(any: &AnyMove<N>) -> Option<Self> {
        match any {
            AnyMove::Cubic(cubic) => Some(Self::cubic(cubic)),
            AnyMove::Quintic(quintic) => Self::of_quintic(quintic),
        }
    }

    pub(crate) fn ends(&self) -> Ends<N, K> {
        let Move {
            from,
            to,
            start_velocity,
            end_velocity,
            ..
        } = self.common;
        Ends {
            from,
            to,
            velocities: [start_velocity.into(), end_velocity.into()],
            accelerations: self.accelerations,
        }
    }

    /// Accelerations at both ends of a quintic.
    pub(crate) fn quintic(&self) -> Option<[[N; 3]; 2]> {
        K::given(&self.accelerations)
    }
}
