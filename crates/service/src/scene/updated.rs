//! A scene of a machine whose program a host may replace.

use super::Scene;
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
    super::inner!(digital, levels, homing, feedback, contact, interlocks);
    type Update = UpdateStep;

    fn update(&mut self, step: &UpdateStep) -> Result<(), Refusal<N>> {
        self.slot.step(step).map_err(Refusal::Update)
    }

    fn update_status(&self) -> Option<UpdateStatus> {
        Some(self.slot.status())
    }
}
