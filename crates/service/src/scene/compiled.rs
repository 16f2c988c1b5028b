//! A scene that cannot change.

use super::{Changed, NoSlot, Scene};
use crate::admission::Enclose;
use crate::coefficients::Coefficients;
use crate::contact::ContactCoefficients;
use crate::digital::DigitalParameters;
use crate::feedback::FeedbackCoefficients;
use crate::homing::{NoHoming, Plan};
use crate::number::ServiceNumber;
use crate::offered::PlayedCurves;
use crate::planner::PathPlanner;
use crate::settings::Settings;
use core::marker::PhantomData;
use trirrr_core::machine::BuildError;
use trirrr_core::model::Model;
use trirrr_core::setpoint::Cubics;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{Content, MoveBatch, Refusal, Unread, UpdateStep, Written};

/// Scene that cannot change. A host may have built the coefficients; the service passes the
/// description on as it is.
#[derive(Clone, Copy, Debug)]
pub struct Compiled<'a, M: Model<N: Enclose>, K = Cubics, P = (), const BATCHES: bool = false> {
    /// Coefficients of the service, in the units of the machine.
    pub coefficients: &'a Coefficients<M>,
    /// Description.
    pub parts: Parts<'a>,
    /// Kinds of moves that the machine plays, and its planner of paths. It takes moves in batches if `BATCHES` is true.
    pub types: PhantomData<(K, P)>,
}

/// Choice of the type as which a batch of moves is read.
#[derive(Clone, Copy, Debug)]
pub struct BatchChoice<const BATCHES: bool>;

/// A [`BatchChoice`] that is made.
pub trait ChosenBatch<N: ServiceNumber> {
    /// Type as which a batch of moves is read.
    type Batch: Content<MoveBatch<N>>;
}

impl<N: ServiceNumber> ChosenBatch<N> for BatchChoice<true> {
    type Batch = MoveBatch<N>;
}

impl<N: ServiceNumber> ChosenBatch<N> for BatchChoice<false> {
    type Batch = Unread<MoveBatch<N>>;
}

/// Parts of a scene in SI units, each a [`Section`](trirrr_protocol::message::scene::Section) as the bytes on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts<'a> {
    /// The legs.
    pub legs: [&'a [u8]; 3],
    /// The platform and its loads.
    pub platform: &'a [u8],
    /// The limits.
    pub limits: &'a [u8],
}

impl<'a, N, M, K, P, const BATCHES: bool> Scene for Compiled<'a, M, K, P, BATCHES>
where
    N: ServiceNumber,
    M: Model<N = N>,
    K: PlayedCurves,
    P: PathPlanner<N>,
    BatchChoice<BATCHES>: ChosenBatch<N>,
{
    type N = N;
    type Model = M;
    type Slot = NoSlot;
    type Replacement = Unread;
    type Batch = <BatchChoice<BATCHES> as ChosenBatch<N>>::Batch;
    type Update = Unread<UpdateStep>;
    type Curves = K;
    type Planner = P;
    type Part = Written<'a>;
    type Levels = ();
    type Homing = NoHoming;
    type Feedback = ();
    type Contact = ();
    type Retreat = crate::retreat::NoRetreat;
    type Interlocks = ();
    type Digital = ();
    type Coefficients = &'a Coefficients<M>;

    #[inline(always)]
    fn coefficients(&self, _: &Settings<N>) -> Result<&'a Coefficients<M>, BuildError> {
        Ok(self.coefficients)
    }

    fn part(&self, name: SectionName, _: &Units) -> Option<Written<'a>> {
        Some(Written(match name {
            SectionName::Leg(index) => self.parts.legs.get(usize::from(index))?,
            SectionName::Platform => self.parts.platform,
            SectionName::Limits => self.parts.limits,
        }))
    }

    #[inline(always)]
    fn levels(&self) -> u16 {
        0
    }

    #[inline(always)]
    fn homing(&self) -> NoHoming {
        NoHoming
    }

    #[inline(always)]
    fn interlocks(&self) {}

    #[inline(always)]
    fn digital(&self) -> DigitalParameters {
        DigitalParameters::default()
    }

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        None
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        None
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        None
    }

    // Inlined: the compiler then sees that the code for a changed scene is unreachable.
    #[inline(always)]
    fn changed(&self, _: &Section, _: &Units) -> Result<Changed, Refusal<N>> {
        Err(Refusal::NotAdjustable)
    }

    fn adopt(&mut self, _: &Changed, _: Coefficients<M>, _: &mut &'a Coefficients<M>) {}
}
