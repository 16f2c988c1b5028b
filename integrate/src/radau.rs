//! Radau IIA of order 5: implicit, three stages, L-stable, stiffly accurate. After Hairer and
//! Wanner, *Solving Ordinary Differential Equations II*, IV.8, and their RADAU5.

use crate::control::{first_step, fit, norm};
use crate::dense::{Dense, Interpolant};
use crate::failure::{Failure, Reason};
use crate::linear::Factors;
use crate::stepper::{Change, Stepper, shortest_step};
use crate::system::{Matrix, System};
use crate::tally::Tally;
use nalgebra::Complex;

/// sqrt(6)
const SQRT_6: f64 = 2.449_489_742_783_178;
/// Instants of the stages within a step.
pub(crate) const NODES: [f64; 3] = [(4.0 - SQRT_6) / 10.0, (4.0 + SQRT_6) / 10.0, 1.0];
/// Weights of the stages in the estimate of the error.
const ESTIMATE: [f64; 3] = [
    -(13.0 + 7.0 * SQRT_6) / 3.0,
    (-13.0 + 7.0 * SQRT_6) / 3.0,
    -1.0 / 3.0,
];
/// Eigenvalues of the inverse of the method's matrix: one real, and a pair of complex ones.
const REAL: f64 = 3.637_834_252_744_496;
const COMPLEX: Complex<f64> = Complex::new(2.681_082_873_627_752, 3.050_430_199_247_411);
/// Eigenvectors of the inverse of the method's matrix, which split its equations.
const JOIN: Matrix<3> = [
    [
        0.091_232_394_870_892_94,
        -0.141_255_295_020_954_2,
        -0.030_029_194_105_147_424,
    ],
    [
        0.241_717_932_707_107,
        0.204_129_352_293_799_93,
        0.382_942_112_757_261_9,
    ],
    [0.966_048_182_615_093, 1.0, 0.0],
];
/// The inverse of [`JOIN`].
const SPLIT: Matrix<3> = [
    [
        4.325_579_890_063_155,
        0.339_199_251_815_809_87,
        0.541_770_539_935_874_9,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_44,
    ],
    [
        -0.502_872_634_945_786_9,
        2.571_926_949_855_605,
        -0.596_039_204_828_224_9,
    ],
];

/// Iterations allowed for the implicit equations.
const ITERATIONS: u32 = 10;
const SAFETY: f64 = 0.9;
/// The step changes at most by these factors at once.
const SHRINK: f64 = 0.125;
const GROW: f64 = 8.0;
/// A step that could grow by up to this factor stays, and the factored matrices with it.
const STAY: f64 = 1.2;
/// Convergence by this factor each iteration is worth a new Jacobian before the next step.
const SLOW: f64 = 1e-3;

/// The method with all that it keeps from step to step.
#[derive(Clone, Debug)]
pub(crate) struct RadauIia<const N: usize> {
    /// What the estimate of the error, of order 3, is compared with.
    tolerance: f64,
    scales: [f64; N],
    /// What remains of the iteration's error, relative to the tolerance.
    iteration_tolerance: f64,
    proposed: f64,
    /// Step and error of the last accepted step; `None` where it says nothing about the next.
    last: Option<(f64, f64)>,
    /// Whether the stages of the last step can be continued into the next.
    continues: bool,
    jacobian: Matrix<N>,
    jacobian_known: bool,
    /// Whether the Jacobian was evaluated where the step starts.
    jacobian_fresh: bool,
    factors: Option<(f64, Factors<f64, N>, Factors<Complex<f64>, N>)>,
    convergence: f64,
}

/// How the iteration for the implicit equations ended.
enum Iterated<R> {
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

impl<const N: usize> RadauIia<N> {
    pub(crate) const INTERPOLANT: Interpolant = Interpolant::RadauIia;

