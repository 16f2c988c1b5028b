//! Semi-implicit (symplectic) Euler, with a fixed step.

use super::dense::{Dense, Interpolant};
use super::failure::{Failure, Unfit};
use super::stepper::{Change, Stepper, fixed_step};
use super::system::System;
use super::tally::Tally;

/// Everything but the positions goes one step along the derivative at its start; the positions
/// then go along the velocities at its end.
#[derive(Clone, Debug)]
pub(super) struct SemiImplicitEuler {
    step_s: f64,
    positions: Vec<(usize, usize)>,
}

impl SemiImplicitEuler {
    pub(super) const INTERPOLANT: Interpolant = Interpolant::Linear;

    pub(super) fn new(
        step_s: f64,
        positions: &[(usize, usize)],
        method: &'static str,
    ) -> Result<Self, Unfit> {
        if positions.is_empty() {
            return Err(Unfit::NoPositions { method });
        }
        Ok(Self {
            step_s,
            positions: positions.to_vec(),
        })
    }

    /// One step of length `h` from the start of `dense`, to its end.
    #[inline]
    fn advance<const N: usize, S: System<N>>(
        &self,
        system: &S,
        h: f64,
        dense: &mut Dense<N>,
    ) -> Result<(), S::Refusal> {
        let (y, slope) = (&dense.y0, &mut dense.terms[0]);
        system.derivative(dense.t0, y, slope)?;
        for i in 0..N {
            dense.y1[i] = y[i] + h * slope[i];
        }
        for &(position, velocity) in &self.positions {
            dense.y1[position] = y[position] + h * dense.y1[velocity];
        }
        Ok(())
    }
}

impl<const N: usize> Stepper<N> for SemiImplicitEuler {
    fn restart(&mut self, _: Change) {}

    fn step<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> Result<(), Failure<S::Refusal>> {
        dense.t0 = dense.t1;
        dense.y0 = dense.y1;
        let (h, last) = fixed_step(self.step_s, dense.t0, end);
        tally.derivatives += 1;
        self.advance(system, h, dense)
            .map_err(|cause| Failure::Refused { t: dense.t0, cause })?;
        dense.t1 = if last { end } else { dense.t0 + h };
        Ok(())
    }

    fn shorten<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> bool {
        let whole = dense.clone();
        tally.derivatives += 1;
        if self.advance(system, end - dense.t0, dense).is_err() {
            *dense = whole;
            return false;
        }
        dense.t1 = end;
        true
    }
}
