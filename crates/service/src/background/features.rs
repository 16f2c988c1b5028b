//! The background's ends of the features, and what each does as moves are admitted or dropped.

use crate::contact::ContactReceiver;
use crate::digital::DigitalSender;
use crate::feature::{Of, Optional};
use crate::feedback::{FeedbackCoefficients, FeedbackReceiver};
use crate::homing::HomingCoefficients;
use crate::levels::LevelStore;
use crate::number::ServiceNumber;
use crate::queue::Sender;
use crate::scene::{ChangesOf, CurvesOf, ModelOf, QuinticsOf, Scene, Setup};
use crate::splice::SpliceSender;

use super::Retargeting;

/// The background's end of each feature.
pub(crate) struct BackgroundFeatures<'q, S: Scene> {
    pub(crate) splices: Of<QuinticsOf<S>, SpliceSender<'q, S::N, CurvesOf<S>>>,
    /// Retarget by command, and moves of it that are ordered.
    pub(crate) retargeting: Of<QuinticsOf<S>, Retargeting<S::N>>,
    pub(crate) setups: Of<ChangesOf<S>, Sender<'q, Setup<ModelOf<S>>>>,
    pub(crate) levels: Of<S::Levels, LevelStore<'q, S::N>>,
    /// `None` for a machine that knows where its motors are.
    pub(crate) homing: Of<S::Homing, Option<&'q HomingCoefficients<S::N>>>,
    pub(crate) feedback: Of<S::Feedback, FeedbackReceiver<'q, S::N>>,
    pub(crate) contact: Of<S::Contact, ContactReceiver<'q, S::N>>,
    pub(crate) digital: Of<S::Digital, DigitalSender<'q>>,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>> BackgroundFeatures<'q, S> {
    /// Hands what belongs to move `number`, which is admitted, to the tick; before the move itself.
    #[inline(always)]
    pub(super) fn admit(&mut self, number: u32, generation: u8) {
        if let Some(levels) = self.levels.get_mut() {
            levels.admit(number, generation);
        }
        if let Some(digital) = self.digital.get_mut() {
            digital.admit(number, generation);
        }
    }

    /// Drops the levels of all moves that are not admitted.
    #[inline(always)]
    pub(super) fn drop_levels(&mut self) {
        if let Some(levels) = self.levels.get_mut() {
            levels.withdraw();
        }
    }

    /// Drops the changes of outputs with all moves that are not admitted.
    #[inline(always)]
    pub(super) fn drop_outputs(&mut self) {
        if let Some(digital) = self.digital.get_mut() {
            digital.withdraw();
        }
    }

    /// Drops what belongs to moves that are not admitted.
    #[inline(always)]
    pub(super) fn withdraw(&mut self) {
        self.drop_levels();
        self.drop_outputs();
    }

    /// Returns the coefficients of drives that tell something.
    #[inline(always)]
    pub(super) fn measured(&self) -> Option<&'q FeedbackCoefficients<N>> {
        self.feedback.get()?.coefficients
    }

    /// Returns the coefficients of a machine that has to be homed.
    #[inline(always)]
    pub(super) fn homed(&self) -> Option<&'q HomingCoefficients<N>> {
        self.homing.get().copied().flatten()
    }
}
