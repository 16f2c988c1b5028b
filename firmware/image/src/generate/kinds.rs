//! The model that a machine needs, so that its image holds nothing else.

use super::constant::constant;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{LinksKind, Model, ModelKind, ModelVisitor};
use trirrr_service::Coefficients;
use trirrr_service::admission::Enclose;

/// Parameters of the coefficients, in the units of the machine.
#[derive(Clone, Copy)]
pub(super) struct Machine<'a> {
    pub(super) kind: ModelKind,
    pub(super) parameters: &'a Parameters,
    pub(super) limits: &'a LimitParameters,
    pub(super) ramp_ticks: u16,
    pub(super) period: f64,
}

impl Machine<'_> {
    /// Returns the coefficients of the service as Rust source.
    ///
    /// # Errors
    /// First quantity that does not fit the number type.
    pub(super) fn coefficients<N: Enclose>(self) -> Result<String, BuildError> {
        self.kind.visit::<N, _>(self)
    }

    /// Returns the path of the model's type for the number type `scalar`.
    pub(super) fn model(&self, scalar: &str) -> String {
        let (model, torque) = ("trirrr_core::model", "trirrr_core::torque");
        let (payload, links) = match self.kind {
            ModelKind::Kinematic => return format!("{model}::Kinematic<{scalar}>"),
            ModelKind::Dynamic(payload, links) => (payload, links),
        };
        let links = match links {
            LinksKind::Massless => "Massless".into(),
            LinksKind::Rotors => format!("Rotors<{scalar}>"),
            LinksKind::MassiveHorizontal => {
                format!("Massive<{scalar}, {torque}::links::Horizontal>")
            }
            LinksKind::MassiveInPlane => {
                format!("Massive<{scalar}, {torque}::links::InPlane<{scalar}>>")
            }
        };
        format!(
            "{model}::Dynamic<{scalar}, {torque}::payload::{payload:?}<{scalar}>, {torque}::links::{links}>"
        )
    }
}

impl<N: Enclose> ModelVisitor<N> for Machine<'_> {
    type Output = Result<String, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        Coefficients::<M>::build(self.parameters, self.limits, self.ramp_ticks, self.period)
            .map(|coefficients| constant(&coefficients))
    }
}
