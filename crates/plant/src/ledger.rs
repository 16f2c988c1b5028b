//! Energies over a run, and the most that may be missing of them.

use crate::outcome::{Balance, EnergyLoss};
use crate::outputs::Energies;
use trirrr_integrate::Method;
use trirrr_integrate::stability::Warning;

/// Steps may miss so many times what is expected of them: the records of work and losses are not under
/// the control of errors, and errors of a violent motion are larger than its rates say.
const SAFETY: f64 = 100.0;
/// No run may miss more than this part of its energy, whatever its step or tolerance.
const MOST: f64 = 1e-2;
/// No run that ends at a singularity may: more is missing than its time can be relied on to 1e-6 s.
const MOST_AT_SINGULARITY: f64 = 1e-5;
/// Part of all energies, those of a machine at rest too, that rounding may take.
const ROUNDING: f64 = 1e-13;

/// Energies of a run up to now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ledger {
    method: Method,
    /// Stored energy at the start, J.
    start: f64,
    balance: Balance,
    /// Kinetic energy of rates as large as their scales, J.
    unit: f64,
    /// Fastest rate of the equations or of the motion so far, 1/s.
    fastest: f64,
    unstable: Option<Warning>,
}

impl Ledger {
    /// Starts with the energies at rest. `unit` is the kinetic energy, in J, of rates as large as their
    /// scales; `fastest` the largest eigenvalue in 1/s. The method may be `unstable`.
    pub(crate) fn new(
        method: Method,
        start: &Energies,
        unit: f64,
        fastest: f64,
        unstable: Option<Warning>,
    ) -> Self {
        Self {
            method,
            start: start.stored,
            balance: Balance::default(),
            unit,
            fastest,
            unstable,
        }
    }

    /// Takes the energies at an instant.
    pub(crate) fn note(&mut self, energies: &Energies) {
        let stored = energies.stored - self.start;
        let sizes = [energies.work, energies.losses, energies.kinetic, stored];
        let largest = |largest: f64, size: &f64| largest.max(size.abs());
        self.balance = Balance {
            work: energies.work,
            losses: energies.losses,
            stored,
            scale: sizes.iter().fold(self.balance.scale, largest),
        };
        self.fastest = energies.rates.iter().fold(self.fastest, largest);
    }

    /// Energies at the last instant that was noted.
    pub(crate) fn balance(&self) -> &Balance {
        &self.balance
    }

    /// The loss at the time `t` after `steps` steps, where more is missing than they explain.
    ///
    /// A step of an adaptive method may err by its tolerance of each rate or of its scale, where that is
    /// larger. One of order p and length h errs by (h w)^(p + 1), w being the fastest rate; a motion that
    /// began at rest has changed at a rate of 1 / t. Energy that is missing stays so: errors add
    /// up over the steps, and nothing makes them grow.
    pub(crate) fn check(&self, t: f64, steps: u64, singular: bool) -> Option<EnergyLoss> {
        let scale = self.balance.scale;
        let steps = (steps as f64).max(1.0);
        let rate = self.fastest.max(1.0 / t);
        let each = match self.method {
            Method::SemiImplicitEuler { step_s } => (step_s * rate).powi(2) * scale,
            Method::Rk4 { step_s } => (step_s * rate).powi(5) * scale,
            Method::DormandPrince { tolerance } | Method::RadauIia { tolerance } => {
                tolerance * (scale + (scale * self.unit).sqrt())
            }
        };
        // The first steps from rest may miss a step's share.
        let most = match singular {
            true => MOST_AT_SINGULARITY,
            false => MOST.max(1.0 / steps),
        };
        let rounding = ROUNDING * (self.unit + self.start.abs() + scale);
        let allowed = (SAFETY * each * steps).min(most * scale).max(rounding);
        let missing = self.balance.missing();
        // What is not a number is not within anything.
        let closes = missing.abs() <= allowed;
        (!closes).then_some(EnergyLoss {
            t,
            missing,
            allowed,
            unstable: self.unstable,
        })
    }
}
