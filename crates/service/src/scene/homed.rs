//! A scene with homing.

use super::Scene;
use crate::coefficients::Coefficients;
use crate::contact::ContactCoefficients;
use crate::feedback::FeedbackCoefficients;
use crate::homing::{Cycle, HomingCoefficients, Plan};
use crate::number::ServiceNumber;
use crate::settings::Settings;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::units::Units;
use trirrr_protocol::message::Refusal;
use trirrr_protocol::message::scene::{Section, SectionName};

/// Scene `S` of a machine that is homed.
#[derive(Clone, Copy, Debug)]
pub struct WithHoming<'a, S: Scene> {
    /// Everything else of the scene.
    pub scene: S,
    /// Homing in the units of the machine. `None` for a machine that knows the angles of its motors.
    pub homing: Option<&'a HomingCoefficients<S::N>>,
}

impl<'a, N: ServiceNumber, S: Scene<N = N>> Scene for WithHoming<'a, S> {
    type N = N;
    type Model = S::Model;
    type Slot = S::Slot;
    type Replacement = S::Replacement;
    type Curves = S::Curves;
    type Planner = S::Planner;
    type Part = S::Part;
    type Homing = Option<Cycle<'a, N>>;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Coefficients = S::Coefficients;

    fn coefficients(&self, settings: &Settings<N>) -> Result<S::Coefficients, BuildError> {
        self.scene.coefficients(settings)
    }

    fn part(&self, name: SectionName, units: &Units) -> Option<S::Part> {
        self.scene.part(name, units)
    }

    fn homing(&self) -> Option<Cycle<'a, N>> {
        self.homing.map(Cycle::new)
    }

    fn plan(&self) -> Option<Plan<N>> {
        let homing = self.homing?;
        let axes = homing.axes.each_ref();
        Some(Plan {
            from: axes.map(|axis| axis.park),
            to: homing.start,
            ticks: homing.times.to_start,
            rates: axes.map(|axis| axis.search),
            accelerations: axes.map(|axis| axis.acceleration),
        })
    }

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        self.scene.feedback()
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.scene.contact()
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
