//! The explicit Runge-Kutta pair of orders 5 and 4 by Dormand and Prince (1980), with the step
//! control of Hairer's DOPRI5.

use crate::control::{first_step, fit, norm};
use crate::dense::{Dense, Interpolant};
use crate::failure::{Failure, Reason};
use crate::stepper::{Change, Stepper, shorten_by, shortest_step};
use crate::system::System;
use crate::tally::Tally;

/// The last stage of a step is the first of the next. Stable for h lambda down to about -3.3 on
/// the real axis.
#[derive(Clone, Debug)]
pub(crate) struct DormandPrince<const N: usize> {
    tolerance: f64,
    scales: [f64; N],
    /// Next step that the error allows, s; zero before the first.
    proposed: f64,
    /// Error of the last accepted step.
    last_error: f64,
    /// The derivative at the end of the last step holds at the start of the next.
    slope_known: bool,
}

/// Exponent of the last error in the control of the step: damps the changes of the step where
/// stability limits it.
const BETA: f64 = 0.04;
const SAFETY: f64 = 0.9;
/// The step shrinks at most by this factor at once.
const SHRINK: f64 = 0.2;
/// The step grows at most by this factor at once.
const GROW: f64 = 10.0;

impl<const N: usize> DormandPrince<N> {
    pub(crate) const INTERPOLANT: Interpolant = Interpolant::DormandPrince;

    pub(crate) fn new(tolerance: f64, scales: [f64; N]) -> Self {
        Self {
            tolerance,
            scales,
            proposed: 0.0,
            last_error: 1e-4,
            slope_known: false,
        }
    }
}

/// Stages 2 to 7 of a step of length `h` from the start of `dense` to its end, stage 1 being there.
#[inline]
fn advance<const N: usize, S: System<N>>(
    system: &S,
    h: f64,
    dense: &mut Dense<N>,
) -> Result<(), S::Refusal> {
    let (t, y) = (dense.t0, &dense.y0);
    let [k1, k2, k3, k4, k5, k6, k7] = &mut dense.terms;
    let at: [f64; N] = std::array::from_fn(|i| y[i] + h * (k1[i] * (1.0 / 5.0)));
    system.derivative(t + h / 5.0, &at, k2)?;
    let at: [f64; N] =
        std::array::from_fn(|i| y[i] + h * (k1[i] * (3.0 / 40.0) + k2[i] * (9.0 / 40.0)));
    system.derivative(t + h * 0.3, &at, k3)?;
    let at: [f64; N] = std::array::from_fn(|i| {
        y[i] + h * (k1[i] * (44.0 / 45.0) - k2[i] * (56.0 / 15.0) + k3[i] * (32.0 / 9.0))
    });
    system.derivative(t + h * 0.8, &at, k4)?;
    let at: [f64; N] = std::array::from_fn(|i| {
        y[i] + h
            * (k1[i] * (19372.0 / 6561.0) - k2[i] * (25360.0 / 2187.0) + k3[i] * (64448.0 / 6561.0)
                - k4[i] * (212.0 / 729.0))
    });
    system.derivative(t + h * (8.0 / 9.0), &at, k5)?;
    let at: [f64; N] = std::array::from_fn(|i| {
        y[i] + h
            * (k1[i] * (9017.0 / 3168.0) - k2[i] * (355.0 / 33.0)
                + k3[i] * (46732.0 / 5247.0)
                + k4[i] * (49.0 / 176.0)
                - k5[i] * (5103.0 / 18656.0))
    });
    system.derivative(t + h, &at, k6)?;
    for i in 0..N {
        dense.y1[i] = y[i]
            + h * (k1[i] * (35.0 / 384.0) + k3[i] * (500.0 / 1113.0) + k4[i] * (125.0 / 192.0)
                - k5[i] * (2187.0 / 6784.0)
                + k6[i] * (11.0 / 84.0));
    }
    system.derivative(t + h, &dense.y1, k7)
}

/// Difference of the solutions of orders 5 and 4.
#[inline]
fn difference<const N: usize>(h: f64, dense: &Dense<N>) -> [f64; N] {
    let [k1, _, k3, k4, k5, k6, k7] = &dense.terms;
    std::array::from_fn(|i| {
        h * (k1[i] * (71.0 / 57600.0) - k3[i] * (71.0 / 16695.0) + k4[i] * (71.0 / 1920.0)
            - k5[i] * (17253.0 / 339200.0)
            + k6[i] * (22.0 / 525.0)
            - k7[i] * (1.0 / 40.0))
    })
}

impl<const N: usize> Stepper<N> for DormandPrince<N> {
    fn restart(&mut self, change: Change) {
        self.slope_known = false;
        if change == Change::Mode {
            self.proposed = 0.0;
            self.last_error = 1e-4;
        }
    }

    fn step<S: System<N>>(
        &mut self,
        system: &S,
        end: f64,
        dense: &mut Dense<N>,
        tally: &mut Tally,
    ) -> Result<(), Failure<S::Refusal>> {
        let t = dense.t1;
        dense.t0 = t;
        dense.y0 = dense.y1;
        if self.slope_known {
            dense.terms[0] = dense.terms[6];
        } else {
            tally.derivatives += 1;
            system
                .derivative(t, &dense.y0, &mut dense.terms[0])
                .map_err(|cause| Failure::Refused { t, cause })?;
        }
        if self.proposed == 0.0 {
            tally.derivatives += 1;
            let start = (t, &dense.y0, &dense.terms[0]);
            let control = (self.tolerance, 5.0);
            self.proposed = first_step(system, start, end, &self.scales, control);
        }
        let mut rejected = false;
        loop {
            let (h, last) = fit(self.proposed, t, end);
            tally.derivatives += 6;
            let (error, refusal) = match advance(system, h, dense) {
                Ok(()) => {
                    let error = difference(h, dense);
                    let error = norm(&error, &dense.y0, &dense.y1, &self.scales, self.tolerance);
                    (error, None)
                }
                Err(cause) => (f64::INFINITY, Some(cause)),
            };
            if error <= 1.0 {
                let grow =
                    SAFETY * error.max(1e-10).powf(0.75 * BETA - 0.2) * self.last_error.powf(BETA);
                let most = if rejected { 1.0 } else { GROW };
                let next = h * grow.clamp(SHRINK, most);
                // A step cut short at the end says nothing against the one that was proposed.
                self.proposed = if last {
                    next.max(self.proposed.min(h * GROW))
                } else {
                    next
                };
                self.last_error = error.max(1e-4);
                self.slope_known = true;
                dense.t1 = if last { end } else { t + h };
                return Ok(());
            }
            tally.rejected += 1;
            rejected = true;
            let factor = if error.is_finite() {
                (SAFETY * error.powf(-0.2)).clamp(SHRINK, 1.0)
            } else {
                SHRINK
            };
            if h * factor < shortest_step(t, end) {
                return Err(match refusal {
                    Some(cause) => Failure::Refused { t, cause },
                    None => Failure::Underflow {
                        t,
                        step_s: h,
                        reason: if error.is_finite() {
                            Reason::Error
                        } else {
                            Reason::NotFinite
                        },
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
        tally.derivatives += 6;
        let done = shorten_by(end, dense, |h, dense| advance(system, h, dense));
        // Where it is not done, the last stage still belongs to the end of the whole step.
        self.slope_known &= done;
        done
    }
}
