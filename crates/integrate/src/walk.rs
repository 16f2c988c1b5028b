//! The loop that takes step after step: events, budget, bounds, and what a failure was caused by.

use crate::dense::{Dense, Interpolant};
use crate::events::Watch;
use crate::failure::Failure;
use crate::method::Method;
use crate::stability;
use crate::stepper::{Change, Stepper};
use crate::system::{Action, System};
use crate::tally::Tally;

/// End of a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At its end.
    Reached,
    /// Earlier, at the time `t` in s, because an event or a sample said so.
    Stopped {
        /// Time in s.
        t: f64,
    },
}

/// A state variable that exceeds its scale by this factor has diverged.
const BOUND: f64 = 1e12;
/// So many events within a window are chatter. Not more: events that come ever faster must not pass
/// the resolution of time before they are so many.
const CHATTER: u32 = 32;
/// The window in s; with a longer fixed step, that step: it is then the method that makes them.
const CHATTER_WINDOW_S: f64 = 32e-9;

/// State of the loop, common to all methods.
#[derive(Clone, Debug)]
pub(crate) struct StepLoop<const N: usize> {
    dense: Dense<N>,
    watch: Watch,
    pub(crate) tally: Tally,
    /// Steps allowed, accepted or not.
    pub(crate) budget: u64,
    bounds: [f64; N],
    /// Start of the first step: the linearisation there explains a failure.
    origin: Option<(f64, [f64; N])>,
    /// Events in the present window, when it began, and its length in s.
    chatter: (u32, f64, f64),
}

impl<const N: usize> StepLoop<N> {
    /// For a system with so many events, of these scales.
    pub(crate) fn new(
        interpolant: Interpolant,
        events: usize,
        scales: &[f64; N],
        method: &Method,
        budget: u64,
    ) -> Self {
        let window_s = CHATTER_WINDOW_S.max(method.step_s().unwrap_or(0.0));
        Self {
            dense: Dense::new(interpolant),
            watch: Watch::new(events),
            tally: Tally::default(),
            budget,
            bounds: scales.map(|scale| BOUND * scale),
            origin: None,
            chatter: (0, f64::NEG_INFINITY, window_s),
        }
    }

    /// Forgets what the events were before a jump.
    pub(crate) fn restart(&mut self) {
        self.watch.restart();
    }

    /// Goes on from the state `y` at the time `start`. The start of the step before stays: it is
    /// needed to continue the solution from.
    pub(crate) fn begin(&mut self, start: f64, y: &[f64; N]) {
        self.origin.get_or_insert((start, *y));
        self.dense.t1 = start;
        self.dense.y1 = *y;
    }

    /// Goes to `end`, step by step, and from event to event.
    pub(crate) fn walk<S: System<N>, M: Stepper<N>>(
        &mut self,
        method: &Method,
        stepper: &mut M,
        system: &mut S,
        y: &mut [f64; N],
        end: f64,
        observe: &mut impl FnMut(&S, &Dense<N>),
    ) -> Result<End, Failure<S::Refusal>> {
        let mut watching = self.watch.any(system);
        while self.dense.t1 < end {
            let t = self.dense.t1;
            if self.tally.steps + self.tally.rejected >= self.budget {
                let step_s = t - self.dense.t0;
                return Err(Failure::Budget {
                    t,
                    steps: self.budget,
                    step_s,
                });
            }
            stepper
                .step(system, end, &mut self.dense, &mut self.tally)
                .and_then(|()| self.check())
                .map_err(|failure| self.explain(method, system, failure))?;
            self.tally.steps += 1;
            if watching && let Some(at) = self.watch.first(system, &self.dense) {
                let action = self
                    .occur(stepper, system, at, observe)
                    .map_err(|failure| self.explain(method, system, failure))?;
                *y = self.dense.y1;
                match action {
                    Action::Continue => {}
                    Action::Switch => {
                        stepper.restart(Change::Mode);
                        watching = self.watch.any(system);
                    }
                    Action::Stop => return Ok(End::Stopped { t: self.dense.t1 }),
                }
            } else {
                observe(system, &self.dense);
                *y = self.dense.y1;
            }
        }
        Ok(End::Reached)
    }

