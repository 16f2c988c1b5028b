//! Failures of an integration, each with a name.

use std::fmt::{Debug, Display};

/// Reason for which a method does not fit, found before anything is integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// A fixed step is not a positive number.
    #[error("step = {step_s} s: a fixed step must be a positive number")]
    Step {
        /// Step in s.
        step_s: f64,
    },
    /// A tolerance is out of range.
    #[error("tolerance = {tolerance}: must lie from {least} to {most}")]
    Tolerance {
        /// Relative tolerance.
        tolerance: f64,
        /// Below this, rounding errors decide.
        least: f64,
        /// Above this, the estimate of the error means nothing.
        most: f64,
    },
    /// A fixed step is longer than the run.
    #[error("step = {step_s} s is longer than the run of {run_s} s")]
    LongerThanRun {
        /// Step in s.
        step_s: f64,
        /// Length of the run in s.
        run_s: f64,
    },
    /// A fixed step is longer than the time between two samples.
    #[error("step = {step_s} s is longer than the time of {period_s} s between two samples")]
    LongerThanPeriod {
        /// Step in s.
        step_s: f64,
        /// Time between samples in s.
        period_s: f64,
    },
    /// The run has no length, or its ends are no times.
    #[error("a run from {start} s to {end} s")]
    Run {
        /// Start in s.
        start: f64,
        /// End in s.
        end: f64,
    },
    /// The controller's rate is not a positive number.
    #[error("sample rate = {rate_hz} Hz: must be a positive number")]
    Rate {
        /// Rate in Hz.
        rate_hz: f64,
    },
    /// The start of a run is not at one of its sample instants.
    #[error("a run from {start} s does not start at a sample of its {rate_hz} Hz")]
    OffSample {
        /// Start in s.
        start: f64,
        /// Rate in Hz.
        rate_hz: f64,
    },
    /// A scale of the system is not positive.
    #[error("state variable {component} has the scale {scale}: must be positive")]
    Scale {
        /// Index of the state variable.
        component: usize,
        /// The scale that the system gave.
        scale: f64,
    },
    /// The method works on positions and velocities, and the system names none.
    #[error("{method} needs positions and velocities, and the system has none")]
    NoPositions {
        /// The method's name.
        method: &'static str,
    },
}

/// Cause of an integration that ended early. `R` is the system's own refusal.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure<R: Debug + Display> {
    /// The method cannot be used as asked.
    #[error("{0}")]
    Unfit(Unfit),
    /// The equations have no value here, however short the step.
    #[error("{cause} at t = {t:.9} s")]
    Refused {
        /// Time in s.
        t: f64,
        /// Refusal of the system.
        cause: R,
    },
    /// The state left every bound because the step is too long for the method.
    #[error(
        "step of {step_s:.3e} s is too long for {method}: unstable from t = {t:.9} s, \
         stable here below {limit_s:.3e} s"
    )]
    StepTooLong {
        /// Time in s.
        t: f64,
        /// The step taken, in s.
        step_s: f64,
        /// The longest stable step in s, from the linearisation where the run started.
        limit_s: f64,
        /// The method's name.
        method: &'static str,
    },
    /// The state itself grows out of every bound.
    #[error("state variable {component} diverges at t = {t:.9} s (value {value:.3e})")]
    Diverged {
        /// Time in s.
        t: f64,
        /// Index of the state variable.
        component: usize,
        /// Its value when it left the bounds; may be infinite or not a number.
        value: f64,
    },
    /// The error stays above the tolerance at the shortest step that the clock can resolve.
    #[error("step size underflow at t = {t:.9} s: {reason} at a step of {step_s:.3e} s")]
    Underflow {
        /// Time in s.
        t: f64,
        /// The step in s.
        step_s: f64,
        /// Reason of the rejection.
        reason: Reason,
    },
    /// The steps allowed for the run are used up.
    #[error("{steps} steps used up at t = {t:.9} s, by steps of {step_s:.3e} s")]
    Budget {
        /// Time in s.
        t: f64,
        /// Steps allowed.
        steps: u64,
        /// The last step in s.
        step_s: f64,
    },
    /// Events follow one another without any progress in time.
    #[error("{name} chatters at t = {t:.9} s: {events} events within {within_s:.3e} s")]
    Chatter {
        /// Time in s.
        t: f64,
        /// Name of the event.
        name: String,
        /// Events in a row.
        events: u32,
        /// The time they took, in s.
        within_s: f64,
    },
}

/// Reason for which a step was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The estimated error is above the tolerance.
    Error,
    /// The iteration of the implicit equations does not converge.
    Iteration,
    /// The matrix of the implicit equations is singular.
    Singular,
    /// A derivative is infinite or not a number.
    NotFinite,
}

impl Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Reason::Error => "the error stays above the tolerance",
            Reason::Iteration => "the implicit equations do not converge",
            Reason::Singular => "the implicit equations are singular",
            Reason::NotFinite => "the derivative is not a finite number",
        })
    }
}
