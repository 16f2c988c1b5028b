//! Outcome of a run.

use crate::statistics::Statistics;
use crate::watch::Ending;
use std::fmt;
use std::time::Duration;
use trirrr_integrate::stability::Warning;
use trirrr_integrate::{Method, Tally};

/// End of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantEnd {
    /// The run reached its end.
    Complete,
    /// The caller stopped the run, or gave too few ticks.
    Interrupted {
        /// Time in s.
        t: f64,
    },
    /// The plant ended it.
    Ended(Ending),
    /// The energies do not close: what was simulated is not the machine's motion any more.
    EnergyLost(EnergyLoss),
    /// The integration could not go on.
    Failed(String),
}

impl PlantEnd {
    /// Reason why the run did not reach its end; none of one that did, or was interrupted.
    pub fn reason(&self) -> Option<String> {
        match self {
            Self::Complete | Self::Interrupted { .. } => None,
            Self::Ended(ending) => Some(format!("in the plant: {ending}")),
            Self::EnergyLost(loss) => Some(format!("the plant {loss}")),
            Self::Failed(reason) => Some(format!("the plant: {reason}")),
        }
    }
}

/// Energy that is missing beyond the errors that the method of integration explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyLoss {
    /// Time at which it was noticed, s.
    pub t: f64,
    /// Missing energy, J.
    pub missing: f64,
    /// Most that the method explains, J.
    pub allowed: f64,
    /// Instability of the method with its step, where that is the cause.
    pub unstable: Option<Warning>,
}

impl fmt::Display for EnergyLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "loses its energy: {:.3e} J are missing at t = {:.6} s, {:.3e} J are explained; ",
            self.missing, self.t, self.allowed
        )?;
        match &self.unstable {
            Some(warning) => write!(f, "{warning}"),
            None => f.write_str("choose a smaller step or tolerance"),
        }
    }
}

/// Energies over a run, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Work of the motors' supply.
    pub work: f64,
    /// Losses.
    pub losses: f64,
    /// Change of kinetic, potential, elastic and magnetic energy.
    pub stored: f64,
    /// Scale of the error: the largest size of work, losses, kinetic energy or stored energy on the
    /// way.
    pub scale: f64,
}

impl Balance {
    /// Energy that is missing, J.
    pub fn missing(&self) -> f64 {
        self.work - self.losses - self.stored
    }

    /// Energy that is missing, relative to the scale; 0 if there was none.
    pub fn error(&self) -> f64 {
        if self.scale == 0.0 {
            return 0.0;
        }
        self.missing() / self.scale
    }
}

/// Outcome of a run of a plant.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// End of the run.
    pub end: PlantEnd,
    /// Time simulated, s.
    pub simulated_s: f64,
    /// Time that the simulation took; 0 in WebAssembly, which has no clock.
    pub elapsed: Duration,
    /// Method of integration.
    pub method: Method,
    /// Reason of the choice.
    pub reason: Option<String>,
    /// Warnings about the method.
    pub warnings: Vec<String>,
    /// Steps and derivatives.
    pub tally: Tally,
    /// Largest eigenvalue of the linearisation at the start, 1/s.
    pub fastest: f64,
    /// Statistics of the whole run.
    pub statistics: Statistics,
    /// Energies.
    pub balance: Balance,
    /// Number of state variables.
    pub dimension: usize,
}

impl Outcome {
    /// Times faster than real time.
    pub fn ratio(&self) -> f64 {
        self.simulated_s / self.elapsed.as_secs_f64().max(1e-9)
    }
}
