//! From a message to its frame.

use super::CRC;
use core::fmt;
use crc::{Digest, Table};
use postcard::ser_flavors::{Cobs, Flavor, Slice};
use serde::Serialize;

/// The buffer does not hold the frame, or the message has no length that is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferTooSmall {
    /// What the buffer holds, bytes.
    pub bytes: usize,
}

impl fmt::Display for BufferTooSmall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the message's frame is longer than {} bytes", self.bytes)
    }
}

impl core::error::Error for BufferTooSmall {}

/// Writes the frame of `message` to the start of `buffer` and returns it, its zero included.
/// [`frame_length`](super::frame_length) says how long it can be.
///
/// # Errors
/// [`BufferTooSmall`].
#[inline(never)]
pub fn encode<'b, T>(message: &T, buffer: &'b mut [u8]) -> Result<&'b [u8], BufferTooSmall>
where
    T: Serialize + ?Sized,
{
    let bytes = buffer.len();
    let refused = |_| BufferTooSmall { bytes };
    let frame = Frame {
        cobs: Cobs::try_new(Slice::new(buffer)).map_err(refused)?,
        checksum: CRC.digest(),
    };
    postcard::serialize_with_flavor(message, frame)
        .map(|frame| &*frame)
        .map_err(refused)
}

/// A frame as it is written: the checksum sees the message's bytes, COBS sees both.
struct Frame<'b> {
    cobs: Cobs<Slice<'b>>,
    checksum: Digest<'static, u32, Table<1>>,
}

impl<'b> Flavor for Frame<'b> {
    type Output = &'b mut [u8];

    // A call for each byte and not its whole code at each field of each message: that is tens of
    // KiB of flash.
    #[inline(never)]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.checksum.update(&[byte]);
        self.cobs.try_push(byte)
    }

    #[inline(never)]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        bytes.iter().try_for_each(|byte| self.try_push(*byte))
    }

    fn finalize(mut self) -> postcard::Result<Self::Output> {
        for byte in self.checksum.finalize().to_le_bytes() {
            self.cobs.try_push(byte)?;
        }
        self.cobs.finalize()
    }
}
