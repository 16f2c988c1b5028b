//! From a message to its frame.

use super::checksum_behind;
use cobs::{EncoderState, PushResult};
use core::fmt;
use postcard::ser_flavors::Flavor;
use serde::Serialize;

/// The buffer does not hold the frame, or the message has no length that is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferTooSmall {
    /// Capacity of the buffer, bytes.
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
    let length = postcard::serialize_with_flavor(message, FrameFlavor::new(buffer));
    length
        .ok()
        .and_then(|length| buffer.get(..length))
        .ok_or(BufferTooSmall { bytes })
}

/// The checksum in the frame of `message`, for who hands messages over without a line; none where
/// the message has no length that is known beforehand.
pub fn checksum<T>(message: &T) -> Option<u32>
where
    T: Serialize + ?Sized,
{
    postcard::serialize_with_flavor(message, ChecksumFlavor(0)).ok()
}

/// A message that is written nowhere.
struct ChecksumFlavor(u32);

impl Flavor for ChecksumFlavor {
    type Output = u32;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0 = checksum_behind(self.0, &[byte]);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<u32> {
        Ok(self.0)
    }
}

/// A frame as it is written: the checksum sees the message's bytes, COBS sees both.
///
/// All of it is `inline` to be compiled in the crate that sends, which is for size where flash is short.
/// Whether there is room shows at the end, not at each byte: a test behind each field of each
/// message would be half of what the encoder takes in flash.
struct FrameFlavor<'b> {
    buffer: &'b mut [u8],
    /// Bytes of the frame so far, those included for which there was no room.
    length: usize,
    cobs: EncoderState,
    checksum: u32,
}

impl<'b> FrameFlavor<'b> {
    #[inline]
    fn new(buffer: &'b mut [u8]) -> Self {
        Self {
            buffer,
            // COBS begins with the length of its first block, which is not known yet.
            length: 1,
            cobs: EncoderState::default(),
            checksum: 0,
        }
    }

    #[inline]
    fn write(&mut self, at: usize, byte: u8) {
        if let Some(place) = self.buffer.get_mut(at) {
            *place = byte;
        }
    }

    #[inline]
    fn append(&mut self, byte: u8) {
        self.write(self.length, byte);
        self.length = self.length.saturating_add(1);
    }

    #[inline]
    fn stuff(&mut self, byte: u8) {
        match self.cobs.push(byte) {
            PushResult::AddSingle(byte) => self.append(byte),
            PushResult::ModifyFromStartAndSkip((block, length)) => {
                self.write(block, length);
                self.append(0);
            }
            PushResult::ModifyFromStartAndPushAndSkip((block, length, byte)) => {
                self.write(block, length);
                self.append(byte);
                self.append(0);
            }
        }
    }

    #[inline]
    fn extend(&mut self, bytes: &[u8]) {
        self.checksum = checksum_behind(self.checksum, bytes);
        bytes.iter().for_each(|byte| self.stuff(*byte));
    }
}

impl Flavor for FrameFlavor<'_> {
    /// The length of the frame, which may be more than there is room for.
    type Output = usize;

    #[inline]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.extend(&[byte]);
        Ok(())
    }

    #[inline]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.extend(bytes);
        Ok(())
    }

    #[inline]
    fn finalize(mut self) -> postcard::Result<usize> {
        for byte in self.checksum.to_le_bytes() {
            self.stuff(byte);
        }
        let (block, length) = self.cobs.clone().finalize();
        self.write(block, length);
        self.append(0);
        Ok(self.length)
    }
}
