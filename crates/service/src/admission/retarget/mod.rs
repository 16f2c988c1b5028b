//! Retargets: from any state of motion to another, in the least time that is proven.
//!
//! A few shapes of motion are tried ([`chain::Shape`]): a single quintic; and chains of quintics along a profile that
//! speeds up, goes on and slows down, with what the ends have of velocity brought to rest on the way or before it. For
//! each, [`timing`] finds the least duration at which samples keep the limits: by the admission's own check, at single
//! instants. The shortest of them is proven, move by move, by the judgement that every offered move gets. Where the
//! proof fails the candidate takes a little longer, and the shortest is proven again.
//!
//! The last shape comes to rest, goes to the target from rest to rest and speeds up to the target's motion. It exists
//! wherever both ends can come to rest and the straight way between is free, and the slower it goes the less it needs.

mod aim;
mod chain;
mod profile;
mod prove;
mod timing;

use super::Path;
use crate::admission::Enclose;
use crate::pace::MovePaces;
pub use aim::Aim;
use trirrr_core::model::Model;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::{QuinticMove, Violation};

/// Reason why there is no motion to the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blocked {
    /// The start breaks a limit by itself.
    Start,
    /// The target breaks a limit by itself: the machine cannot be there, stand there, or move there like that.
    Target,
    /// The motion at the start does not come to rest within the limits.
    Stop,
    /// The motion at the target cannot be taken up from rest within the limits.
    Arrival,
    /// The straight way to the target, from where the machine can stop, is blocked.
    Way,
}

/// Refusal of a retarget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RetargetRefusal<N: Enclose> {
    /// The reason.
    pub blocked: Blocked,
    /// A limit that is broken, or not proven to be kept.
    pub violation: Violation<N>,
    /// Ends of the straight way: where the motion at the start can stop, and where that at the target can be taken up.
    /// Start and target themselves, where the reason is another than [`Blocked::Way`].
    pub way: [Pose<N>; 2],
}

/// Task of a retarget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RetargetTask<N: Number> {
    /// State in which the motion begins.
    pub start: Setpoint<N>,
    /// State in which it ends.
    pub target: Setpoint<N>,
    /// Most moves of the motion.
    pub most: usize,
    /// Fewest ticks of the motion.
    pub least: u32,
}

impl<N: Number> RetargetTask<N> {
    /// As fast as it can be, in any number of moves.
    pub fn new(start: &Setpoint<N>, target: &Setpoint<N>) -> Self {
        Self {
            start: *start,
            target: *target,
            most: usize::MAX,
            least: 0,
        }
    }
}

/// State of a retarget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Retargeted<N: Enclose> {
    /// Not decided yet: go on with [`Retarget::step`].
    Undecided,
    /// A motion is proven. It has so many moves, 0 where the start is the target.
    Planned(usize),
    /// There is none.
    Refused(RetargetRefusal<N>),
}

/// Plans one motion at a time, from a state to a target.
pub struct Retarget<M: Model<N: Enclose>> {
    path: Path<M>,
    aim: Aim<M::N>,
}

impl<N: Enclose, M: Model<N = N>> Retarget<M> {
    /// With coefficients that are built.
    pub fn over(path: Path<M>, start: &Setpoint<N>, target: &Setpoint<N>) -> Self {
        let aim = Aim::new(&path, &RetargetTask::new(start, target));
        Self { path, aim }
    }

    /// Takes a new start and target, and drops the work under way.
    pub fn aim(&mut self, start: &Setpoint<N>, target: &Setpoint<N>) {
        self.plan(&RetargetTask::new(start, target));
    }

    /// Takes a new task, and drops the work under way.
    pub fn plan(&mut self, task: &RetargetTask<N>) {
        self.aim = Aim::new(&self.path, task);
    }

    /// Does a bounded amount of work: measures one instant or interval.
    pub fn step(&mut self) -> Retargeted<N> {
        self.aim.step(&self.path)
    }

    /// Move `index` of the planned motion, from 0, with this number. The first starts with the start's bits, the last
    /// ends with the target's.
    pub fn planned(&self, index: usize) -> Option<QuinticMove<N>> {
        self.aim.planned(index)
    }
}

/// Work on a retarget, or the place for it. Empty for machines that play no quintics.
pub trait Aiming<N: Enclose>: Sized {
    /// No work.
    const NONE: Self;

    /// Takes a task.
    fn aim<M: Model<N = N>>(&mut self, path: &Path<M>, task: &RetargetTask<N>);

    /// As [`Retarget::step`]; none where there is no work.
    fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Option<Retargeted<N>>;

    /// As [`Retarget::planned`].
    fn planned(&self, index: usize) -> Option<QuinticMove<N>>;

    /// Rates at which the pace may change on move `index` of the planned motion.
    fn paces(&self, index: usize) -> &MovePaces;

    /// Returns true if there is work, done or not.
    fn is_under_way(&self) -> bool;
}

impl<N: Enclose> Aiming<N> for () {
    const NONE: Self = ();

    #[inline(always)]
    fn aim<M: Model<N = N>>(&mut self, _: &Path<M>, _: &RetargetTask<N>) {}

    #[inline(always)]
    fn step<M: Model<N = N>>(&mut self, _: &Path<M>) -> Option<Retargeted<N>> {
        None
    }

    #[inline(always)]
    fn planned(&self, _: usize) -> Option<QuinticMove<N>> {
        None
    }

    #[inline(always)]
    fn paces(&self, _: usize) -> &MovePaces {
        &MovePaces::FULL
    }

    #[inline(always)]
    fn is_under_way(&self) -> bool {
        false
    }
}

impl<N: Enclose, const JERK: bool> Aiming<N> for Option<Aim<N, JERK>> {
    const NONE: Self = None;

    fn aim<M: Model<N = N>>(&mut self, path: &Path<M>, task: &RetargetTask<N>) {
        *self = Some(Aim::new(path, task));
    }

    fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Option<Retargeted<N>> {
        self.as_mut().map(|aim| aim.step(path))
    }

    fn planned(&self, index: usize) -> Option<QuinticMove<N>> {
        self.as_ref()?.planned(index)
    }

    #[inline(never)] // size: docs/size.md, rule 3
    fn paces(&self, index: usize) -> &MovePaces {
        self.as_ref()
            .map_or(&MovePaces::FULL, |aim| aim.paces(index))
    }

    fn is_under_way(&self) -> bool {
        self.is_some()
    }
}
