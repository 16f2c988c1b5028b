//! A scene whose drives tell where they are.

use super::Scene;
use crate::feedback::{DriveFeedback, FeedbackCoefficients};
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
    super::inner!(update, digital, levels, homing, contact, interlocks);
    type Feedback = DriveFeedback<N>;

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        self.feedback
    }
}
