//! The work on a retarget.

use super::super::breach::{self, Breach};
use super::super::taylor::{Float, TaylorModel};
use super::super::{Judgement, Offer, Path, Verdict};
use super::chain::{Candidate, JOINTS, Problem, Shape};
use super::profile::Rest;
use super::timing::{LONGEST, Timed, Timing};
use super::{Blocked, RetargetTask, Retargeted};
use crate::admission::Enclose;
use crate::pace::MovePaces;
use nalgebra::Vector3;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Quintics, Setpoint};
use trirrr_protocol::message::{Bounded, Move, QuinticMove};

/// Shapes in the order in which they are tried. Of each kind the one after is tried only where a limit of rate or jerk acts.
pub(super) const SHAPES: [Shape; 8] = [
    Shape::Direct,
    Shape::Joined(16),
    Shape::Joined(8),
    Shape::Joined(3),
    Shape::Apart(16),
    Shape::Apart(8),
    Shape::Apart(3),
    Shape::Apart(0),
];

/// Parts of [`profile::Rest`] in the order in which they are tried: of those that end, the first is taken.
const PARTS: [u32; 9] = [6, 32, 10, 256, u32::MAX, 4, 3, 2, 0];

/// One such part of the duration is added, so that a motion does not use its limits up: wherever it is interrupted, there
/// is room for the next one to begin.
pub(super) const RESERVE: u32 = 256;

/// Moves below which a motion to rest is one of them.
const FEW: usize = 13;

/// The work on a retarget, without the coefficients, which may be constants.
#[derive(Clone, Copy, Debug)]
pub struct Aim<N: Enclose, const JERK: bool = true> {
    pub(super) problem: Problem<N>,
    pub(super) stage: Stage<N, JERK>,
    /// The sign of det A at the start.
    side: Option<bool>,
    /// Candidates whose duration is found, by shape.
    pub(super) found: [Option<Candidate>; SHAPES.len()],
    /// Shapes that are given up. Others that are not found took longer than one that is.
    pub(super) failed: [bool; SHAPES.len()],
    /// Ways of coming to rest that are taken, by their place among those of [`Stage::Rest`].
    pub(super) tried: [usize; 2],
    /// End that is brought to rest in another way, after the proofs of all candidates have failed.
    pub(super) again: Option<usize>,
    /// The last candidate of the last shape.
    pub(super) last: Candidate,
    /// End at which the last shape failed, if not on the straight way.
    pub(super) stuck: Option<usize>,
    /// Why an end does not come to rest, and why the last shape has no duration.
    pub(super) breaches: [Option<Breach<Float<N>>>; 3],
    /// Rates of each move that is proven.
    paces: [MovePaces; JOINTS],
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Stage<N: Enclose, const JERK: bool> {
    /// Checks both ends by themselves.
    Ends,
    /// Looks for the least duration of a motion to rest from an end, with these [`PARTS`]: with all of them in large
    /// steps first, then in small ones.
    Rest(usize, usize, Timing),
    /// Looks for the least duration of a shape, the first time or after a failed proof.
    Time(usize, Timing, bool),
    /// Proves a candidate, at one of its moves.
    Prove {
        shape: usize,
        piece: usize,
        judgement: Judgement<N, Quintics<JERK>>,
    },
    /// Chooses what to do next.
    Choose,
    Done(Retargeted<N>, Option<Candidate>),
}

impl<N: Enclose, const JERK: bool> Aim<N, JERK> {
    pub(super) fn new<M: Model<N = N>>(path: &Path<M>, task: &RetargetTask<N>) -> Self {
        let RetargetTask {
            start,
            target,
            most,
            least,
        } = *task;
        let is_there = start == target;
        Self {
            problem: Problem {
                ends: [start, target],
                period: path.period,
                stops: [Some(Rest::NONE); 2],
                most,
                least: least.min(LONGEST / 2),
            },
            stage: match is_there {
                true => Stage::Done(Retargeted::Planned(0), None),
                false => Stage::Ends,
            },
            side: None,
            found: [None; SHAPES.len()],
            failed: [false; SHAPES.len()],
            tried: [0; 2],
            again: None,
            last: Timing::new(Shape::Apart(16)).candidate,
            stuck: None,
            breaches: [None; 3],
            paces: [MovePaces::FULL; JOINTS],
        }
    }

