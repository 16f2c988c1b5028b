//! What a service works with.

use crate::admission::{Enclose, EnclosedPath, Path};
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{BuildError, Parameters, Quantity};
use trirrr_core::singularity::Distances;
use trirrr_core::tick::Tick;
use trirrr_core::torque::balance::Solve;
use trirrr_core::torque::links::Links;
use trirrr_core::torque::payload::Payload;

/// The coefficients of all that a service computes, in its number type: plain numbers, so that
/// whoever builds an image can build them too and write them as constants.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<N: Enclose, P: Payload<N>, L: Links<N>> {
    /// Of the tick.
    pub tick: Tick<N, P, L>,
    /// What its results must keep.
    pub limits: Limits<N>,
    /// Of the distances to the singularities.
    pub distances: Distances<N>,
    /// Of the admission.
    pub path: EnclosedPath<N, P, L>,
}

impl<N: Enclose, P: Payload<N>, L: Links<N>> Coefficients<N, P, L> {
    /// Checks the machine and its limits, in its own units, and builds the coefficients.
    /// `ramp_ticks`, positive, is how long a hold or a stop takes from normal speed to rest; a tick
    /// lasts `period`.
    ///
    /// # Errors
    /// The first quantity that is refused; a limit of torque or power where `P` computes no
    /// torques.
    pub fn build(
        parameters: &Parameters,
        limits: &LimitParameters,
        ramp_ticks: u16,
        period: f64,
    ) -> Result<Self, BuildError> {
        if !P::Balance::TORQUES {
            no_limit(Quantity::TorqueLimit, limits.torque_nm)?;
            no_limit(Quantity::PowerLimit, limits.power_w)?;
        }
        let tick = Tick::build(parameters)?;
        let limits = Limits::build(limits)?;
        Ok(Self {
            tick,
            limits,
            distances: Distances::build(parameters),
            path: Path::build(parameters, limits.map(N::bound), ramp_ticks, period)?,
        })
    }
}

fn no_limit(quantity: Quantity, limit: Option<[f64; 3]>) -> Result<(), BuildError> {
    match limit {
        None => Ok(()),
        Some([value, ..]) => Err(BuildError {
            quantity,
            leg: Some(0),
            value,
            expected: "no limit, for no torque is computed",
        }),
    }
}
