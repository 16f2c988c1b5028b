//! The core's pipeline on any machine: the types that a machine's parameters call for, chosen at
//! run time.

use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motion, Tick};
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload};

/// Evaluates one setpoint with the leanest pipeline that holds all of `parameters`.
///
/// # Panics
/// When the machine is refused.
pub fn evaluate<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motion<N>, Status> {
    if parameters.platform.com_m.x == 0.0 && parameters.platform.com_m.y == 0.0 {
        with_payload::<N, Centred<N>>(parameters, setpoint)
    } else {
        with_payload::<N, Offset<N>>(parameters, setpoint)
    }
}

fn with_payload<N: Number, P: Payload<N>>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motion<N>, Status> {
    let gravity = parameters.gravity_m_s2;
    let rotors = parameters
        .legs
        .iter()
        .any(|leg| leg.rotor_inertia_kgm2 != 0.0);
    match (
        parameters.links_are_massless(),
        rotors,
        gravity.x == 0.0 && gravity.y == 0.0,
    ) {
        (true, false, _) => with::<N, P, Massless>(parameters, setpoint),
        (true, true, _) => with::<N, P, Rotors<N>>(parameters, setpoint),
        (false, _, true) => with::<N, P, Massive<N, Horizontal>>(parameters, setpoint),
        (false, _, false) => with::<N, P, Massive<N, InPlane<N>>>(parameters, setpoint),
    }
}

/// The scale-free distances of a pose from the serial and the parallel singularities; zeros where
/// the pose is out of reach.
///
/// # Panics
/// When the machine is refused.
pub fn distances<N: Number>(parameters: &Parameters, pose: &Pose<N>) -> ([f64; 3], f64) {
    let geometry = Geometry::<N>::build(parameters).unwrap_or_else(|error| panic!("{error}"));
    let distances = Distances::<N>::build(parameters);
    geometry.position(pose).map_or(([0.0; 3], 0.0), |position| {
        (
            distances.serial(&position).map(N::to_f64),
            distances.parallel(&position).to_f64(),
        )
    })
}

/// Evaluates one setpoint with the pipeline of the given types.
///
/// # Panics
/// When the machine is refused.
pub fn with<N: Number, P: Payload<N>, L: Links<N>>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motion<N>, Status> {
    Tick::<N, P, L>::build(parameters)
        .unwrap_or_else(|error| panic!("{error}: {parameters:?}"))
        .evaluate(setpoint)
}
