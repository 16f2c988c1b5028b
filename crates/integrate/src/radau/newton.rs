//! The implicit equations of a step, solved by simplified Newton iteration.

use super::tableau::{COMPLEX, JOIN, REAL, SPLIT};
use crate::control::norm;
use crate::dense::RADAU_NODES;
use crate::failure::Reason;
use crate::linear::Factors;
use crate::system::{Matrix, System};
use crate::tally::Tally;
use nalgebra::Complex;

/// Iterations allowed for the implicit equations.
pub(super) const ITERATIONS: u32 = 10;

/// The iteration with its matrices.
#[derive(Clone, Debug)]
pub(super) struct Newton<const N: usize> {
    /// Tolerance of the error estimate, which is of order 3.
    pub(super) tolerance: f64,
    pub(super) scales: [f64; N],
    /// Remaining error of the iteration, relative to the tolerance.
    iteration_tolerance: f64,
    jacobian: Matrix<N>,
    factors: Option<(f64, Factors<f64, N>, Factors<Complex<f64>, N>)>,
    /// By which factor each iteration shrank the error, in the last step that took two.
    pub(super) convergence: f64,
}

/// End of the iteration for the implicit equations.
pub(super) enum Iterated<R> {
    Converged {
        iterations: u32,
    },
    /// Try again with the step shortened by this factor.
    Failed {
        factor: f64,
        reason: Reason,
    },
    Refused(R),
}

impl<const N: usize> Newton<N> {
    /// For a step of the error `tolerance`.
    pub(super) fn new(tolerance: f64, scales: [f64; N]) -> Self {
        // The estimate is of order 3 and the result of order 5: an estimate of the power 2/3 of
        // the error is what is wanted (RADAU5 does the same).
        let tolerance = 0.1 * tolerance.powf(2.0 / 3.0);
        Self {
            tolerance,
            scales,
            iteration_tolerance: (10.0 * f64::EPSILON / tolerance).max(tolerance.sqrt().min(0.03)),
            jacobian: [[0.0; N]; N],
            factors: None,
            convergence: 1.0,
        }
    }

    /// Place of a new Jacobian; drops the factors of the last.
    pub(super) fn renew(&mut self) -> &mut Matrix<N> {
        self.factors = None;
        &mut self.jacobian
    }

    /// The factors of the real matrix, where it is not singular.
    pub(super) fn real(&self) -> Option<&Factors<f64, N>> {
        self.factors.as_ref().map(|(_, real, _)| real)
    }

    /// Size of an error of a step from `before` to `after`, relative to what is tolerated.
    pub(super) fn norm(&self, error: &[f64; N], before: &[f64; N], after: &[f64; N]) -> f64 {
        norm(error, before, after, &self.scales, self.tolerance)
    }

