//! Update over the line: the image goes into the slot of the new one, and the boot loader installs it. Values of a
//! scene go into one of two slots of their own, of an image that takes them.

use crate::heartbeat;
use crate::image_flash::{ImageFlash, LAYOUT};
use crate::scene::TICK_RATE_HZ;
#[cfg(scene_over_line)]
use crate::stored_scene;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use cortex_m::peripheral::SCB;
use trirrr_boot::{
    FlashError, JournalError, ReceiveError, Receiver, Slot, Stage, WholeImage, confirm, stage,
};
use trirrr_protocol::message::{
    Firmware, ImageHeader, SceneHeader, UpdateOutcome, UpdateRefusal, UpdateStatus, UpdateStep,
};
use trirrr_service::features::{ImageSlot, check_image};

/// Ticks from the answer to a restart until it: all answers are out.
const RESTART_TICKS: u32 = (TICK_RATE_HZ / 10.0) as u32 + 1;

/// A restart was asked for, in this tick.
static RESTARTS: AtomicBool = AtomicBool::new(false);
static ASKED_AT: AtomicU32 = AtomicU32::new(0);

/// Label of the image, by which a host finds its build in the file.
#[derive(Debug)]
#[repr(C)]
pub struct ImageLabel {
    mark: [u8; 16],
    /// Build of the image.
    pub firmware: Firmware,
}

impl ImageLabel {
    /// Label of an image with this build.
    pub const fn new(firmware: Firmware) -> Self {
        Self {
            mark: *trirrr_protocol::message::IMAGE_MARK,
            firmware,
        }
    }
}

/// Slot of the new image.
#[derive(Debug)]
pub struct NewImage {
    receiver: Receiver,
    /// Build of the program that runs.
    firmware: &'static Firmware,
    /// Slot of the values of a scene, if such come.
    #[cfg(scene_over_line)]
    scene: Option<Slot>,
}

impl NewImage {
    pub(crate) fn new(firmware: &'static Firmware) -> Self {
        Self {
            receiver: Receiver::NONE,
            firmware,
            #[cfg(scene_over_line)]
            scene: None,
        }
    }

    /// Slot of what comes.
    #[cfg(not(scene_over_line))]
    fn slot(&self) -> Slot {
        LAYOUT.new
    }

    #[cfg(scene_over_line)]
    fn slot(&self) -> Slot {
        self.scene.unwrap_or(LAYOUT.new)
    }

    #[cfg(not(scene_over_line))]
    fn begin_scene(&mut self, _: &SceneHeader) -> Result<(), UpdateRefusal> {
        Err(UpdateRefusal::NoScene)
    }

    #[cfg(scene_over_line)]
    fn begin_scene(&mut self, header: &SceneHeader) -> Result<(), UpdateRefusal> {
        let (slot, room) = stored_scene::room_for(header)?;
        let values = WholeImage {
            length: header.length,
            checksum: header.checksum,
        };
        let begun = self.receiver.begin(room, values);
        begun.map_err(|error| refusal(error, room))?;
        self.scene = Some(slot);
        Ok(())
    }

    fn finish(&mut self, flash: &mut ImageFlash) -> Result<(), UpdateRefusal> {
        #[cfg(scene_over_line)]
        if let Some(slot) = &self.scene {
            let values = self.receiver.whole();
            let values = values.map_err(|error| refusal(error, slot.room()))?;
            stored_scene::keep_values(flash, slot, values)?;
            self.scene = None;
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
        #[cfg(scene_over_line)]
        {
            self.scene = None;
        }
        Ok(())
    }
}

impl ImageSlot for NewImage {
    type Step = UpdateStep;

    fn step(&mut self, step: &UpdateStep) -> Result<(), UpdateRefusal> {
        let mut flash = ImageFlash::take();
        match step {
            UpdateStep::Begin(header) => self.begin(header),
            UpdateStep::BeginScene(header) => self.begin_scene(header),
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
            #[cfg(not(scene_over_line))]
            scene: None,
            #[cfg(scene_over_line)]
            scene: Some(stored_scene::ROOM),
        })
    }
}

/// Refusal of what has at most `longest` bytes.
fn refusal(error: ReceiveError, longest: u32) -> UpdateRefusal {
    match error {
        ReceiveError::Length => UpdateRefusal::Length { longest },
        ReceiveError::NotBegun => UpdateRefusal::NotBegun,
        ReceiveError::Offset { expected } => UpdateRefusal::Block { expected },
        ReceiveError::Checksum { found } => UpdateRefusal::Checksum { found },
        ReceiveError::Journal(JournalError::Full) => UpdateRefusal::JournalFull,
        ReceiveError::Journal(JournalError::Flash(error)) => flash_refusal(error),
    }
}

pub(crate) fn flash_refusal(FlashError { place, status }: FlashError) -> UpdateRefusal {
    UpdateRefusal::Flash { place, status }
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
