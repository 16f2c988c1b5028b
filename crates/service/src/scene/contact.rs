//! A scene of a machine that detects contacts.

use super::Scene;
use crate::coefficients::Coefficients;
use crate::contact::{ContactCoefficients, ContactMemory};
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::number::ServiceNumber;
use crate::settings::Settings;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::units::Units;
use trirrr_protocol::message::Refusal;
use trirrr_protocol::message::scene::{Section, SectionName};

/// Scene `S` of a machine that detects contacts. `S` has [feedback](super::WithFeedback), and a model with torques.
#[derive(Clone, Copy, Debug)]
pub struct WithContact<'a, S: Scene> {
    /// Everything else of the scene.
    pub scene: S,
    /// Coefficients in SI units. `None` for a machine that detects no contacts.
    pub contact: Option<&'a ContactCoefficients<S::N>>,
}

impl<N: ServiceNumber, S: Scene<N = N>> Scene for WithContact<'_, S> {
    type N = N;
    type Model = S::Model;
    type Slot = S::Slot;
    type Replacement = S::Replacement;
    type Curves = S::Curves;
    type Planner = S::Planner;
    type Part = S::Part;
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = ContactMemory<N>;
    type Coefficients = S::Coefficients;

    fn coefficients(&self, settings: &Settings<N>) -> Result<S::Coefficients, BuildError> {
        self.scene.coefficients(settings)
    }

    fn part(&self, name: SectionName, units: &Units) -> Option<S::Part> {
        self.scene.part(name, units)
    }

    fn homing(&self) -> S::Homing {
        self.scene.homing()
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        self.scene.plan()
    }

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        self.scene.feedback()
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.contact
    }

    #[inline(always)]
    fn changed(
        &self,
        section: &Section,
        units: &Units,
    ) -> Result<(Parameters, LimitParameters), Refusal<N>> {
        self.scene.changed(section, units)
    }

    fn adopt(
        &mut self,
        parameters: Parameters,
        limits: LimitParameters,
        built: Coefficients<S::Model>,
        kept: &mut S::Coefficients,
    ) {
        self.scene.adopt(parameters, limits, built, kept);
    }
}
