//! The classical Runge-Kutta method of order 4, with a fixed step.

use crate::dense::{Dense, Interpolant};
use crate::failure::Failure;
use crate::stepper::{Change, Stepper, shorten_by, step_by};
use crate::system::System;
use crate::tally::Tally;

/// State variables are advanced by four derivatives each step. Stable for h lambda down to -2.785
/// on the real axis and up to 2.828 on the imaginary one.
#[derive(Clone, Debug)]
pub(crate) struct Rk4 {
    step_s: f64,
}

impl Rk4 {
    pub(crate) const INTERPOLANT: Interpolant = Interpolant::Rk4;

    pub(crate) fn new(step_s: f64) -> Self {
        Self { step_s }
    }
}

/// One step of length `h` from the start of `dense`, to its end.
#[inline]
fn advance<const N: usize, S: System<N>>(
    system: &S,
    h: f64,
    dense: &mut Dense<N>,
) -> Result<(), S::Refusal> {
    let (t, y) = (dense.t0, &dense.y0);
    let [k1, k2, k3, k4, ..] = &mut dense.terms;
    let along = |k: &[f64; N], h: f64| -> [f64; N] { std::array::from_fn(|i| y[i] + h * k[i]) };
    system.derivative(t, y, k1)?;
    system.derivative(t + 0.5 * h, &along(k1, 0.5 * h), k2)?;
    system.derivative(t + 0.5 * h, &along(k2, 0.5 * h), k3)?;
    system.derivative(t + h, &along(k3, h), k4)?;
    for i in 0..N {
        dense.y1[i] = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    Ok(())
}

impl<const N: usize> Stepper<N> for Rk4 {
    fn restart(&mut self, _: Change) {}

    fn step<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> Result<(), Failure<S::Refusal>> {
        step_by(self.step_s, end, dense, tally, |h, dense, tally| {
            tally.derivatives += 4;
            advance(system, h, dense)
        })
    }

    fn shorten<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> bool {
        tally.derivatives += 4;
        shorten_by(end, dense, |h, dense| advance(system, h, dense))
    }
}
