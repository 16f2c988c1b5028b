//! The loop that drives a method through time: ends, samples, events, budgets, checks.

use crate::dense::Dense;
use crate::dormand_prince::DormandPrince;
use crate::events::Watch;
use crate::failure::{Failure, Unfit};
use crate::method::Method;
use crate::radau::RadauIia;
use crate::rk4::Rk4;
use crate::semi_implicit_euler::SemiImplicitEuler;
use crate::stability;
use crate::stepper::{Change, Stepper};
use crate::system::{Action, System};
use crate::tally::Tally;

/// A state variable that exceeds its scale by this factor has diverged.
const BOUND: f64 = 1e12;
/// Steps allowed, accepted or not, where nothing else is chosen: a minute or so.
const BUDGET: u64 = 50_000_000;
/// So many events within a window are chatter. Not more: events that come ever faster must not pass
/// the resolution of time before they are so many.
const CHATTER: u32 = 32;
/// The window in s; with a longer fixed step, that step: it is then the method that makes them.
const CHATTER_WINDOW_S: f64 = 32e-9;

/// How a stretch of time ended.
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

/// A method with all that it keeps from step to step. Everything is allocated when it is made.
#[derive(Clone, Debug)]
pub struct Integrator<const N: usize> {
    method: Method,
    stepper: Kind<N>,
    clock: Clock<N>,
}

#[derive(Clone, Debug)]
enum Kind<const N: usize> {
    SemiImplicitEuler(SemiImplicitEuler),
    Rk4(Rk4),
    DormandPrince(DormandPrince<N>),
    RadauIia(Box<RadauIia<N>>),
}

/// What the loop keeps, whatever the method.
#[derive(Clone, Debug)]
struct Clock<const N: usize> {
    dense: Dense<N>,
    watch: Watch,
    tally: Tally,
    budget: u64,
    bounds: [f64; N],
    /// Where the first step started: the linearisation there explains a failure.
    origin: Option<(f64, [f64; N])>,
    /// Events in the present window, when it began, and its length in s.
    chatter: (u32, f64, f64),
}

impl<const N: usize> Integrator<N> {
    /// The method, ready for a system.
    pub fn new<S: System<N>>(system: &S, method: Method) -> Result<Self, Unfit> {
        method.check()?;
        let scales = system.scales();
        for (component, &scale) in scales.iter().enumerate() {
            // Infinity is a scale; what is not a number is none.
            if scale.is_nan() || scale <= 0.0 {
                return Err(Unfit::Scale { component, scale });
            }
        }
        let (stepper, interpolant) = match method {
            Method::SemiImplicitEuler { step_s } => (
                Kind::SemiImplicitEuler(SemiImplicitEuler::new(
                    step_s,
                    system.positions(),
                    method.name(),
                )?),
                SemiImplicitEuler::INTERPOLANT,
            ),
            Method::Rk4 { step_s } => (Kind::Rk4(Rk4::new(step_s)), Rk4::INTERPOLANT),
            Method::DormandPrince { tolerance } => (
                Kind::DormandPrince(DormandPrince::new(tolerance, scales)),
                DormandPrince::<N>::INTERPOLANT,
            ),
            Method::RadauIia { tolerance } => (
                Kind::RadauIia(Box::new(RadauIia::new(tolerance, scales))),
                RadauIia::<N>::INTERPOLANT,
            ),
        };
        Ok(Self {
            method,
            stepper,
            clock: Clock {
                dense: Dense::new(interpolant),
                watch: Watch::new(system.events()),
                tally: Tally::default(),
                budget: BUDGET,
                bounds: scales.map(|scale| BOUND * scale),
                origin: None,
                chatter: (
                    0,
                    f64::NEG_INFINITY,
                    CHATTER_WINDOW_S.max(method.step_s().unwrap_or(0.0)),
                ),
            },
        })
    }

    /// Allows this many steps in all, accepted or not.
    pub fn with_budget(mut self, steps: u64) -> Self {
        self.clock.budget = steps;
        self
    }

    /// The method.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// What it cost so far.
    pub fn tally(&self) -> &Tally {
        &self.clock.tally
    }

    /// Says that the inputs of the system have jumped since the last step, its mode and state not.
    pub fn input_changed(&mut self) {
        self.restart(Change::Input);
    }

    /// Says that the mode or the state of the system has jumped since the last step.
    pub fn mode_changed(&mut self) {
        self.restart(Change::Mode);
    }

    fn restart(&mut self, change: Change) {
        self.clock.watch.restart();
        match &mut self.stepper {
            Kind::SemiImplicitEuler(stepper) => Stepper::<N>::restart(stepper, change),
            Kind::Rk4(stepper) => Stepper::<N>::restart(stepper, change),
            Kind::DormandPrince(stepper) => stepper.restart(change),
            Kind::RadauIia(stepper) => stepper.restart(change),
        }
    }

