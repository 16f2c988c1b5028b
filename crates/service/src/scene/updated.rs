//! A scene of a machine whose program a host may replace.

use super::Scene;
use crate::number::ServiceNumber;
use trirrr_protocol::message::{
    Firmware, ImageHeader, Refusal, UpdateRefusal, UpdateStatus, UpdateStep,
};

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

/// Checks that an image is for the machine whose program is `own` and begins at the address `start`.
///
/// # Errors
/// It is for another chip or board, or begins elsewhere.
pub fn check_image(header: &ImageHeader, own: &Firmware, start: u32) -> Result<(), UpdateRefusal> {
    let new = &header.firmware;
    if own.chip != new.chip {
        return Err(UpdateRefusal::Chip);
    }
    if own.board != new.board {
        return Err(UpdateRefusal::Board);
    }
    match header.start == start {
        true => Ok(()),
        false => Err(UpdateRefusal::Start { expected: start }),
    }
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
