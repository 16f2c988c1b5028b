//! From a message to its frame.

use super::CRC;
use core::fmt;
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Slice};
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
pub fn encode<'b, T>(message: &T, buffer: &'b mut [u8]) -> Result<&'b [u8], BufferTooSmall>
where
    T: Serialize + ?Sized,
{
    let bytes = buffer.len();
    let refused = |_| BufferTooSmall { bytes };
    // From the outside in: the checksum sees the message's bytes, COBS sees both.
    let cobs = Cobs::try_new(Slice::new(buffer)).map_err(refused)?;
    let checked = CrcModifier::new(cobs, CRC.digest());
    postcard::serialize_with_flavor(message, checked)
        .map(|frame| &*frame)
        .map_err(refused)
}
