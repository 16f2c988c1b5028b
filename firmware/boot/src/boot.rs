//! Start of the board: what is left of an update, then the program.

use crate::journal::{self, JournalError, Stage, WholeImage, append};
use crate::{Flash, FlashError, Layout, Slot, checksum_behind};

/// Program that the boot loader starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Started {
    /// One that has been confirmed, or was there from the first.
    Known,
    /// A new one. Unless it confirms itself, the next start goes back.
    OnTrial,
}

/// Stages from a request to the start of a program that was taken back, with two to spare.
const STEPS: usize = 8;

/// Carries out what is left of an update. The program may be started then.
///
/// # Errors
/// The flash fails where neither the new program nor the old one can be put in place. To be tried again.
pub fn boot<F: Flash>(flash: &mut F, layout: &Layout) -> Result<Started, JournalError> {
    for _ in 0..STEPS {
        match journal::stage(flash, layout) {
            Stage::Requested(image) => {
                // The program is not touched before its copy is whole.
                let is_ready = is_whole(flash, &layout.new, image)
                    && copy(flash, &layout.program, &layout.old).is_ok();
                append(
                    flash,
                    layout,
                    match is_ready {
                        true => Stage::Saved,
                        false => Stage::Reverted,
                    },
                )?;
            }
            Stage::Saved => {
                let next = match copy(flash, &layout.new, &layout.program) {
                    Ok(()) => Stage::Installed,
                    // As a trial that has failed.
                    Err(_) => Stage::OnTrial,
                };
                append(flash, layout, next)?;
            }
            Stage::Installed => {
                append(flash, layout, Stage::OnTrial)?;
                return Ok(Started::OnTrial);
            }
            Stage::OnTrial => {
                copy(flash, &layout.old, &layout.program)?;
                append(flash, layout, Stage::Reverted)?;
            }
            Stage::None | Stage::Confirmed | Stage::Reverted => break,
        }
    }
    if journal::stage(flash, layout).is_settled() {
        journal::make_room(flash, layout)?;
    }
    Ok(Started::Known)
}

/// Returns true if the slot holds the image.
pub(crate) fn is_whole<F: Flash>(flash: &F, slot: &Slot, image: WholeImage) -> bool {
    let mut left = image.length;
    let mut sum = 0;
    for address in slot.words(image.length) {
        let bytes = flash.word(address).to_le_bytes();
        let count = left.min(4);
        sum = checksum_behind(sum, bytes.get(..count as usize).unwrap_or(&bytes));
        left -= count;
    }
    left == 0 && image.length > 0 && sum == image.checksum
}

/// Copies a slot, and compares.
fn copy<F: Flash>(flash: &mut F, from: &Slot, to: &Slot) -> Result<(), FlashError> {
    for sector in to.sectors() {
        flash.erase(sector)?;
    }
    for (from, to) in from.words(from.bytes()).zip(to.words(to.bytes())) {
        let word = flash.word(from);
        // What is erased needs no programming.
        if word != u32::MAX {
            flash.program(to, word)?;
        }
        let copied = flash.word(to);
        if copied != word {
            return Err(FlashError {
                place: to,
                status: copied,
            });
        }
    }
    Ok(())
}
