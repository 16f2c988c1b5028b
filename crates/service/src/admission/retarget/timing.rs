//! The least duration of a candidate that keeps the limits at samples.

use super::super::breach::Breach;
use super::super::path::Path;
use super::super::taylor::{Float, TaylorModel};
use super::super::{Offer, shortest};
use super::chain::{Candidate, Problem, Shape};
use super::profile::{Brake, Transfer};
use crate::admission::Enclose;
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_protocol::message::Bounded;

/// Samples of a single quintic.
const SAMPLES: u32 = 16;

/// Samples of each move of a chain, and of a chain to rest: that one is to keep the limits everywhere.
const EACH: [u32; 2] = [2, 8];

/// Most doublings of the number of samples.
const DOUBLINGS: u32 = 5;

/// Durations that are tried, times 2^[`Timing::step`].
const TRIALS: u32 = 24;

/// Of these, the most that fail by where the motion leads, likewise.
const DETOURS: u32 = 3;

/// Longest motion, in ticks.
pub(super) const LONGEST: u32 = 1 << 24;

/// A search under way. Each sample that fails lengthens the motion by about as much as that sample asks, so the duration
/// found is the least or little above; it is found once all samples in a row have passed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    pub(super) candidate: Candidate,
    doublings: u32,
    /// Of a motion to rest: the duration grows by one such power of 2 at most.
    step: u32,
    sample: u32,
    passed: u32,
    trials: u32,
    detours: u32,
    /// End in whose motion to rest the last limit was broken, of a motion of which only the rest takes longer.
    pub(super) stuck: Option<usize>,
    /// The last limit that made the motion longer.
    pub(super) acting: Option<Bounded>,
}

/// Progress of a search.
pub(super) enum Timed<N: Enclose> {
    NotYet,
    Found(u32),
    /// No duration keeps this limit; none where a shorter motion is known.
    Nothing(Option<Breach<Float<N>>>),
}

impl Timing {
    pub(super) fn new(shape: Shape) -> Self {
        let ticks = match shape {
            Shape::Direct => 1,
            Shape::Brake(..) => Brake::<f32>::SHORTEST,
            Shape::Joined(_) | Shape::Apart(_) => Transfer::SHORTEST,
        };
        Self::from(Candidate {
            shape,
            ticks,
            slack: 0,
        })
    }

    /// From a candidate on whose proof has failed as often as its slack says: with more samples.
    pub(super) fn from(candidate: Candidate) -> Self {
        Self {
            candidate,
            doublings: candidate.slack.min(DOUBLINGS),
            step: 2,
            sample: 0,
            passed: 0,
            trials: 0,
            detours: 0,
            stuck: None,
            acting: None,
        }
    }

    /// As it is, for a motion to rest in steps of at most 2^-`step` of the duration.
    pub(super) fn in_steps(self, step: u32) -> Self {
        Self { step, ..self }
    }

    /// Evaluates one sample. Motions of `enough` ticks or more are of no interest.
    pub(super) fn step<N: Enclose, M: Model<N = N>, const JERK: bool>(
        &mut self,
        path: &Path<M>,
        problem: &Problem<N>,
        side: Option<bool>,
        enough: u32,
    ) -> Timed<N> {
        if problem
            .duration(self.candidate)
            .is_none_or(|ticks| ticks >= enough)
        {
            return Timed::Nothing(None);
        }
        let Some(chain) = problem.chain(self.candidate) else {
            // Its ends have to come to rest within it.
            self.candidate.ticks = slower(self.candidate.ticks, 8);
            return Timed::NotYet;
        };
        if chain.len() > problem.most {
            return Timed::Nothing(None);
        }
        let each = match self.candidate.shape {
            Shape::Direct => SAMPLES,
            Shape::Joined(_) | Shape::Apart(_) => EACH[0],
            Shape::Brake(..) => EACH[1],
        };
        let each = each << self.doublings;
        let samples = each * chain.len() as u32;
        let sample = self.sample % samples;
        let (piece, numerator, denominator) = (sample / each, sample % each + 1, each);
        let (ends, ticks) = chain.piece::<JERK>(piece as usize);
        let segment = Offer::new(&ends, ticks, path.period).segment(ticks);
        let at = TaylorModel::point(<Float<N>>::ratio(numerator, denominator));
        let Err(breach) = path.check(&segment, at, &mut { side }, &mut { path.least }) else {
            self.passed += 1;
            self.sample = sample + 1;
            return match self.passed < samples {
                true => Timed::NotYet,
                false => Timed::Found(self.candidate.ticks),
            };
        };
        self.trials += 1;
        self.passed = 0;
        let leads_astray = !breach.is_of_speed() && breach.what != Bounded::Range;
        self.detours += u32::from(leads_astray);
        // From rest to rest the way is the same at any duration; before and behind it, the motion is.
        let is_apart = matches!(self.candidate.shape, Shape::Apart(_));
        self.stuck = problem
            .resting(self.candidate, &chain, piece as usize)
            .filter(|_| is_apart);
        let fixed = self.stuck.is_some() || (is_apart && leads_astray);
        if fixed
            || self.trials > TRIALS << self.step
            || self.detours > DETOURS << self.step
            || self.candidate.ticks > LONGEST
        {
            return Timed::Nothing(Some(breach));
        }
        self.acting = Some(breach.what);
        let ticks = self.candidate.ticks;
        // The more have failed, the longer the steps.
        let least = slower(ticks, 8u32.saturating_sub(self.trials / 8).max(self.step));
        self.candidate.ticks = match self.candidate.shape {
            _ if leads_astray => slower(ticks, self.step.max(3)),
            // A motion to rest may be too fast and, a little longer, too far.
            Shape::Brake(..) => longer(ticks, &breach)
                .min(slower(ticks, self.step))
                .max(least),
            _ => longer(ticks, &breach).max(least),
        };
        Timed::NotYet
    }
}

/// `ticks` and a 2^`halvings`-th more, at least one.
fn slower(ticks: u32, halvings: u32) -> u32 {
    ticks.saturating_add((ticks >> halvings).max(1))
}

/// Ticks at which the limit may be kept: a little less than if all of the value were due to the motion.
fn longer<B: Number>(ticks: u32, breach: &Breach<B>) -> u32 {
    let part = breach.limit.div(breach.value);
    let speed = match breach.what {
        // Beyond all numbers.
        _ if !(part > B::ZERO) => B::HALF,
        Bounded::Rate => part,
        Bounded::Jerk => cube_root(part),
        _ => part.sqrt(),
    };
    let more = shortest::slower(ticks, speed) - ticks;
    ticks + (more - more / 8)
}

/// Cube root of a number between 0 and 1, to a thousandth: x^4 = part x, by steps that divide the error by four.
fn cube_root<B: Number>(part: B) -> B {
    let mut root = part.sqrt();
    for _ in 0..6 {
        root = (part * root).sqrt().sqrt();
    }
    root
}