    pub(crate) fn new(tolerance: f64, scales: [f64; N]) -> Self {
        // The estimate is of order 3 and the result of order 5: an estimate of the power 2/3 of
        // the error is what is wanted (RADAU5 does the same).
        let tolerance = 0.1 * tolerance.powf(2.0 / 3.0);
        Self {
            tolerance,
            scales,
            iteration_tolerance: (10.0 * f64::EPSILON / tolerance).max(tolerance.sqrt().min(0.03)),
            proposed: 0.0,
            last: None,
            continues: false,
            jacobian: [[0.0; N]; N],
            jacobian_known: false,
            jacobian_fresh: false,
            factors: None,
            convergence: 1.0,
        }
    }

    /// Factors both matrices for the step `h`, unless those at hand are for it.
    fn factor(&mut self, h: f64, tally: &mut Tally) -> bool {
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
            let size = norm(part, y, y, &self.scales, self.tolerance);
            if size > largest || size.is_nan() {
                size
            } else {
                largest
            }
        })
    }

    /// Solves the implicit equations of a step `h` from `y` at `t` for the stages (less `y`),
    /// starting from those in `stages`, by simplified Newton iteration.
    fn iterate<S: System<N>>(
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
            for ((slope, stage), node) in slopes.iter_mut().zip(&*stages).zip(NODES) {
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

    /// Estimated error of a step `h` with these stages, relative to what is tolerated.
    fn error<S: System<N>>(
        &self,
        system: &S,
        (dense, h): (&Dense<N>, f64),
        (slope, stages): (&[f64; N], &[[f64; N]; 3]),
        again: bool,
        tally: &mut Tally,
    ) -> f64 {
        let Some((_, real, _)) = &self.factors else {
            return f64::INFINITY;
        };
        let bend: [f64; N] = std::array::from_fn(|i| {
            (ESTIMATE[0] * stages[0][i] + ESTIMATE[1] * stages[1][i] + ESTIMATE[2] * stages[2][i])
                / h
        });
        let size =
            |error: &[f64; N]| norm(error, &dense.y0, &dense.y1, &self.scales, self.tolerance);
        let mut error = real.solve(&std::array::from_fn(|i| bend[i] + slope[i]));
        if size(&error) >= 1.0 && again {
            // Filtered once more: the first estimate does not vanish for very stiff equations.
            let at: [f64; N] = std::array::from_fn(|i| dense.y0[i] + error[i]);
            let mut slope = [0.0; N];
            tally.derivatives += 1;
            if system.derivative(dense.t0, &at, &mut slope).is_ok() {
                error = real.solve(&std::array::from_fn(|i| bend[i] + slope[i]));
            }
        }
        size(&error)
    }
}

/// The parts combined by the rows of a matrix.
fn combine<const N: usize>(matrix: &Matrix<3>, parts: &[[f64; N]; 3]) -> [[f64; N]; 3] {
    matrix.map(|[a, b, c]| {
        std::array::from_fn(|i| a * parts[0][i] + b * parts[1][i] + c * parts[2][i])
    })
}

/// Leaves the stages of a step as the terms of its dense output, and its end.
fn finish<const N: usize>(dense: &mut Dense<N>, stages: &[[f64; N]; 3]) {
    dense.terms[..3].copy_from_slice(stages);
    dense.y1 = std::array::from_fn(|i| dense.y0[i] + stages[2][i]);
}

impl<const N: usize> Stepper<N> for RadauIia<N> {
    fn restart(&mut self, change: Change) {
        self.continues = false;
        self.last = None;
        self.jacobian_fresh = false;
        if change == Change::Mode {
            self.jacobian_known = false;
            self.proposed = 0.0;
        }
    }

    fn step<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> Result<(), Failure<S::Refusal>> {
        let before = self.continues.then(|| dense.clone());
        let t = dense.t1;
        dense.t0 = t;
        dense.y0 = dense.y1;
        let y = dense.y0;
        let refused = |cause| Failure::Refused { t, cause };
        let mut slope = [0.0; N];
        tally.derivatives += 1;
        system.derivative(t, &y, &mut slope).map_err(refused)?;
        if self.proposed == 0.0 {
            tally.derivatives += 1;
            let control = (self.tolerance, 3.0);
            self.proposed = first_step(system, (t, &y, &slope), end, &self.scales, control);
        }
        let shortest = shortest_step(t, end);
        let mut rejected = false;
        loop {
            let (h, last) = fit(self.proposed, t, end);
            if !self.jacobian_known {
                tally.jacobians += 1;
                system
                    .jacobian(t, &y, &mut self.jacobian)
                    .map_err(refused)?;
                self.jacobian_known = true;
                self.jacobian_fresh = true;
                self.factors = None;
            }
            let mut stages = match &before {
                Some(before) if !rejected => NODES.map(|node| {
                    let ahead = before.at(t + node * h);
                    std::array::from_fn(|i| ahead[i] - y[i])
                }),
                _ => [[0.0; N]; 3],
            };
            let iterated = if self.factor(h, tally) {
                self.iterate(system, (t, h), &y, &mut stages, tally)
            } else {
                Iterated::Failed {
                    factor: 0.5,
                    reason: Reason::Singular,
                }
            };
            let (factor, reason, refusal) = match iterated {
                Iterated::Converged { iterations } => {
                    finish(dense, &stages);
                    let again = rejected || self.last.is_none();
                    let error = self.error(system, (dense, h), (&slope, &stages), again, tally);
                    // The slower the iteration, the more careful the step.
                    let most = f64::from(1 + 2 * ITERATIONS);
                    let care = SAFETY * most / (f64::from(iterations) + f64::from(2 * ITERATIONS));
                    let care = care.min(SAFETY);
                    if error <= 1.0 {
                        self.accept(h, error, care, rejected, last);
                        dense.t1 = if last { end } else { t + h };
                        return Ok(());
                    }
                    let finite = error.is_finite();
                    let factor = if finite {
                        (care * error.powf(-0.25)).max(SHRINK)
                    } else {
                        SHRINK
                    };
                    let reason = if finite {
                        Reason::Error
                    } else {
                        Reason::NotFinite
                    };
                    (factor, reason, None)
                }
                Iterated::Failed { factor, reason } => (factor, reason, None),
                Iterated::Refused(cause) => (0.25, Reason::NotFinite, Some(cause)),
            };
            tally.rejected += 1;
            rejected = true;
            if !self.jacobian_fresh {
                // Perhaps it is only the Jacobian that is old.
                self.jacobian_known = false;
            }
            if h * factor < shortest {
                return Err(match refusal {
                    Some(cause) => refused(cause),
                    None => Failure::Underflow {
                        t,
                        step_s: h,
                        reason,
                    },
                });
            }
            self.proposed = h * factor;
        }
    }

    fn shorten<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> bool {
        let h = end - dense.t0;
        let mut stages = NODES.map(|node| {
            let ahead = dense.at(dense.t0 + node * h);
            std::array::from_fn(|i| ahead[i] - dense.y0[i])
        });
        if !self.factor(h, tally) {
            return false;
        }
        let y = dense.y0;
        match self.iterate(system, (dense.t0, h), &y, &mut stages, tally) {
            Iterated::Converged { .. } => {
                finish(dense, &stages);
                dense.t1 = end;
                true
            }
            Iterated::Failed { .. } | Iterated::Refused(_) => false,
        }
    }
}

impl<const N: usize> RadauIia<N> {
    /// Chooses the next step after one that is accepted.
    fn accept(&mut self, h: f64, error: f64, care: f64, rejected: bool, last: bool) {
        let error = error.max(1e-10);
        let mut factor = care * error.powf(-0.25);
        if let Some((last_h, last_error)) = self.last {
            // Gustafsson's prediction from the last two steps.
            let predicted = SAFETY * (h / last_h) * (last_error / (error * error)).powf(0.25);
            factor = factor.min(predicted);
        }
        let most = if rejected { 1.0 } else { GROW };
        factor = factor.clamp(SHRINK, most);
        self.last = Some((h, error.max(1e-2)));
        let stays = (1.0..=STAY).contains(&factor) && self.convergence <= SLOW;
        let next = if stays { h } else { h * factor };
        // A step cut short at the end says nothing against the one that was proposed.
        self.proposed = if last {
            next.max(self.proposed.min(h * GROW))
        } else {
            next
        };
        if self.convergence > SLOW {
            self.jacobian_known = false;
        }
        self.jacobian_fresh = false;
        self.continues = true;
    }
}