    /// Integrates from the time `start` in s to `end`, from the state `y` and leaving it there the
    /// last one. Events are handled on the way; samples are not (see [`Integrator::run`]).
    /// `observe` sees each step, cut at the event where one occurred.
    ///
    /// It goes on from the last call: where anything but time has changed since, say so by
    /// [`Integrator::input_changed`] or [`Integrator::mode_changed`].
    pub fn advance<S: System<N>>(
        &mut self,
        system: &mut S,
        start: f64,
        y: &mut [f64; N],
        end: f64,
        mut observe: impl FnMut(&S, &Dense<N>),
    ) -> Result<End, Failure<S::Refusal>> {
        if !(start.is_finite() && end.is_finite() && start <= end) {
            return Err(Failure::Unfit(Unfit::Run { start, end }));
        }
        let clock = &mut self.clock;
        clock.origin.get_or_insert((start, *y));
        // Where the method goes on from. The start of the step before stays: it is needed to
        // continue the solution from.
        clock.dense.t1 = start;
        clock.dense.y1 = *y;
        let method = &self.method;
        match &mut self.stepper {
            Kind::SemiImplicitEuler(stepper) => {
                clock.walk(method, stepper, system, y, end, &mut observe)
            }
            Kind::Rk4(stepper) => clock.walk(method, stepper, system, y, end, &mut observe),
            Kind::DormandPrince(stepper) => {
                clock.walk(method, stepper, system, y, end, &mut observe)
            }
            Kind::RadauIia(stepper) => {
                clock.walk(method, stepper.as_mut(), system, y, end, &mut observe)
            }
        }
    }

    /// Integrates a whole run from the time `start` in s to `end`, taking the system's samples at
    /// their instants, the start included, the end not.
    pub fn run<S: System<N>>(
        &mut self,
        system: &mut S,
        start: f64,
        y: &mut [f64; N],
        end: f64,
        mut observe: impl FnMut(&S, &Dense<N>),
    ) -> Result<End, Failure<S::Refusal>> {
        self.check_run(system, start, end).map_err(Failure::Unfit)?;
        let Some(rate_hz) = system.sample_rate() else {
            return self.advance(system, start, y, end, observe);
        };
        let mut tick = (start * rate_hz).round() as u64;
        let mut t = start;
        while t < end {
            let action = system
                .sample(tick, t, y)
                .map_err(|cause| Failure::Refused { t, cause })?;
            match action {
                Action::Continue => {}
                Action::Switch => self.input_changed(),
                Action::Stop => return Ok(End::Stopped { t }),
            }
            tick += 1;
            let next = (tick as f64 / rate_hz).min(end);
            if let stopped @ End::Stopped { .. } = self.advance(system, t, y, next, &mut observe)? {
                return Ok(stopped);
            }
            t = next;
        }
        Ok(End::Reached)
    }

    /// Checks the method against the run before it starts.
    fn check_run<S: System<N>>(&self, system: &S, start: f64, end: f64) -> Result<(), Unfit> {
        let run_s = end - start;
        if !(run_s.is_finite() && run_s > 0.0) {
            return Err(Unfit::Run { start, end });
        }
        let longest = self.method.step_s();
        if let Some(step_s) = longest
            && step_s > run_s
        {
            return Err(Unfit::LongerThanRun { step_s, run_s });
        }
        let Some(rate_hz) = system.sample_rate() else {
            return Ok(());
        };
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Unfit::Rate { rate_hz });
        }
        let period_s = 1.0 / rate_hz;
        let tick = (start * rate_hz).round();
        if tick < 0.0 || (tick / rate_hz - start).abs() > 1e-9 * period_s {
            return Err(Unfit::OffSample { start, rate_hz });
        }
        if let Some(step_s) = longest
            && step_s > period_s * (1.0 + 1e-9)
        {
            return Err(Unfit::LongerThanPeriod { step_s, period_s });
        }
        Ok(())
    }
}

impl<const N: usize> Clock<N> {
    fn walk<S: System<N>, M: Stepper<N>>(
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
                let action = self.occur(stepper, system, at, observe)?;
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

    /// Whether the end of a step is within all bounds.
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
        if !matches!(failure, Failure::Refused { .. } | Failure::Diverged { .. }) {
            return failure;
        }
        let Some((start, origin)) = &self.origin else {
            return failure;
        };
        match stability::Spectrum::of(system, *start, origin) {
            Ok(spectrum) => {
                let limit_s = spectrum.longest_step(method, system.positions());
                if step_s > limit_s {
                    Failure::StepTooLong {
                        t,
                        step_s,
                        limit_s,
                        method: method.name(),
                    }
                } else {
                    failure
                }
            }
            Err(_) => failure,
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
