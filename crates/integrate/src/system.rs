//! Systems to integrate: ordinary differential equations y' = f(t, y) with events and, where a
//! controller is sampled, with instants at which their inputs change.

use crate::jacobian;
use std::fmt::{Debug, Display};

/// A square matrix by rows: `matrix[row][column]`.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// Ordinary differential equations y' = f(t, y) with `N` state variables.
///
/// Times are in s; each state variable has a unit of its own, and [`System::scales`] says how large
/// it usually is.
///
/// A system may have modes (sticking or sliding, saturated or not). It changes them only in
/// [`System::at_event`] and [`System::sample`]; between two such calls its derivative is smooth, so
/// no method ever steps across a kink.
pub trait System<const N: usize> {
    /// Reason for which the equations have no value at a point.
    type Refusal: Clone + Debug + Display;

    /// Writes y' at the time `t` and the state `y`.
    ///
    /// It may be asked about states that the motion never reaches: a refusal there makes the step
    /// shorter; it ends the run only when no step is short enough.
    fn derivative(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Self::Refusal>;

    /// Usual magnitude of each state variable, positive, in its own unit: a tolerance of 1e-9 asks
    /// for 1e-9 of it, or of the variable's own value where that is larger. `f64::INFINITY` takes a
    /// variable out of the control of errors (an energy that is only recorded, for instance).
    fn scales(&self) -> [f64; N];

    /// Writes the derivatives of y' by y: `jacobian[i][j]` is that of `y'[i]` by `y[j]`.
    ///
    /// By default from [finite differences](jacobian::central) of [`System::derivative`].
    fn jacobian(
        &self,
        t: f64,
        y: &[f64; N],
        jacobian: &mut Matrix<N>,
    ) -> Result<(), Self::Refusal> {
        let derivative = |t, y: &_, dy: &mut _| self.derivative(t, y, dy);
        jacobian::central(derivative, &self.scales(), t, y, jacobian)
    }

    /// Pairs (position, velocity) of state variables with `y'[position] = y[velocity]` exactly.
    /// Semi-implicit Euler needs them; without any it is refused.
    fn positions(&self) -> &[(usize, usize)] {
        &[]
    }

    /// Number of event functions.
    fn events(&self) -> usize {
        0
    }

    /// Name of the event function in messages, as in "motor 2 saturated".
    fn event_name(&self, event: usize) -> String {
        format!("event {event}")
    }

    /// Zero crossings of an event function that count in the present mode; `None` where it is not
    /// watched. An event function keeps its meaning in all modes, only this changes.
    fn direction(&self, event: usize) -> Option<Direction> {
        let _ = event;
        None
    }

    /// Writes the value of every event function; those that are not watched may be left alone.
    fn event_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        let _ = (t, y, values);
    }

    /// At the zero crossing of an event function: may change the mode and, by a jump, the state.
    fn at_event(
        &mut self,
        event: usize,
        t: f64,
        y: &mut [f64; N],
    ) -> Result<Action, Self::Refusal> {
        let _ = (event, t, y);
        Ok(Action::Continue)
    }

    /// Rate of the sampled controller in Hz; `None` where everything is continuous in time.
    /// Sample k is at the time k/rate exactly as rounded, never by adding up periods.
    fn sample_rate(&self) -> Option<f64> {
        None
    }

    /// At sample instant `tick`: takes the sample and holds what comes of it until the next.
    fn sample(&mut self, tick: u64, t: f64, y: &mut [f64; N]) -> Result<Action, Self::Refusal> {
        let _ = (tick, t, y);
        Ok(Action::Switch)
    }
}

/// Direction in which an event function passes through zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From below zero.
    Rising,
    /// From above zero.
    Falling,
    /// From either side.
    Either,
}

impl Direction {
    /// Returns `true` if a change from `before` to `after` counts.
    pub(crate) fn crossed(self, before: f64, after: f64) -> bool {
        let rises = before < 0.0 && after >= 0.0;
        let falls = before > 0.0 && after <= 0.0;
        match self {
            Direction::Rising => rises,
            Direction::Falling => falls,
            Direction::Either => rises || falls,
        }
    }
}

/// Continuation after an event or a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// As if nothing had happened: neither mode nor state has changed.
    Continue,
    /// Afresh from here: the mode or the state has changed.
    Switch,
    /// Not at all: the run ends here.
    Stop,
}
