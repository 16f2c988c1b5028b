//! A scene whose drives tell where they are.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::feedback::{DriveFeedback, FeedbackCoefficients};
use crate::homing::Plan;
use crate::number::ServiceNumber;

/// Scene `S` of a machine whose drives tell where they are.
#[derive(Clone, Copy, Debug)]
pub struct WithFeedback<'a, S: Scene> {
    /// Everything else of the scene.
    pub scene: S,
    /// Coefficients in the units of the machine. `None` for drives that tell nothing.
    pub feedback: Option<&'a FeedbackCoefficients<S::N>>,
}

impl<N: ServiceNumber, S: Scene<N = N>> Scene for WithFeedback<'_, S> {
    super::inner_scene!();
    type Homing = S::Homing;
    type Feedback = DriveFeedback<N>;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = S::Interlocks;

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
        self.feedback
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.scene.contact()
    }
}
