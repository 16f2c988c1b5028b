//! The core's pipeline on any machine: the types that a machine's parameters call for, chosen at
//! run time.

use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor, OfKind};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motion, Tick};

/// Evaluates one setpoint with the leanest pipeline that holds all of `parameters`.
///
/// # Panics
/// When the machine is refused.
pub fn evaluate<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motion<N>, Status> {
    let kind = ModelKind::of(parameters, true);
    kind.visit(Evaluate {
        machine: kind.with(parameters),
        setpoint,
    })
}

struct Evaluate<'a, N: Number> {
    machine: OfKind<'a>,
    setpoint: &'a Setpoint<N>,
}

impl<N: Number> ModelVisitor<N> for Evaluate<'_, N> {
    type Output = Result<Motion<N>, Status>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        with::<M>(self.machine, self.setpoint)
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

/// Evaluates one setpoint with the pipeline of the model `M`.
///
/// # Panics
/// When the machine is refused.
pub fn with<'a, M: Model>(
    machine: impl Into<OfKind<'a>>,
    setpoint: &Setpoint<M::N>,
) -> Result<Motion<M::N>, Status> {
    let machine = machine.into();
    Tick::<M>::build(machine)
        .unwrap_or_else(|error| panic!("{error}: {machine:?}"))
        .evaluate(setpoint)
}
