//! The core's pipeline on any machine: the types that a machine's parameters call for, chosen at
//! run time.

use trirrr_core::machine::{Geometry, LinksKind, Parameters, PayloadKind};
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
    match PayloadKind::of(parameters) {
        PayloadKind::Centred => with_payload::<N, Centred<N>>(parameters, setpoint),
        PayloadKind::Offset => with_payload::<N, Offset<N>>(parameters, setpoint),
    }
}

fn with_payload<N: Number, P: Payload<N>>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motion<N>, Status> {
    match LinksKind::of(parameters) {
        LinksKind::Massless => with::<N, P, Massless>(parameters, setpoint),
        LinksKind::Rotors => with::<N, P, Rotors<N>>(parameters, setpoint),
        LinksKind::MassiveHorizontal => with::<N, P, Massive<N, Horizontal>>(parameters, setpoint),
        LinksKind::MassiveInPlane => with::<N, P, Massive<N, InPlane<N>>>(parameters, setpoint),
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
