//! Update over the line: the image goes into the slot of the new one, and the boot loader installs it. Values of a
//! scene go into one of two slots of their own, of an image that takes them.

mod image_flash;
#[cfg(scene_over_line)]
mod scene_slot;

pub use image_flash::is_lost_expected;
pub(crate) use image_flash::{ImageFlash, LAYOUT};
#[cfg(scene_over_line)]
pub(crate) use scene_slot::values;

use crate::scene::TICK_RATE_HZ;
use crate::tick::heartbeat;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use cortex_m::peripheral::SCB;
use image_flash::refusal;
use scene_slot::SceneSlot;
use trirrr_boot::{Receiver, Slot, Stage, WholeImage, confirm, stage};
use trirrr_protocol::message::{
    Firmware, ImageHeader, UpdateOutcome, UpdateRefusal, UpdateStatus, UpdateStep,
};
use trirrr_service::features::{ImageSlot, check_image};

/// Values of a scene are not taken.
#[cfg(not(scene_over_line))]
mod scene_slot {
    use super::ImageFlash;
    use trirrr_boot::{Receiver, Slot};
    use trirrr_protocol::message::{SceneHeader, SceneRoom, UpdateRefusal};

    #[derive(Debug)]
    pub(super) struct SceneSlot;

    impl SceneSlot {
        pub(super) const NONE: Self = Self;

        pub(super) const ROOM: Option<SceneRoom> = None;

        pub(super) fn slot(&self) -> Option<Slot> {
            None
        }

        pub(super) fn begin(
            &mut self,
            _: &SceneHeader,
            _: &mut Receiver,
        ) -> Result<(), UpdateRefusal> {
            Err(UpdateRefusal::NoScene)
        }

        pub(super) fn finish(
            &mut self,
            _: &mut ImageFlash,
            _: &mut Receiver,
        ) -> Result<bool, UpdateRefusal> {
            Ok(false)
        }
    }
}

/// Ticks from the answer to a restart until it: all answers are out.
const RESTART_TICKS: u32 = (TICK_RATE_HZ / 10.0) as u32 + 1;

/// A restart was asked for, in this tick.
static RESTARTS: AtomicBool = AtomicBool::new(false);
static ASKED_AT: AtomicU32 = AtomicU32::new(0);

/// Slot of the new image.
#[derive(Debug)]
pub struct NewImage {
    receiver: Receiver,
    /// Build of the program that runs.
    firmware: &'static Firmware,
    /// Slot of the values of a scene, if such come.
    scene: SceneSlot,
}

/// The slot, of a program of this build.
pub(crate) fn new_image(firmware: &'static Firmware) -> NewImage {
    NewImage {
        receiver: Receiver::NONE,
        firmware,
        scene: SceneSlot::NONE,
    }
}

impl NewImage {
    /// Slot of what comes.
    fn slot(&self) -> Slot {
        self.scene.slot().unwrap_or(LAYOUT.new)
    }

    fn finish(&mut self, flash: &mut ImageFlash) -> Result<(), UpdateRefusal> {
        if self.scene.finish(flash, &mut self.receiver)? {
            return Ok(());
        }
        let finished = self.receiver.finish(flash, &LAYOUT);
        finished.map_err(|error| refusal(error, LAYOUT.new.bytes()))
    }

    fn begin(&mut self, header: &ImageHeader) -> Result<(), UpdateRefusal> {
        check_image(header, self.firmware, LAYOUT.program.start)?;
        let image = WholeImage {
            length: header.length,
            checksum: header.checksum,
        };
        let room = LAYOUT.new.bytes();
        let begun = self.receiver.begin(room, image);
        begun.map_err(|error| refusal(error, room))?;
        self.scene = SceneSlot::NONE;
        Ok(())
    }
}

impl ImageSlot for NewImage {
    type Step = UpdateStep;

    fn step(&mut self, step: &UpdateStep) -> Result<(), UpdateRefusal> {
        let mut flash = ImageFlash::take();
        match step {
            UpdateStep::Begin(header) => self.begin(header),
            UpdateStep::BeginScene(header) => self.scene.begin(header, &mut self.receiver),
            UpdateStep::Block(block) => {
                let slot = self.slot();
                let taken = self
                    .receiver
                    .block(&mut flash, &slot, block.offset, block.bytes());
                taken.map_err(|error| refusal(error, slot.bytes()))
            }
            UpdateStep::Finish => self.finish(&mut flash),
            UpdateStep::Restart => {
                ASKED_AT.store(heartbeat::ticks(), Ordering::Relaxed);
                RESTARTS.store(true, Ordering::Relaxed);
                Ok(())
            }
        }
    }

    fn status(&self) -> Option<UpdateStatus> {
        let outcome = match stage(&ImageFlash::take(), &LAYOUT) {
            Stage::None => UpdateOutcome::Never,
            // The boot loader leaves none of the other two behind.
            Stage::Requested(_) | Stage::Saved(_) | Stage::Installed(_) => UpdateOutcome::Requested,
            Stage::OnTrial(_) => UpdateOutcome::OnTrial,
            Stage::Confirmed(_) => UpdateOutcome::Confirmed,
            Stage::Reverted(_) => UpdateOutcome::Reverted,
        };
        Some(UpdateStatus {
            start: LAYOUT.program.start,
            room: LAYOUT.new.bytes(),
            coming: self.receiver.image().map(|image| image.checksum),
            received: self.receiver.received(),
            outcome,
            scene: SceneSlot::ROOM,
        })
    }
}

/// Confirms the program that runs: a host understands it. Does nothing unless it is on trial.
#[inline(never)]
pub(crate) fn confirm_program() {
    if confirm(&mut ImageFlash::take(), &LAYOUT).is_err() {
        // Nothing is lost: the next start goes back to the old program.
        defmt::error!("the new program cannot be confirmed");
    }
}

/// Starts the board anew if that was asked for, and the answer is out.
pub(crate) fn restart_if_asked() {
    let waited = heartbeat::ticks().wrapping_sub(ASKED_AT.load(Ordering::Relaxed));
    if RESTARTS.load(Ordering::Relaxed) && waited >= RESTART_TICKS {
        SCB::sys_reset();
    }
}
