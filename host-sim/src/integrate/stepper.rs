//! What every method is to the loop that drives it.

use super::dense::Dense;
use super::failure::Failure;
use super::system::System;
use super::tally::Tally;

/// What has changed where the integration goes on afresh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// The inputs: the derivative jumps, the Jacobian hardly.
    Input,
    /// The mode or the state: whatever is known of the solution is void.
    Mode,
}

/// One method. All work arrays are its own: a step allocates nothing.
pub(super) trait Stepper<const N: usize> {
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

/// The shortest step in s that the clock resolves at `t`; at the start of time, a part of the time
/// to `end` that no method has use for.
pub(super) fn shortest_step(t: f64, end: f64) -> f64 {
    8.0 * f64::EPSILON * t.abs().max(1e-6 * end.abs())
}

/// The length of the next step: `step_s`, but so that equal steps fill the time to `end`.
/// `true` where the step reaches the end.
pub(super) fn fixed_step(step_s: f64, t: f64, end: f64) -> (f64, bool) {
    // A quotient that is whole but for rounding is whole.
    let steps = ((end - t) / step_s * (1.0 - 1e-9)).ceil().max(1.0);
    ((end - t) / steps, steps == 1.0)
}
