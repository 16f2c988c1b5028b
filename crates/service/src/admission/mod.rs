//! Admission: the proof that a move can be played. The background takes it up when the move is
//! offered, in slices of bounded work.
//!
//! # What is checked
//! The whole path, every instant of it and not its ticks only: reach, the distances to both
//! singularities, and of each motor rate, acceleration, torque, power and jerk; at normal speed, and
//! while a hold, a stop or a resume anywhere on the path scales the speed along it.
//!
//! # How
//! The path is divided into intervals of time, dyadically and adaptively. On each the stages of
//! the tick are run on Taylor models, numbers that stand for a quantity during the whole interval:
//! their result is a bound, rounding of the number type included. Where the bounds keep the limits
//! the interval is done with; where they do not it is halved; where it cannot be halved any more,
//! the move is refused. What is admitted is so for certain: no tick of it, and no instant between
//! ticks, goes beyond a limit. (In binary32 that is certain of the true motion; a value of the tick is off by its own
//! rounding, of which the bounds hold a part.) What is refused breaks a limit, or comes nearer to it than the bounds
//! of the shortest interval tell apart; `docs/admission.md` has how near that is. The refusal says
//! which: where an interval cannot be halved any more, the rest of the move is looked at, instant by
//! instant, for a limit that is broken for certain.
//!
//! The intervals are taken in the order of time, so that what is named is the first violation.
//!
//! # The shortest duration
//! The refusal of a move that is merely too fast names the shortest duration that would pass. From rest to rest
//! the path is the same at any duration, and what is broken less the slower it is played; the
//! duration named is the shortest that passes this very check. With a velocity at an end, which
//! stays as it is, the path changes with the duration: the duration named passes the check, one
//! tick less does not, and no longer ones were needed to find it; a shorter one between may exist.
//! Where durations up to many times the offered one do not pass, none is named. With the duration goes the
//! longest one that was found to break a limit for certain: between the two nothing is proven.
//!
//! [`Admission::offer`] takes the move, [`Admission::step`] does one interval of work.

mod bounds;
mod breach;
mod enclose;
mod instances;
mod legs;
mod path;
mod refusal;
mod retarget;
mod scan;
mod shortest;
mod taylor;
mod two_word;

pub use enclose::Enclose;
#[doc(hidden)]
pub use instances::instances;
pub use path::Path;
pub(crate) use retarget::Aiming;
pub use retarget::{Aim, Blocked, Retarget, RetargetRefusal, RetargetTask, Retargeted};
pub use taylor::{AngleModel, ModelLine, TaylorModel};
pub use two_word::TwoWord;

use crate::offered::Offered;
use crate::pace::{MovePaces, Ramp};
use breach::Breach;
use nalgebra::Vector3;
use scan::{Scan, Scanned};
use shortest::{Found, Search};
use trirrr_core::limits::Limits;
use trirrr_core::machine::BuildError;
use trirrr_core::model::{Model, OfKind};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Cubics, CurveKind, Ends, Pose, Segment};
use trirrr_protocol::message::{AnyMove, Move, Violation};

/// Judges one move at a time. The parameters are those of the tick that will play the moves.
pub struct Admission<M: Model<N: Enclose>, K: CurveKind = Cubics> {
    path: Path<M>,
    judgement: Judgement<M::N, K>,
}

/// The judgement of a move, without the coefficients, which may be constants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judgement<N: Enclose, K: CurveKind> {
    work: Work<N, K>,
    /// Rates for which there is room on what is checked.
    paces: MovePaces,
}

/// Work that is under way.
#[derive(Clone, Copy, Debug)]
enum Work<N: Enclose, K: CurveKind> {
    /// Nothing.
    None,
    /// The move itself.
    Check {
        offered: Offer<N, K>,
        segment: Segment<TaylorModel<N>, K>,
        scan: Scan<N::Bound>,
    },
    /// It is refused; the shortest duration that would pass is looked for.
    Search {
        violation: Violation<N>,
        search: Search<N, K>,
    },
    /// It is judged.
    Judged(Verdict<N>),
}