    /// Checks that the end of a step is within all bounds.
    fn check<R: Clone + std::fmt::Debug + std::fmt::Display>(&self) -> Result<(), Failure<R>> {
        for (component, (value, bound)) in self.dense.y1.iter().zip(&self.bounds).enumerate() {
            if !value.is_finite() || value.abs() > *bound {
                return Err(Failure::Diverged {
                    t: self.dense.t0,
                    component,
                    value: *value,
                });
            }
        }
        Ok(())
    }

    /// Names a step that is too long as the cause of a failure, where it is.
    #[cold]
    fn explain<S: System<N>>(
        &self,
        method: &Method,
        system: &S,
        failure: Failure<S::Refusal>,
    ) -> Failure<S::Refusal> {
        let (t, Some(step_s)) = (self.dense.t0, method.step_s()) else {
            return failure;
        };
        let unstable = matches!(
            failure,
            Failure::Refused { .. } | Failure::Diverged { .. } | Failure::Chatter { .. }
        );
        let Some(origin) = self.origin.filter(|_| unstable) else {
            return failure;
        };
        // Where the run began, and where it got to. Where the equations have no value, it is they
        // that are out of the ordinary there, and nothing is learnt from them.
        let here = match failure {
            Failure::Refused { .. } => origin,
            _ => (t, self.dense.y0),
        };
        let limits = [origin, here].map(|(t, y)| {
            let spectrum = stability::Spectrum::of(system, t, &y).ok()?;
            Some(spectrum.longest_step(method, system.positions()))
        });
        let limit_s = limits.into_iter().flatten().fold(f64::INFINITY, f64::min);
        if step_s <= limit_s {
            return failure;
        }
        Failure::StepTooLong {
            t,
            step_s,
            limit_s,
            method: method.name(),
        }
    }

    /// Cuts the step at the time `t` of an event and lets the system handle it, with all others
    /// that occur at the same instant.
    #[cold]
    fn occur<S: System<N>, M: Stepper<N>>(
        &mut self,
        stepper: &mut M,
        system: &mut S,
        t: f64,
        observe: &mut impl FnMut(&S, &Dense<N>),
    ) -> Result<Action, Failure<S::Refusal>> {
        // The dense output says when; the state comes from a step of the method itself.
        if t < self.dense.t1 && !stepper.shorten(system, t, &mut self.dense, &mut self.tally) {
            self.dense.y1 = self.dense.at(t);
            self.dense.t1 = t;
        }
        self.check()?;
        observe(system, &self.dense);
        let mut result = Action::Continue;
        for crossing in self.watch.occurred(t) {
            self.tally.events += 1;
            count_chatter(&mut self.chatter, system, crossing.event, t)?;
            let action = system
                .at_event(crossing.event, t, &mut self.dense.y1)
                .map_err(|cause| Failure::Refused { t, cause })?;
            result = match (result, action) {
                (Action::Stop, _) | (_, Action::Stop) => Action::Stop,
                (Action::Switch, _) | (_, Action::Switch) => Action::Switch,
                _ => Action::Continue,
            };
        }
        self.watch.resume(system, (t, &self.dense.y1));
        Ok(result)
    }
}

/// Counts the events that follow one another without progress, and refuses too many.
fn count_chatter<const N: usize, S: System<N>>(
    (count, began, window_s): &mut (u32, f64, f64),
    system: &S,
    event: usize,
    t: f64,
) -> Result<(), Failure<S::Refusal>> {
    if t - *began > *window_s {
        (*count, *began) = (0, t);
    }
    *count += 1;
    if *count < CHATTER {
        return Ok(());
    }
    Err(Failure::Chatter {
        t,
        name: system.event_name(event),
        events: *count,
        within_s: t - *began,
    })
}
