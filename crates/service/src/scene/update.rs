//! Replacement of a machine's program by a host.

use trirrr_protocol::message::{
    Content, Firmware, ImageHeader, Unread, UpdateRefusal, UpdateStatus, UpdateStep,
};

/// Place where a machine puts a new image of its program; `()` without one.
pub trait ImageSlot {
    /// Type as which a step of an update in a request is read.
    type Step: Content<UpdateStep>;

    /// False for a program that cannot be replaced over the line.
    const EXISTS: bool = true;

    /// Takes a step of an update. The machine stands with its drives off.
    ///
    /// # Errors
    /// Reason why the step is not taken.
    fn step(&mut self, step: &UpdateStep) -> Result<(), UpdateRefusal>;

    /// Returns the state of the update; `None` where there is no slot.
    fn status(&self) -> Option<UpdateStatus>;
}

impl ImageSlot for () {
    type Step = Unread<UpdateStep>;
    const EXISTS: bool = false;

    #[inline(always)]
    fn step(&mut self, _: &UpdateStep) -> Result<(), UpdateRefusal> {
        Ok(())
    }

    #[inline(always)]
    fn status(&self) -> Option<UpdateStatus> {
        None
    }
}

/// Slot of a host: it reads every request as a client writes it, and takes no image.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoImage;

impl ImageSlot for NoImage {
    type Step = UpdateStep;
    const EXISTS: bool = false;

    fn step(&mut self, _: &UpdateStep) -> Result<(), UpdateRefusal> {
        Ok(())
    }

    fn status(&self) -> Option<UpdateStatus> {
        None
    }
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
