//! Radau IIA of order 5: implicit, three stages, L-stable, stiffly accurate. After Hairer and
//! Wanner, *Solving Ordinary Differential Equations II*, IV.8, and their RADAU5.

mod newton;
mod tableau;

use crate::control::{first_step, fit};
use crate::dense::{Dense, Interpolant, RADAU_NODES};
use crate::failure::{Failure, Reason};
use crate::stepper::{Change, Stepper, shortest_step};
use crate::system::System;
use crate::tally::Tally;
use newton::{ITERATIONS, Iterated, Newton};
use tableau::ESTIMATE;

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
    newton: Newton<N>,
    proposed: f64,
    /// Step that the error allowed for the first step after the last jump of the inputs, in s: the next
    /// jump excites the same transients. Zero where nothing is known.
    opening: f64,
    /// The next step is the first after such a jump.
    opens: bool,
    /// Step and error of the last accepted step; `None` where it says nothing about the next.
    last: Option<(f64, f64)>,
    /// The stages of the last step can be continued into the next.
    continues: bool,
    jacobian_known: bool,
    /// The Jacobian was evaluated at the start of the step.
    jacobian_fresh: bool,
}

impl<const N: usize> RadauIia<N> {
    pub(crate) const INTERPOLANT: Interpolant = Interpolant::RadauIia;

    pub(crate) fn new(tolerance: f64, scales: [f64; N]) -> Self {
        Self {
            newton: Newton::new(tolerance, scales),
            proposed: 0.0,
            opening: 0.0,
            opens: false,
            last: None,
            continues: false,
            jacobian_known: false,
            jacobian_fresh: false,
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
        let Some(real) = self.newton.real() else {
            return f64::INFINITY;
        };
        let bend: [f64; N] = std::array::from_fn(|i| {
            (ESTIMATE[0] * stages[0][i] + ESTIMATE[1] * stages[1][i] + ESTIMATE[2] * stages[2][i])
                / h
        });
        let size = |error: &[f64; N]| self.newton.norm(error, &dense.y0, &dense.y1);
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
        self.opens = change == Change::Input;
        match change {
            Change::Input if self.opening > 0.0 => {
                self.proposed = self.proposed.min(self.opening);
            }
            Change::Input => {}
            Change::Mode => {
                self.jacobian_known = false;
                self.proposed = 0.0;
                self.opening = 0.0;
            }
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
            let control = (self.newton.tolerance, 3.0);
            self.proposed = first_step(system, (t, &y, &slope), end, &self.newton.scales, control);
        }
        let shortest = shortest_step(t, end);
        let mut rejected = false;
        loop {
            let (h, last) = fit(self.proposed, t, end);
            if !self.jacobian_known {
                tally.jacobians += 1;
                system
                    .jacobian(t, &y, self.newton.renew())
                    .map_err(refused)?;
                self.jacobian_known = true;
                self.jacobian_fresh = true;
            }
            let mut stages = match &before {
                Some(before) if !rejected => RADAU_NODES.map(|node| {
                    let ahead = before.at(t + node * h);
                    std::array::from_fn(|i| ahead[i] - y[i])
                }),
                _ => [[0.0; N]; 3],
            };
            let iterated = if self.newton.factor(h, tally) {
                self.newton.iterate(system, (t, h), &y, &mut stages, tally)
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
        let mut stages = RADAU_NODES.map(|node| {
            let ahead = dense.at(dense.t0 + node * h);
            std::array::from_fn(|i| ahead[i] - dense.y0[i])
        });
        if !self.newton.factor(h, tally) {
            return false;
        }
        let y = dense.y0;
        match self
            .newton
            .iterate(system, (dense.t0, h), &y, &mut stages, tally)
        {
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
        if self.opens {
            self.opening = h * factor;
            self.opens = false;
        }
        self.last = Some((h, error.max(1e-2)));
        let stays = (1.0..=STAY).contains(&factor) && self.newton.convergence <= SLOW;
        let next = if stays { h } else { h * factor };
        // A step cut short at the end says nothing against the one that was proposed.
        self.proposed = if last {
            next.max(self.proposed.min(h * GROW))
        } else {
            next
        };
        if self.newton.convergence > SLOW {
            self.jacobian_known = false;
        }
        self.jacobian_fresh = false;
        self.continues = true;
    }
}
