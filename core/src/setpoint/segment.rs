//! One move of a job, of either kind.

use super::{Hermite, RestToRest, Setpoint};
use crate::number::Number;

/// One move of a job. A move that starts and ends at rest does without the general cubic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment<N: Number> {
    /// From rest to rest.
    RestToRest(RestToRest<N>),
    /// With a velocity at one end at least.
    Hermite(Hermite<N>),
}

impl<N: Number> Segment<N> {
    /// The setpoint at `tick`, counted from the start of the move; beyond the end, the end.
    #[inline(always)]
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.at(tick),
            Self::Hermite(segment) => segment.at(tick),
        }
    }

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks.
    #[inline(never)]
    pub fn at_fraction(&self, s: N) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.at_fraction(s),
            Self::Hermite(segment) => segment.at_fraction(s),
        }
    }

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    #[inline(always)]
    pub fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.between(tick, part),
            Self::Hermite(segment) => segment.between(tick, part),
        }
    }

    /// Length of the move in ticks.
    pub fn ticks(&self) -> u32 {
        match self {
            Self::RestToRest(segment) => segment.ticks(),
            Self::Hermite(segment) => segment.ticks(),
        }
    }
}
