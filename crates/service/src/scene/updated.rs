//! A scene of a machine whose program a host may replace.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::digital::DigitalParameters;
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::number::ServiceNumber;
use trirrr_protocol::message::{Refusal, UpdateRefusal, UpdateStatus, UpdateStep};

/// Place where a machine puts a new image of its program.
pub trait ImageSlot {
    /// Takes a step of an update. The machine stands with its drives off.
    ///
    /// # Errors
    /// Reason why the step is not taken.
    fn step(&mut self, step: &UpdateStep) -> Result<(), UpdateRefusal>;

    /// Returns the update as it stands.
    fn status(&self) -> UpdateStatus;
}

/// Scene `S` of a machine that takes new images into `U`.
#[derive(Clone, Copy, Debug)]
pub struct WithUpdate<S, U> {
    /// Everything else of the scene.
    pub scene: S,
    /// Place of the image.
    pub slot: U,
}

impl<N: ServiceNumber, S: Scene<N = N>, U: ImageSlot> Scene for WithUpdate<S, U> {
    super::inner_parts!();
    type Update = UpdateStep;
    type Digital = S::Digital;
    type Levels = S::Levels;
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = S::Interlocks;

    fn update(&mut self, step: &UpdateStep) -> Result<(), Refusal<N>> {
        self.slot.step(step).map_err(Refusal::Update)
    }

    fn update_status(&self) -> Option<UpdateStatus> {
        Some(self.slot.status())
    }

    #[inline(always)]
    fn digital(&self) -> DigitalParameters {
        self.scene.digital()
    }

    #[inline(always)]
    fn levels(&self) -> u16 {
        self.scene.levels()
    }

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
