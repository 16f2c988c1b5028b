//! Coefficients with which a service computes.

use crate::admission::Enclose;
use crate::admission::Path;
use crate::pace::Ramp;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{BuildError, Quantity};
use trirrr_core::model::{Model, OfKind};
use trirrr_core::setpoint::CurveKind;
use trirrr_core::singularity::Distances;
use trirrr_core::tick::Tick;
use trirrr_core::to_source;

/// The coefficients of all that a service computes, in its number type: plain numbers, so that
/// whoever builds an image can build them too and write them as constants.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<M: Model<N: Enclose>> {
    /// Of the tick.
    pub(crate) tick: Tick<M>,
    /// Limits that the results of the tick must keep.
    pub(crate) limits: Limits<M::N>,
    /// Of the distances to the singularities.
    pub(crate) distances: Distances<M::N>,
    /// Of the admission.
    pub(crate) path: Path<M>,
}

to_source!([M: Model<N: Enclose>] Coefficients [M] in trirrr_service::coefficients {
    tick: Tick<M>,
    limits: Limits<M::N>,
    distances: Distances<M::N>,
    path: Path<M>,
});

impl<M: Model<N: Enclose>> Coefficients<M> {
    /// Checks the machine and its limits, in its own units, and builds the coefficients.
    /// A hold or a stop takes `ramp`; a tick lasts `period`.
    ///
    /// # Errors
    /// The first quantity that is refused; a limit of torque or power where `M` computes no
    /// torques.
    pub fn build<'a>(
        machine: impl Into<OfKind<'a>>,
        limits: &LimitParameters,
        ramp: Ramp,
        period: f64,
    ) -> Result<Self, BuildError> {
        if !M::TORQUES {
            no_limit(Quantity::TorqueLimit, limits.torque_nm, NO_TORQUES)?;
            no_limit(Quantity::PowerLimit, limits.power_w, NO_TORQUES)?;
        }
        let machine = machine.into();
        let tick = Tick::build(machine)?;
        let limits = Limits::build(limits)?;
        Ok(Self {
            tick,
            limits,
            distances: Distances::build(machine.parameters),
            path: Path::build(machine, limits.map(<M::N>::bound), ramp, period)?,
        })
    }
}

const NO_TORQUES: &str = "no limit, for no torque is computed";

/// Refuses a limit of jerk of a machine whose kinds of moves know none.
pub(crate) fn allow_jerk<K: CurveKind>(limit: Option<[f64; 3]>) -> Result<(), BuildError> {
    let expected = "no limit, for the moves are built without one";
    match K::JERK {
        true => Ok(()),
        false => no_limit(Quantity::JerkLimit, limit, expected),
    }
}

fn no_limit(
    quantity: Quantity,
    limit: Option<[f64; 3]>,
    expected: &'static str,
) -> Result<(), BuildError> {
    match limit {
        None => Ok(()),
        Some([value, ..]) => Err(BuildError {
            quantity,
            leg: Some(0),
            value,
            expected,
        }),
    }
}
