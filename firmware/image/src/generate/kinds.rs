//! The model that a machine needs, so that its image holds nothing else.

use super::constant::{constant, path};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::number::Number;
use trirrr_core::tick::Tick;
use trirrr_service::admission::Enclose;
use trirrr_service::coefficients::Coefficients;
use trirrr_service::paces::Ramp;

/// Parameters of the coefficients, in the units of the machine.
#[derive(Clone, Copy)]
pub(super) struct Machine<'a> {
    pub(super) kind: ModelKind,
    pub(super) parameters: &'a Parameters,
    pub(super) limits: &'a LimitParameters,
    pub(super) ramp: Ramp,
    pub(super) period: f64,
}

/// The path of a model.
pub(super) struct ModelPath;

impl<N: Number> ModelVisitor<N> for ModelPath {
    type Output = String;

    fn visit<M: Model<N = N>>(self) -> String {
        path::<M>()
    }
}

/// The coefficients of the tick alone, as Rust source.
pub(super) struct TickOf<'a>(pub(super) Machine<'a>);

impl<N: Number> ModelVisitor<N> for TickOf<'_> {
    type Output = Result<String, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let Self(Machine {
            kind, parameters, ..
        }) = self;
        Ok(constant(&Tick::<M>::build(kind.with(parameters))?))
    }
}

impl<N: Enclose> ModelVisitor<N> for Machine<'_> {
    /// The coefficients of a service, as Rust source: those of the model of the machine's kind.
    type Output = Result<String, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let machine = self.kind.with(self.parameters);
        let coefficients = Coefficients::<M>::build(machine, self.limits, self.ramp, self.period)?;
        Ok(constant(&coefficients))
    }
}
