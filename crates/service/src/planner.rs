//! Planner of paths, as the background asks it: a path comes in pieces, and leaves as moves.

use crate::admission::Path;
use crate::number::ServiceNumber;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::model::Model;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_core::to_source;
use trirrr_protocol::message::{PathPiece, QuinticMove, Transmit, Violation};

/// Tolerances and steps of a planner, in the machine's units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Planning<N: Number> {
    /// Length of a tick.
    pub period: N,
    /// Time of the shortest move.
    pub step: N,
    /// Ticks of the shortest move.
    pub ticks: u32,
    /// The longest move, in shortest ones.
    pub longest: u32,
    /// Tolerances of D and of alpha, rad, for moves beside the smoothed motion.
    pub tolerances: [N; 2],
    /// Most of the acceleration across the path, of D and of alpha: smoothing leaves the path by as much.
    pub bends: [N; 2],
    /// Largest distance of a platform joint from D.
    pub lever: N,
    /// Rate at which a hold may change the pace anywhere on the path, per unit of time; 0 leaves no room for holds.
    pub hold_rate: N,
}

to_source!(pub [N: Number] Planning [N] in trirrr_service::features {
    period,
    step,
    ticks,
    longest,
    tolerances,
    bends,
    lever,
    hold_rate,
});

impl<N: Number> Planning<N> {
    /// Of a planner that is not set up.
    pub const NONE: Self = Self {
        period: N::ZERO,
        step: N::ZERO,
        ticks: 0,
        longest: 0,
        tolerances: [N::ZERO; 2],
        bends: [N::ZERO; 2],
        lever: N::ZERO,
        hold_rate: N::ZERO,
    };

    /// The same in another number type.
    pub fn convert<T: Number>(&self, number: impl Fn(N) -> T) -> Planning<T> {
        Planning {
            period: number(self.period),
            step: number(self.step),
            ticks: self.ticks,
            longest: self.longest,
            tolerances: self.tolerances.map(&number),
            bends: self.bends.map(&number),
            lever: number(self.lever),
            hold_rate: number(self.hold_rate),
        }
    }
}

/// Result of a step of a planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathStep<N: ServiceNumber> {
    /// There is more to do.
    Working,
    /// Nothing to do before the next piece comes.
    Waiting,
    /// A move. The planner waits for [`keep`](PathPlanner::keep) or [`cut`](PathPlanner::cut). Its number counts for nothing.
    Move(QuinticMove<N>),
    /// The path is planned to its end.
    Done,
    /// The path ends early, at the obstacle on a piece.
    Refused {
        /// Number of the piece.
        number: u32,
        /// The obstacle; its place is the parameter of the piece, 0 to 1.
        violation: Violation<N>,
    },
}

/// Planner of paths: a type, so that a scene without pays nothing for it. That is `()`.
pub trait PathPlanner<N: ServiceNumber> {
    /// A planner that cannot plan yet. It lies in the memory of the [channels](crate::Channels).
    const EMPTY: Self;

    /// Makes an idle planner, or none without settings.
    fn set_up(&mut self, planning: Option<Planning<N>>);

    /// Returns true if it can plan.
    fn can_plan(&self) -> bool;

    /// Returns true while a path is under way.
    fn is_active(&self) -> bool;

    /// Begins a path at `pose`, at rest.
    fn begin(&mut self, pose: Pose<N>);

    /// Takes a piece. Returns false where there is no room, or no way to its end.
    fn push(&mut self, piece: &PathPiece<N>) -> bool;

    /// Bounded work. `path` has the coefficients of the admission.
    fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> PathStep<N>;

    /// The move was admitted.
    fn keep(&mut self);

    /// The move was refused.
    fn cut<M: Model<N = N>>(&mut self, path: &Path<M>, violation: &Violation<N>);

    /// Drops the path.
    fn drop_path(&mut self);
}

impl<N: ServiceNumber> PathPlanner<N> for () {
    const EMPTY: Self = ();

    #[inline(always)]
    fn set_up(&mut self, _: Option<Planning<N>>) {}

    #[inline(always)]
    fn can_plan(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_active(&self) -> bool {
        false
    }

    #[inline(always)]
    fn begin(&mut self, _: Pose<N>) {}

    #[inline(always)]
    fn push(&mut self, _: &PathPiece<N>) -> bool {
        false
    }

    #[inline(always)]
    fn step<M: Model<N = N>>(&mut self, _: &Path<M>) -> PathStep<N> {
        PathStep::Done
    }

    #[inline(always)]
    fn keep(&mut self) {}

    #[inline(always)]
    fn cut<M: Model<N = N>>(&mut self, _: &Path<M>, _: &Violation<N>) {}

    #[inline(always)]
    fn drop_path(&mut self) {}
}
