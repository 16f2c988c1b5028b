//! Update of a machine's program over the line, and of the scene of a program that takes one.

use super::board::Firmware;
use super::scene_types::{SceneHeader, SceneNeed, SceneRoom};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::machine::Quantity;

/// Bytes in a row of an [`ImageBlock`].
const ROW: usize = 32;

/// Most bytes of an [`ImageBlock`].
pub const BLOCK: usize = 4 * ROW;

/// Mark in an image, behind which the build of the image lies as a [`Firmware`].
pub const IMAGE_MARK: &[u8; 16] = b"trirrr image v1:";

/// Step of an update of the program. An image without updates answers `NoUpdate` and does not read the content. The
/// machine takes each step in [`Disabled`](super::State::Disabled).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(clippy::large_enum_variant)] // a block is the largest and the most frequent
pub enum UpdateStep {
    /// Announces an image. One that is under way is dropped. Nothing is written.
    Begin(ImageHeader),
    /// Brings bytes of it.
    Block(ImageBlock),
    /// Ends it: the machine compares its checksum, and installs it at the next start. Values of a scene are checked, and taken at the
    /// next start.
    Finish,
    /// Starts the machine anew, a tenth of a second after the answer.
    Restart,
    /// Announces values of a scene that comes over the line, of which blocks come and an end as of an image. What is
    /// under way is dropped. Nothing is written.
    BeginScene(SceneHeader),
}

/// Description of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ImageHeader {
    /// Address of its first byte.
    pub start: u32,
    /// Bytes.
    pub length: u32,
    /// CRC-32 of the bytes, that of the frames.
    pub checksum: u32,
    /// Build of the image. Board and chip have to be those of the machine.
    pub firmware: Firmware,
}

/// Bytes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ImageBlock {
    /// Place of the first byte in the image: behind the bytes that the machine has.
    pub offset: u32,
    /// Bytes of the block, 1 to [`BLOCK`]; a multiple of 8, but in the last block.
    pub count: u8,
    /// The bytes, zeros behind them.
    pub bytes: [[u8; ROW]; BLOCK / ROW],
}

impl ImageBlock {
    /// Block of as many of `bytes` as fit.
    pub fn new(offset: u32, bytes: &[u8]) -> Self {
        let mut block = Self {
            offset,
            count: bytes.len().min(BLOCK) as u8,
            bytes: [[0; ROW]; BLOCK / ROW],
        };
        for (place, byte) in block.bytes.as_flattened_mut().iter_mut().zip(bytes) {
            *place = *byte;
        }
        block
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        let all = self.bytes.as_flattened();
        all.get(..usize::from(self.count)).unwrap_or(all)
    }
}

/// Update as a machine has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct UpdateStatus {
    /// Address of the first byte of an image.
    pub start: u32,
    /// Most bytes of an image.
    pub room: u32,
    /// Checksum of the image, or of the values of a scene, that are under way.
    pub coming: Option<u32>,
    /// Bytes of it that the machine has: offset of the next block.
    pub received: u32,
    /// Outcome of the last update.
    pub outcome: UpdateOutcome,
    /// Room for a scene that comes over the line; none in an image that takes none.
    pub scene: Option<SceneRoom>,
}

/// Outcome of an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum UpdateOutcome {
    /// There was none.
    Never,
    /// The image is whole, and is installed at the next start.
    Requested,
    /// The new program runs, and goes at the next start.
    OnTrial,
    /// The new program runs.
    Confirmed,
    /// The old program runs: the new one failed, or no host talked to it.
    Reverted,
}

/// Reason for which a step of an update was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum UpdateRefusal {
    /// The image is for another board.
    Board,
    /// The image is for another chip.
    Chip,
    /// The image begins at another address.
    Start {
        /// Address of the first byte of an image.
        expected: u32,
    },
    /// The image is empty or too long.
    Length {
        /// Most bytes.
        longest: u32,
    },
    /// No image was begun.
    NotBegun,
    /// The block is not the next, or has a wrong length; or bytes are missing at the end.
    Block {
        /// Offset of the next block.
        expected: u32,
    },
    /// The bytes in the flash have another checksum.
    Checksum {
        /// Checksum of the bytes in the flash.
        found: u32,
    },
    /// The flash cannot be written.
    Flash {
        /// Address, or number of the sector.
        place: u32,
        /// Status of the flash, as the chip has it.
        status: u32,
    },
    /// The journal of updates has no room before the next start.
    JournalFull,
    /// The image takes no scene over the line.
    NoScene,
    /// The values of the scene have another layout, or are none.
    SceneLayout,
    /// The types of the image lack a part that the scene needs, the first of them.
    SceneNeeds(SceneNeed),
    /// A value of the scene is refused.
    SceneValue {
        /// Quantity that is wrong.
        quantity: Quantity,
        /// Leg that it belongs to, from 0.
        leg: Option<u8>,
    },
    /// The machine of the scene cannot stand at its start.
    SceneStart,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_takes_what_fits_and_leaves_zeros_behind() {
        let bytes: [u8; 200] = core::array::from_fn(|index| index as u8 + 1);
        assert_eq!(ImageBlock::new(7, &bytes).bytes(), &bytes[..BLOCK]);
        let short = ImageBlock::new(7, &bytes[..5]);
        assert_eq!((short.bytes(), short.offset), (&bytes[..5], 7));
        assert_eq!(short.bytes.as_flattened()[5..], [0; BLOCK - 5]);
        // A count beyond the block is cut, not trusted.
        let wrong = ImageBlock {
            count: 255,
            ..short
        };
        assert_eq!(wrong.bytes().len(), BLOCK);
    }
}