    /// Factors both matrices for the step `h`, unless those at hand are for it.
    pub(super) fn factor(&mut self, h: f64, tally: &mut Tally) -> bool {
        if let Some((made_for, ..)) = &self.factors
            && (h / made_for - 1.0).abs() < 1e-6
        {
            return true;
        }
        tally.factorisations += 1;
        let real = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let diagonal = if i == j { REAL / h } else { 0.0 };
                diagonal - self.jacobian[i][j]
            })
        });
        let complex = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let diagonal = if i == j {
                    COMPLEX / h
                } else {
                    Complex::new(0.0, 0.0)
                };
                diagonal - Complex::new(self.jacobian[i][j], 0.0)
            })
        });
        self.factors = Factors::of(real)
            .zip(Factors::of(complex))
            .map(|(real, complex)| (h, real, complex));
        self.factors.is_some()
    }

    /// Size of a change of the stages, relative to what is tolerated.
    fn size(&self, change: &[[f64; N]; 3], y: &[f64; N]) -> f64 {
        change.iter().fold(0.0, |largest: f64, part| {
            let size = self.norm(part, y, y);
            if size > largest || size.is_nan() {
                size
            } else {
                largest
            }
        })
    }

    /// Solves the implicit equations of a step `h` from `y` at `t` for the stages (less `y`),
    /// starting from those in `stages`, by simplified Newton iteration.
    pub(super) fn iterate<S: System<N>>(
        &mut self,
        system: &S,
        (t, h): (f64, f64),
        y: &[f64; N],
        stages: &mut [[f64; N]; 3],
        tally: &mut Tally,
    ) -> Iterated<S::Refusal> {
        let Some((_, real, complex)) = &self.factors else {
            return Iterated::Failed {
                factor: 0.5,
                reason: Reason::Singular,
            };
        };
        let mut split: [[f64; N]; 3] = combine(&SPLIT, stages);
        let mut last_size = 0.0;
        let mut last_ratio = 0.0;
        // How much of the change just made is still missing, at most: the rate of convergence in
        // steps before says nothing, the Jacobian may be older than they.
        let mut missing = 1.0;
        for iteration in 1..=ITERATIONS {
            let mut slopes = [[0.0; N]; 3];
            for ((slope, stage), node) in slopes.iter_mut().zip(&*stages).zip(RADAU_NODES) {
                let at: [f64; N] = std::array::from_fn(|i| y[i] + stage[i]);
                tally.derivatives += 1;
                if let Err(refusal) = system.derivative(t + node * h, &at, slope) {
                    return Iterated::Refused(refusal);
                }
            }
            let residual = combine(&SPLIT, &slopes);
            let first: [f64; N] = std::array::from_fn(|i| residual[0][i] - REAL / h * split[0][i]);
            let pair: [Complex<f64>; N] = std::array::from_fn(|i| {
                Complex::new(residual[1][i], residual[2][i])
                    - COMPLEX / h * Complex::new(split[1][i], split[2][i])
            });
            let (first, pair) = (real.solve(&first), complex.solve(&pair));
            let change = [first, pair.map(|z| z.re), pair.map(|z| z.im)];
            for (part, change) in split.iter_mut().zip(&change) {
                for i in 0..N {
                    part[i] += change[i];
                }
            }
            *stages = combine(&JOIN, &split);
            let size = self.size(&change, y);
            if !size.is_finite() {
                return Iterated::Failed {
                    factor: 0.5,
                    reason: Reason::NotFinite,
                };
            }
            if iteration > 1 {
                let ratio = size / last_size;
                self.convergence = if iteration == 2 {
                    ratio
                } else {
                    (ratio * last_ratio).sqrt()
                };
                last_ratio = ratio;
                if self.convergence >= 0.99 {
                    return Iterated::Failed {
                        factor: 0.5,
                        reason: Reason::Iteration,
                    };
                }
                missing = self.convergence / (1.0 - self.convergence);
                let left = f64::from(ITERATIONS - iteration);
                let expected =
                    missing * size * self.convergence.powf(left) / self.iteration_tolerance;
                if expected >= 1.0 {
                    let slow = expected.clamp(1e-4, 20.0);
                    let factor = 0.8 * slow.powf(-1.0 / (4.0 + left));
                    return Iterated::Failed {
                        factor,
                        reason: Reason::Iteration,
                    };
                }
            }
            if size == 0.0 || missing * size <= self.iteration_tolerance {
                return Iterated::Converged {
                    iterations: iteration,
                };
            }
            last_size = size;
        }
        Iterated::Failed {
            factor: 0.5,
            reason: Reason::Iteration,
        }
    }
}

/// The parts combined by the rows of a matrix.
fn combine<const N: usize>(matrix: &Matrix<3>, parts: &[[f64; N]; 3]) -> [[f64; N]; 3] {
    matrix.map(|[a, b, c]| {
        std::array::from_fn(|i| a * parts[0][i] + b * parts[1][i] + c * parts[2][i])
    })
}
