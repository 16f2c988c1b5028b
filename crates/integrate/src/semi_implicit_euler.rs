//! Semi-implicit (symplectic) Euler, with a fixed step.

use crate::dense::{Dense, Interpolant};
use crate::failure::{Failure, Unfit};
use crate::stepper::{Change, Stepper, shorten_by, step_by};
use crate::system::System;
use crate::tally::Tally;

/// Everything but the positions goes one step along the derivative at its start; the positions
/// then go along the velocities at its end.
#[derive(Clone, Debug)]
pub(crate) struct SemiImplicitEuler {
    step_s: f64,
    positions: Vec<(usize, usize)>,
}

impl SemiImplicitEuler {
    pub(crate) const INTERPOLANT: Interpolant = Interpolant::Linear;

    pub(crate) fn new(
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
        step_by(self.step_s, end, dense, tally, |h, dense, tally| {
            tally.derivatives += 1;
            self.advance(system, h, dense)
        })
    }

    fn shorten<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> bool {
        tally.derivatives += 1;
        shorten_by(end, dense, |h, dense| self.advance(system, h, dense))
    }
}
