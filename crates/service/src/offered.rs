//! Moves as the background keeps them until they are judged, of the kinds that the scene plays.

use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, Ends};
use trirrr_protocol::message::{AnyMove, Move, QuinticMove};

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