/// State of the judgement of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict<N: Enclose> {
    /// No move was offered.
    Nothing,
    /// Not decided yet: go on with [`Admission::step`].
    Undecided,
    /// It can be played.
    Admitted,
    /// It breaks a limit, or is not proven to keep it.
    Refused(Violation<N>),
}

/// A move under judgement, which can be played in any duration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Offer<N: Enclose, K: CurveKind> {
    ends: Ends<N, K>,
    rest_to_rest: bool,
    ticks: u32,
    period: N::Bound,
}

impl<N: Enclose, K: CurveKind> Offer<N, K> {
    fn new(ends: &Ends<N, K>, ticks: u32, period: N::Bound) -> Self {
        // Bounds of many turns would be as wide as their rounding: where turns are exact, only the rest counts.
        let turns = ends.from.angle;
        let without = |pose: &Pose<N>| Pose {
            angle: N::without_turns(pose.angle, turns),
            ..*pose
        };
        Self {
            ends: Ends {
                from: without(&ends.from),
                to: without(&ends.to),
                ..*ends
            },
            rest_to_rest: ends.is_rest_to_rest(),
            ticks,
            period,
        }
    }

    /// Looks for a jump of the acceleration at the ends of `segment`, the move in any duration: a broken limit, and where. At
    /// the end of a cubic, and at rest, what the move meets has no acceleration. Two quintics have the same.
    fn jump<M: Model<N = N>>(
        &self,
        path: &Path<M>,
        segment: &Segment<TaylorModel<N>, K>,
    ) -> Result<(), (Breach<N::Bound>, N::Bound)> {
        let is_cubic = K::given(&self.ends.accelerations).is_none();
        let ends = [<N::Bound>::ZERO, <N::Bound>::ONE];
        for (at, velocity) in ends.into_iter().zip(&self.ends.velocities) {
            if K::JERK && (is_cubic || *velocity == Vector3::from([N::ZERO; 3])) {
                path.check_jump(segment, at)
                    .map_err(|breach| (breach, at))?;
            }
        }
        Ok(())
    }

    /// The move in `ticks` ticks, as the tick would play it, over intervals of time.
    fn segment(&self, ticks: u32) -> Segment<TaylorModel<N>, K> {
        let pose = |pose: &Pose<N>| Pose {
            position: pose.position.map(TaylorModel::of),
            angle: AngleModel::of(pose.angle),
        };
        let ends = self.ends.convert(pose, TaylorModel::of);
        let period = TaylorModel::near(self.period);
        Segment::of_kind(&ends, self.rest_to_rest, ticks, period)
    }
}

impl<M: Model<N: Enclose>, K: CurveKind> Admission<M, K> {
    /// Builds the coefficients. A hold or a stop takes `ramp`.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused; a limit of jerk where `K` knows none.
    pub fn build<'a>(
        machine: impl Into<OfKind<'a>>,
        limits: Limits<M::N>,
        ramp: Ramp,
        period_s: f64,
    ) -> Result<Self, BuildError> {
        crate::built::allow_jerk::<K>(limits.jerk.map(|jerk| jerk.map(<M::N>::to_f64)))?;
        let limits = limits.map(<M::N>::bound);
        Path::build(machine, limits, ramp, period_s).map(Self::over)
    }

    /// With coefficients that are built.
    pub fn over(path: Path<M>) -> Self {
        Self {
            path,
            judgement: Judgement::new(),
        }
    }

    /// Takes a move to check and drops the one under way.
    ///
    /// Invalid input is refused at once, as a violation of
    /// [`Bounded::Range`](trirrr_protocol::message::Bounded::Range): a value that is not finite, or an angle of so
    /// many turns that its error exceeds 1e-4 rad. The violation names the coordinate. The violation for a
    /// duration of zero ticks names none.
    pub fn offer(&mut self, offered: &Move<M::N>) {
        self.judgement.offer(&self.path, &Offered::cubic(offered));
    }

    /// As [`Admission::offer`], for a move of either kind. Returns false for a quintic if `K` has none.
    pub fn offer_any(&mut self, offered: &AnyMove<M::N>) -> bool {
        let offered = Offered::of(offered);
        if let Some(offered) = &offered {
            self.judgement.offer(&self.path, offered);
        }
        offered.is_some()
    }

    /// Does a bounded amount of work: measures one interval.
    pub fn step(&mut self) -> Verdict<M::N> {
        self.judgement.step(&self.path)
    }

    /// Returns the violation as soon as the move is refused, while the shortest duration may still be looked for.
    pub fn violation(&self) -> Option<Violation<M::N>> {
        self.judgement.violation()
    }

    /// Rates at which the pace may change on the move, once it is admitted.
    pub fn paces(&self) -> MovePaces {
        self.judgement.paces()
    }

    /// Returns the state of the judgement, without any work on it.
    pub fn verdict(&self) -> Verdict<M::N> {
        self.judgement.verdict()
    }
}