    /// Rates at which the pace may change on move `index` of the planned motion.
    pub(super) fn paces(&self, index: usize) -> &MovePaces {
        self.paces.get(index).unwrap_or(&MovePaces::FULL)
    }

    /// As [`Retarget::planned`].
    pub(super) fn planned(&self, index: usize) -> Option<QuinticMove<N>> {
        let Stage::Done(_, candidate) = self.stage else {
            return None;
        };
        let chain = self.problem.chain(candidate?)?;
        if index >= chain.len() {
            return None;
        }
        let (ends, ticks) = chain.piece::<JERK>(index);
        let [start_acceleration, end_acceleration] = ends.accelerations?;
        let [start_velocity, end_velocity] = ends.velocities.map(Into::into);
        let common = Move {
            start_velocity,
            end_velocity,
            ..Move::rest_to_rest(0, ends.from, ends.to, ticks)
        };
        Some(QuinticMove {
            common,
            start_acceleration,
            end_acceleration,
        })
    }

    /// As [`Retarget::step`].
    pub(super) fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Retargeted<N> {
        let longest = self.shortest().map_or(LONGEST, |(_, ticks)| ticks);
        match &mut self.stage {
            Stage::Done(done, _) => return *done,
            Stage::Choose => self.prove_shortest(),
            Stage::Ends => match self.check_ends(path) {
                Ok(()) => self.rest(0, 0),
                Err((blocked, breach)) => self.refuse(blocked, breach),
            },
            Stage::Rest(index, parts, timing) => {
                let (index, parts) = (*index, *parts);
                match timing.step::<_, _, JERK>(path, &self.problem, self.side, LONGEST) {
                    Timed::NotYet => return Retargeted::Undecided,
                    Timed::Found(ticks) => {
                        self.tried[index] = parts;
                        let parts = PARTS[parts % PARTS.len()];
                        self.problem.stops[index] = Some(Rest { ticks, parts });
                        self.rest(index + 1, 0);
                    }
                    // The way that was found before stays what it is: no candidate with it is proven.
                    Timed::Nothing(_) if self.again == Some(index) => {
                        self.tried[index] = parts;
                        self.failed = [true; SHAPES.len()];
                        self.choose();
                    }
                    Timed::Nothing(breach) => {
                        self.problem.stops[index] = None;
                        self.breaches[index] = self.breaches[index].or(breach);
                        self.rest(index, parts + 1);
                    }
                }
            }
            Stage::Time(shape, timing, first) => {
                let (shape, first) = (*shape, *first);
                let enough = if first { longest } else { LONGEST };
                match timing.step::<_, _, JERK>(path, &self.problem, self.side, enough) {
                    Timed::NotYet => return Retargeted::Undecided,
                    Timed::Found(ticks) => {
                        // A motion that may be no shorter leaves room anyway.
                        let least = self.problem.least;
                        let is_least = self.problem.duration(timing.candidate) == Some(least);
                        let ticks = ticks + if is_least { 0 } else { ticks / RESERVE };
                        self.found[shape] = Some(Candidate {
                            ticks,
                            ..timing.candidate
                        });
                    }
                    Timed::Nothing(None) if enough < LONGEST => {}
                    Timed::Nothing(breach) => {
                        self.failed[shape] = true;
                        if let (Shape::Apart(_), Some(_)) = (SHAPES[shape], breach) {
                            self.breaches[2] = breach;
                            self.stuck = timing.stuck;
                            self.last = timing.candidate;
                        }
                    }
                }
                let rate = matches!(timing.acting, Some(Bounded::Rate | Bounded::Jerk));
                match first {
                    true => self.time(shape + 1, rate),
                    false => self.choose(),
                }
            }
            Stage::Prove {
                shape,
                piece,
                judgement,
            } => {
                let verdict = judgement.step(path);
                if judgement.violation().is_some() {
                    let shape = *shape;
                    self.lengthen(shape);
                } else if verdict == Verdict::Admitted {
                    if let Some(paces) = self.paces.get_mut(*piece) {
                        *paces = judgement.paces();
                    }
                    let (shape, piece) = (*shape, *piece + 1);
                    self.prove(shape, piece);
                }
            }
        }
        match &self.stage {
            Stage::Done(done, _) => *done,
            _ => Retargeted::Undecided,
        }
    }

