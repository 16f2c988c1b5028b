//! The model that a machine needs, so that its image holds nothing else.

use super::constant::{constant, path};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_service::admission::Enclose;
use trirrr_service::{Coefficients, Ramp};

/// Parameters of the coefficients, in the units of the machine.
#[derive(Clone, Copy)]
pub(super) struct Machine<'a> {
    pub(super) parameters: &'a Parameters,
    pub(super) limits: &'a LimitParameters,
    pub(super) ramp: Ramp,
    pub(super) period: f64,
}

/// Path of a model and the coefficients of its service, as Rust source.
pub(super) struct ModelSource {
    pub(super) model: String,
    pub(super) coefficients: String,
}

impl<N: Enclose> ModelVisitor<N> for Machine<'_> {
    type Output = Result<ModelSource, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let Self {
            parameters, limits, ..
        } = self;
        let coefficients = Coefficients::<M>::build(parameters, limits, self.ramp, self.period)?;
        Ok(ModelSource {
            model: path::<M>(),
            coefficients: constant(&coefficients),
        })
    }
}
