//! A scene of a machine with spare inputs and outputs.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::digital::{DigitalParameters, DigitalPorts};
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::number::ServiceNumber;

/// Scene `S` of a machine with spare inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub struct WithDigital<S> {
    /// Everything else of the scene.
    pub scene: S,
    /// Inputs and outputs that the scene names; none of a machine without any.
    pub parameters: DigitalParameters,
}

impl<N: ServiceNumber, S: Scene<N = N>> Scene for WithDigital<S> {
    super::inner_updates!();
    type Digital = DigitalPorts;
    type Levels = S::Levels;
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = S::Interlocks;

    #[inline(always)]
    fn digital(&self) -> DigitalParameters {
        self.parameters
    }

    #[inline(always)]
    fn levels(&self) -> u16 {
        self.scene.levels()
    }

    #[inline(always)]
    fn homing(&self) -> S::Homing {
        self.scene.homing()
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        self.scene.plan()
    }

    #[inline(always)]
    fn interlocks(&self) -> S::Interlocks {
        self.scene.interlocks()
    }

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        self.scene.feedback()
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.scene.contact()
    }
}
