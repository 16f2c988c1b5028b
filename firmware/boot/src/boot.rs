//! Start of the board: what is left of an update, then the program.

use crate::flash::program_unit;
use crate::journal::{self, JournalError, Stage, WholeImage, append};
use crate::{Flash, FlashError, FlashUnit, Layout, Slot, checksum_behind};

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
                    && is_readable(flash, &layout.program)
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
    for address in slot.units::<F::Unit>(image.length) {
        let Some(unit) = flash.unit(address) else {
            return false;
        };
        let bytes = unit.bytes();
        let bytes = bytes.as_ref();
        let count = left.min(F::Unit::BYTES);
        sum = checksum_behind(sum, bytes.get(..count as usize).unwrap_or(bytes));
        left -= count;
    }
    left == 0 && image.length > 0 && sum == image.checksum
}

/// Returns true if no content of the slot is lost.
fn is_readable<F: Flash>(flash: &F, slot: &Slot) -> bool {
    let mut units = slot.units::<F::Unit>(slot.bytes());
    units.all(|address| flash.unit(address).is_some())
}

/// Copies a slot, and compares. Lost content is no part of an image whose checksum was compared: it lies behind its end, left by an image
/// that did not come to its own. It stays erased in the copy.
fn copy<F: Flash>(flash: &mut F, from: &Slot, to: &Slot) -> Result<(), FlashError> {
    for sector in to.sectors() {
        flash.erase(sector)?;
    }
    let places = from.units::<F::Unit>(from.bytes());
    for (from, to) in places.zip(to.units::<F::Unit>(to.bytes())) {
        let unit = flash.unit(from).unwrap_or(F::Unit::ERASED);
        program_unit(flash, to, unit)?;
    }
    Ok(())
}
