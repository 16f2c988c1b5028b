//! A method at work on a system: whole runs with their samples, and stretches between.

use crate::dense::Dense;
use crate::dormand_prince::DormandPrince;
use crate::failure::{Failure, Unfit};
use crate::method::Method;
use crate::radau::RadauIia;
use crate::rk4::Rk4;
use crate::semi_implicit_euler::SemiImplicitEuler;
use crate::stepper::{Change, Stepper};
use crate::system::{Action, System};
use crate::tally::Tally;
use crate::walk::{End, StepLoop};

/// Steps allowed, accepted or not, where nothing else is chosen: a minute or so.
const BUDGET: u64 = 50_000_000;

/// A method with all that it keeps from step to step. Everything is allocated when it is made.
#[derive(Clone, Debug)]
pub struct Integrator<const N: usize> {
    method: Method,
    stepper: AnyStepper<N>,
    clock: StepLoop<N>,
}

#[derive(Clone, Debug)]
enum AnyStepper<const N: usize> {
    SemiImplicitEuler(SemiImplicitEuler),
    Rk4(Rk4),
    DormandPrince(DormandPrince<N>),
    RadauIia(Box<RadauIia<N>>),
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
                AnyStepper::SemiImplicitEuler(SemiImplicitEuler::new(
                    step_s,
                    system.positions(),
                    method.name(),
                )?),
                SemiImplicitEuler::INTERPOLANT,
            ),
            Method::Rk4 { step_s } => (AnyStepper::Rk4(Rk4::new(step_s)), Rk4::INTERPOLANT),
            Method::DormandPrince { tolerance } => (
                AnyStepper::DormandPrince(DormandPrince::new(tolerance, scales)),
                DormandPrince::<N>::INTERPOLANT,
            ),
            Method::RadauIia { tolerance } => (
                AnyStepper::RadauIia(Box::new(RadauIia::new(tolerance, scales))),
                RadauIia::<N>::INTERPOLANT,
            ),
        };
        Ok(Self {
            method,
            stepper,
            clock: StepLoop::new(interpolant, system.events(), &scales, &method, BUDGET),
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

    /// Cost up to now.
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
        self.clock.restart();
        match &mut self.stepper {
            AnyStepper::SemiImplicitEuler(stepper) => Stepper::<N>::restart(stepper, change),
            AnyStepper::Rk4(stepper) => Stepper::<N>::restart(stepper, change),
            AnyStepper::DormandPrince(stepper) => stepper.restart(change),
            AnyStepper::RadauIia(stepper) => stepper.restart(change),
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
        clock.begin(start, y);
        let method = &self.method;
        match &mut self.stepper {
            AnyStepper::SemiImplicitEuler(stepper) => {
                clock.walk(method, stepper, system, y, end, &mut observe)
            }
            AnyStepper::Rk4(stepper) => clock.walk(method, stepper, system, y, end, &mut observe),
            AnyStepper::DormandPrince(stepper) => {
                clock.walk(method, stepper, system, y, end, &mut observe)
            }
            AnyStepper::RadauIia(stepper) => {
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