impl<N: Enclose, K: CurveKind> Judgement<N, K> {
    pub(crate) const fn new() -> Self {
        Self {
            work: Work::None,
            paces: MovePaces::FULL,
        }
    }

    /// As [`Admission::offer`].
    pub(crate) fn offer<M: Model<N = N>>(&mut self, path: &Path<M>, offered: &Offered<N, K>) {
        let ticks = offered.common.ticks;
        self.judge(Offer::new(&offered.ends(), ticks, path.period));
        if let Work::Check {
            offered, segment, ..
        } = &self.work
            && let Err((breach, at)) = offered.jump(path, segment)
        {
            self.fail(*offered, &breach, at);
        }
    }

    fn judge(&mut self, offered: Offer<N, K>) {
        let ticks = offered.ticks;
        self.paces = MovePaces::FULL;
        self.work = match breach::of_input(&offered.ends, ticks) {
            Some(breach) => Work::Judged(Verdict::Refused(
                breach.violation(<N as Enclose>::Bound::ZERO),
            )),
            None => Work::Check {
                offered,
                segment: offered.segment(ticks),
                scan: Scan::new::<N>(),
            },
        };
    }

    /// As [`Admission::step`].
    pub(crate) fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Verdict<N> {
        match &mut self.work {
            Work::None => return Verdict::Nothing,
            Work::Judged(verdict) => return *verdict,
            Work::Check {
                offered,
                segment,
                scan,
            } => match scan.step(path, segment, Some(&mut self.paces)) {
                Scanned::Undecided => {}
                Scanned::Passed => self.work = Work::Judged(Verdict::Admitted),
                Scanned::Failed { breach, at } => {
                    let offered = *offered;
                    self.fail(offered, &breach, at);
                }
            },
            Work::Search { violation, search } => match search.step(path) {
                Found::NotYet => {}
                Found::Shortest(shortest) => {
                    let violation = Violation {
                        shortest,
                        ..*violation
                    };
                    self.work = Work::Judged(Verdict::Refused(violation));
                }
            },
        }
        self.verdict()
    }

    /// Refuses `offered`, at once or after the search for a duration that would pass.
    fn fail(&mut self, offered: Offer<N, K>, breach: &Breach<N::Bound>, at: N::Bound) {
        let violation = breach.violation(at);
        self.work = if breach.is_of_speed() {
            let search = Search::new(offered, breach.certain);
            Work::Search { violation, search }
        } else {
            Work::Judged(Verdict::Refused(violation))
        };
    }

    /// Rates for which there is room on an admitted move.
    pub(crate) fn paces(&self) -> MovePaces {
        self.paces
    }

    /// As [`Admission::violation`].
    pub(crate) fn violation(&self) -> Option<Violation<N>> {
        match &self.work {
            Work::Search { violation, .. } | Work::Judged(Verdict::Refused(violation)) => {
                Some(*violation)
            }
            _ => None,
        }
    }

    fn verdict(&self) -> Verdict<N> {
        match &self.work {
            Work::None => Verdict::Nothing,
            Work::Judged(verdict) => *verdict,
            Work::Check { .. } | Work::Search { .. } => Verdict::Undecided,
        }
    }
}

#[cfg(test)]
mod tests;
