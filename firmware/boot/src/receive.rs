//! Image, or other content, that comes over the line, block by block.

use crate::flash::program_unit;
use crate::journal::{self, JournalError, WholeImage};
use crate::{Flash, FlashError, FlashUnit, Layout, Slot, checksum_behind};

/// Reason for which a part of an image is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReceiveError {
    /// The image is empty, or longer than its room.
    Length,
    /// No image was begun.
    NotBegun,
    /// The block is not the next, is empty, or goes beyond the image. Only the last may have a length that is no multiple of a
    /// unit's.
    Offset {
        /// Offset of the next block.
        expected: u32,
    },
    /// The image has another checksum than its beginning said.
    Checksum {
        /// Checksum of the bytes in the flash.
        found: u32,
    },
    /// The journal.
    Journal(JournalError),
}

impl From<FlashError> for ReceiveError {
    fn from(error: FlashError) -> Self {
        Self::Journal(JournalError::Flash(error))
    }
}

/// Image that comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Receiver {
    image: Option<WholeImage>,
    /// Bytes that are in the flash, and their checksum.
    received: u32,
    sum: u32,
}

impl Receiver {
    /// No image.
    pub const NONE: Self = Self {
        image: None,
        received: 0,
        sum: 0,
    };

    /// The image that comes.
    pub fn image(&self) -> Option<WholeImage> {
        self.image
    }

    /// Bytes that are in the flash: the offset of the next block.
    pub fn received(&self) -> u32 {
        self.received
    }

    /// Begins an image of at most `room` bytes. One that is under way is dropped. Writes nothing.
    ///
    /// # Errors
    /// No image, or a longer one.
    pub fn begin(&mut self, room: u32, image: WholeImage) -> Result<(), ReceiveError> {
        if image.length == 0 || image.length > room {
            return Err(ReceiveError::Length);
        }
        *self = Self {
            image: Some(image),
            ..Self::NONE
        };
        Ok(())
    }

    /// Takes the next block into `slot`, the same for all blocks. Erases each of its sectors as the first byte of it comes.
    ///
    /// # Errors
    /// Another block than the next. A flash that fails: then the image is to be begun again.
    pub fn block<F: Flash>(
        &mut self,
        flash: &mut F,
        slot: &Slot,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), ReceiveError> {
        let image = self.image.ok_or(ReceiveError::NotBegun)?;
        let left = image.length - self.received;
        let length = bytes.len() as u32;
        let is_last = length == left;
        if offset != self.received
            || length == 0
            || length > left
            || !(is_last || length.is_multiple_of(F::Unit::BYTES))
        {
            return Err(ReceiveError::Offset {
                expected: self.received,
            });
        }
        let mut sum = self.sum;
        let parts = bytes.chunks(F::Unit::BYTES as usize);
        for (place, part) in (offset..).step_by(F::Unit::BYTES as usize).zip(parts) {
            if place.is_multiple_of(slot.sector_bytes) {
                flash.erase(slot.first_sector + (place / slot.sector_bytes) as u8)?;
            }
            // Compares: the checksum is of what is in the flash, not of what came.
            program_unit(flash, slot.start + place, F::Unit::of_bytes(part))?;
            sum = checksum_behind(sum, part);
        }
        self.sum = sum;
        self.received += length;
        Ok(())
    }

    /// Ends the image: compares its checksum, and asks the boot loader for it.
    ///
    /// # Errors
    /// Bytes are missing, the checksum is another, or the journal has no room.
    pub fn finish<F: Flash>(&mut self, flash: &mut F, layout: &Layout) -> Result<(), ReceiveError> {
        let image = self.whole()?;
        journal::request(flash, layout, image).map_err(ReceiveError::Journal)
    }

    /// Ends what comes, of an image or not: compares its checksum.
    ///
    /// # Errors
    /// Bytes are missing, or the checksum is another.
    pub fn whole(&mut self) -> Result<WholeImage, ReceiveError> {
        let image = self.image.ok_or(ReceiveError::NotBegun)?;
        if self.received != image.length {
            return Err(ReceiveError::Offset {
                expected: self.received,
            });
        }
        let found = self.sum;
        *self = Self::NONE;
        if found != image.checksum {
            return Err(ReceiveError::Checksum { found });
        }
        Ok(image)
    }
}
