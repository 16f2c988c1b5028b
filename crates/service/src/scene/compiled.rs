//! A scene that cannot change.

use super::{Changed, Machine};
use crate::admission::Enclose;
use crate::built::Coefficients;
use crate::curves::PlayedCurves;
use crate::number::ServiceNumber;
use crate::planner::PathPlanner;
use crate::settings::Settings;
use core::marker::PhantomData;
use trirrr_core::machine::BuildError;
use trirrr_core::model::Model;
use trirrr_core::setpoint::Cubics;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{Refusal, Written};

/// Scene that cannot change. A host may have built the coefficients; the service passes the
/// description on as it is.
#[derive(Clone, Copy, Debug)]
pub struct Compiled<'a, M: Model<N: Enclose>, K = Cubics, P = ()> {
    /// Coefficients of the service, in the units of the machine.
    pub coefficients: &'a Coefficients<M>,
    /// Description.
    pub parts: Parts<'a>,
    /// Kinds of moves that the machine plays, and its planner of paths.
    pub types: PhantomData<(K, P)>,
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

impl<'a, N, M, K, P> Machine for Compiled<'a, M, K, P>
where
    N: ServiceNumber,
    M: Model<N = N>,
    K: PlayedCurves,
    P: PathPlanner<N>,
{
    type N = N;
    type Model = M;
    type Curves = K;
    type Planner = P;
    type Changes = ();
    type Part = Written<'a>;
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

    // Inlined: the compiler then sees that the code for a changed scene is unreachable.
    #[inline(always)]
    fn changed(&self, _: &Section, _: &Units) -> Result<Changed, Refusal<N>> {
        Err(Refusal::NotAdjustable)
    }

    fn adopt(&mut self, _: &Changed, _: Coefficients<M>, _: &mut &'a Coefficients<M>) {}
}