    /// Both ends, each standing still at the other end of a tick: a motion whose jerk says nothing.
    fn check_ends<M: Model<N = N>>(
        &mut self,
        path: &Path<M>,
    ) -> Result<(), (Blocked, Breach<Float<N>>)> {
        for (index, blocked) in [Blocked::Start, Blocked::Target].into_iter().enumerate() {
            let end = self.problem.ends[index];
            let rest = Vector3::from([N::ZERO; 3]);
            let ends = Ends::<N, Quintics<false>> {
                from: end.pose,
                to: end.pose,
                velocities: [end.velocity, rest],
                accelerations: Some([end.acceleration.into(), [N::ZERO; 3]]),
            };
            if let Some(breach) = breach::of_input(&ends, 1) {
                return Err((blocked, breach));
            }
            let segment = Offer::new(&ends, 1, path.period).segment(1);
            let start = TaylorModel::point(<Float<N>>::ZERO);
            path.check(&segment, start, &mut self.side, &mut { path.least })
                .map_err(|breach| (blocked, breach))?;
        }
        Ok(())
    }

    /// Looks for the way to rest of end `index`, or of the next that moves.
    pub(super) fn rest(&mut self, index: usize, parts: usize) {
        let ways = 2 * PARTS.len();
        let fits = |parts: &usize| self.fits(*parts);
        let (index, parts) = match (parts..ways).find(fits) {
            Some(parts) => (index, parts),
            None => (index + 1, (0..ways).find(fits).unwrap_or(0)),
        };
        let zero = [N::ZERO; 3];
        let moves = |end: &Setpoint<N>| {
            <[N; 3]>::from(end.velocity) != zero || <[N; 3]>::from(end.acceleration) != zero
        };
        let concerned = |index: &usize| {
            self.again.is_none_or(|again| again == *index) && moves(&self.problem.ends[*index])
        };
        match (index..2).find(concerned) {
            Some(index) => {
                let shape = Shape::Brake(index, PARTS[parts % PARTS.len()]);
                let timing = Timing::new(shape).in_steps(if parts < PARTS.len() { 2 } else { 5 });
                self.stage = Stage::Rest(index, parts, timing);
            }
            None => self.time(0, true),
        }
    }

    /// Looks for the duration of `shape`, or of the next that there is. `rate`: a limit of rate or jerk acts in the one before.
    fn time(&mut self, shape: usize, rate: bool) {
        let is_next = |shape: &usize| {
            let is_first = matches!(
                SHAPES[*shape],
                Shape::Direct | Shape::Joined(16) | Shape::Apart(16)
            );
            !self.failed[*shape] && self.exists(SHAPES[*shape]) && (is_first || rate)
        };
        match (shape..SHAPES.len()).find(is_next) {
            Some(shape) => self.stage = Stage::Time(shape, self.timing(SHAPES[shape]), true),
            None => self.choose(),
        }
    }

    /// The search for a shape's duration, from the least that is asked for on.
    pub(super) fn timing(&self, shape: Shape) -> Timing {
        let mut timing = Timing::new(shape);
        let ticks = &mut timing.candidate.ticks;
        let rests = match shape {
            Shape::Apart(_) => self
                .problem
                .stops
                .map(|stop| stop.map_or(0, |rest| rest.ticks)),
            _ => [0; 2],
        };
        let least = self
            .problem
            .least
            .saturating_sub(rests[0])
            .saturating_sub(rests[1]);
        *ticks = least.max(*ticks);
        timing
    }

    pub(super) fn exists(&self, shape: Shape) -> bool {
        let moving = self
            .problem
            .stops
            .iter()
            .any(|stop| *stop != Some(Rest::NONE));
        match shape {
            // From rest to rest the two kinds are the same.
            Shape::Joined(_) => moving && self.rests(),
            Shape::Apart(_) => self.rests(),
            Shape::Direct | Shape::Brake(..) => true,
        }
    }

    /// Returns true if both ends come to rest.
    pub(super) fn rests(&self) -> bool {
        self.problem.stops.iter().all(Option::is_some)
    }

    /// Returns true for the ways to rest that make no more moves than asked: with few, a motion to rest is one.
    fn fits(&self, parts: usize) -> bool {
        self.problem.most >= FEW || PARTS[parts % PARTS.len()] == 0
    }

    /// The next way in which an end may come to rest. Those in small steps are for ends that have no other.
    pub(super) fn next_parts(&self, end: usize) -> Option<usize> {
        self.problem.stops[end].filter(|rest| *rest != Rest::NONE)?;
        (self.tried[end] + 1..PARTS.len()).find(|&parts| self.fits(parts))
    }
}
