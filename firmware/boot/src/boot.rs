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
    /// None: the known one is damaged, and there is no whole copy of it.
    Nothing,
}

/// Stages from a request to the start of a program that was taken back, with two to spare.
const STEPS: usize = 8;

/// Carries out what is left of an update. The program may be started then, unless [there is none](Started::Nothing): its checksum was
/// compared with the one in the journal. One that is damaged is replaced by a copy of itself. A journal without a checksum, as of a board that was
/// never updated, lets any program start.
///
/// # Errors
/// The flash fails where neither the new program nor the old one can be put in place. To be tried again.
pub fn boot<F: Flash>(flash: &mut F, layout: &Layout) -> Result<Started, JournalError> {
    for _ in 0..STEPS {
        let next = match journal::stage(flash, layout) {
            Stage::Requested(image) => {
                let before = of_last(flash, layout, Stage::settled);
                // The program is not touched before its copy is whole.
                let is_ready = is_whole(flash, &layout.new, image)
                    && is_intact(flash, &layout.program, before)
                    && is_readable(flash, &layout.program)
                    && copy(flash, &layout.program, &layout.old).is_ok();
                match is_ready {
                    true => Stage::Saved(content(flash, &layout.old)),
                    false => Stage::Reverted(before),
                }
            }
            Stage::Saved(_) => {
                let new = of_last(flash, layout, |stage| match stage {
                    Stage::Requested(image) => Some(image),
                    _ => None,
                });
                match copy(flash, &layout.new, &layout.program) {
                    Ok(()) => Stage::Installed(new),
                    // As a trial that has failed.
                    Err(_) => Stage::OnTrial(new),
                }
            }
            Stage::Installed(image) => {
                append(flash, layout, Stage::OnTrial(image))?;
                return Ok(Started::OnTrial);
            }
            Stage::OnTrial(_) => {
                copy(flash, &layout.old, &layout.program)?;
                Stage::Reverted(of_last(flash, layout, |stage| match stage {
                    Stage::Saved(image) => Some(image),
                    _ => None,
                }))
            }
            settled => {
                let image = settled.settled().unwrap_or(WholeImage::UNKNOWN);
                let started = mend(flash, layout, image)?;
                journal::make_room(flash, layout, settled)?;
                return Ok(started);
            }
        };
        append(flash, layout, next)?;
    }
    Ok(Started::Known)
}

/// Image of the last stage in which `look` finds one.
fn of_last<F: Flash>(
    flash: &F,
    layout: &Layout,
    look: impl Fn(Stage) -> Option<WholeImage>,
) -> WholeImage {
    journal::last(flash, layout, look).unwrap_or(WholeImage::UNKNOWN)
}

/// Puts a copy in place of a program that is damaged. The image that has come over the line, and the program before it, stay in their slots.
fn mend<F: Flash>(
    flash: &mut F,
    layout: &Layout,
    image: WholeImage,
) -> Result<Started, FlashError> {
    if is_intact(flash, &layout.program, image) {
        return Ok(Started::Known);
    }
    for slot in [&layout.new, &layout.old] {
        if is_whole(flash, slot, image) {
            copy(flash, slot, &layout.program)?;
            return Ok(Started::Known);
        }
    }
    Ok(Started::Nothing)
}

/// Returns true if the slot holds the image, or nothing is known of it.
fn is_intact<F: Flash>(flash: &F, slot: &Slot, image: WholeImage) -> bool {
    image == WholeImage::UNKNOWN || is_whole(flash, slot, image)
}

/// Content of a slot up to its last unit that is not erased.
fn content<F: Flash>(flash: &F, slot: &Slot) -> WholeImage {
    let mut image = WholeImage::UNKNOWN;
    let (mut length, mut sum) = (0, 0);
    for address in slot.units::<F::Unit>(slot.bytes()) {
        let unit = flash.unit(address).unwrap_or(F::Unit::ERASED);
        sum = checksum_behind(sum, unit.bytes().as_ref());
        length += F::Unit::BYTES;
        if unit != F::Unit::ERASED {
            image = WholeImage {
                length,
                checksum: sum,
            };
        }
    }
    image
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
