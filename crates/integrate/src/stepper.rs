//! Common interface of the methods to the loop that drives them.

use crate::dense::Dense;
use crate::failure::Failure;
use crate::system::System;
use crate::tally::Tally;
use std::fmt::{Debug, Display};

/// Change after which the integration starts afresh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// The inputs: the derivative jumps, the Jacobian hardly.
    Input,
    /// The mode or the state: whatever is known of the solution is void.
    Mode,
}

/// One method. All work arrays are its own: a step allocates nothing.
pub(crate) trait Stepper<const N: usize> {
    /// Forgets what no longer holds.
    fn restart(&mut self, change: Change);

    /// Takes one accepted step from `dense.t1` and `dense.y1`, not beyond `end`, and leaves it in
    /// `dense`. A step that reaches the end ends there to the last bit. Counts rejected steps.
    fn step<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> Result<(), Failure<S::Refusal>>;

    /// Takes the step of `dense` again from its start, to `end` within it, whatever its error.
    /// False where that cannot be done; `dense` is then as it was.
    fn shorten<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> bool;
}

/// One step of fixed length, as [`Stepper::step`] takes it: `advance` goes a given time ahead from the
/// start of `dense`, to its end. Where the equations refuse that, the step is halved.
#[inline]
pub(crate) fn step_by<const N: usize, R: Debug + Display>(
    step_s: f64,
    end: f64,
    dense: &mut Dense<N>,
    tally: &mut Tally,
    mut advance: impl FnMut(f64, &mut Dense<N>, &mut Tally) -> Result<(), R>,
) -> Result<(), Failure<R>> {
    let t = dense.t1;
    dense.t0 = t;
    dense.y0 = dense.y1;
    let (mut h, mut last) = fixed_step(step_s, t, end);
    while let Err(cause) = advance(h, dense, tally) {
        (h, last) = (0.5 * h, false);
        tally.rejected += 1;
        if h < shortest_step(t, end) {
            return Err(Failure::Refused { t, cause });
        }
    }
    dense.t1 = if last { end } else { t + h };
    Ok(())
}

/// [`Stepper::shorten`] where a step is one formula, `advance`, of its length.
#[inline]
pub(crate) fn shorten_by<const N: usize, R>(
    end: f64,
    dense: &mut Dense<N>,
    advance: impl FnOnce(f64, &mut Dense<N>) -> Result<(), R>,
) -> bool {
    let whole = dense.clone();
    if advance(end - dense.t0, dense).is_err() {
        *dense = whole;
        return false;
    }
    dense.t1 = end;
    true
}

/// The shortest step in s that the clock resolves at `t`; at the start of time, a part of the time
/// to `end` that no method has use for.
pub(crate) fn shortest_step(t: f64, end: f64) -> f64 {
    8.0 * f64::EPSILON * t.abs().max(1e-6 * end.abs())
}

/// The length of the next step: `step_s`, but so that equal steps fill the time to `end`.
/// `true` where the step reaches the end.
fn fixed_step(step_s: f64, t: f64, end: f64) -> (f64, bool) {
    // A quotient that is whole but for rounding is whole.
    let steps = ((end - t) / step_s * (1.0 - 1e-9)).ceil().max(1.0);
    ((end - t) / steps, steps == 1.0)
}
