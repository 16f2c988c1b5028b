//! From bytes to messages.

use super::{CHECKSUM_BYTES, Counters, FrameError, checksum_behind};
use cobs::{DecodeResult, DecoderState};
use postcard::Deserializer;
use postcard::de_flavors::Flavor;
use serde::de::DeserializeOwned;

/// Finds the frames in whatever a line delivers, in pieces of any size, and takes the messages out
/// of them. `N`: most bytes of a message and its checksum,
/// [`decoded_length`](super::decoded_length).
///
/// Work per byte is bounded, and so is the work at the end of a frame, by `N`. After any damage
/// the next zero makes it listen again; a line that carries noise for hours costs counters.
#[derive(Debug)]
pub struct Decoder<const N: usize> {
    /// The frame so far, COBS undone.
    bytes: [u8; N],
    length: usize,
    cobs: DecoderState,
    /// A byte of the frame has come.
    started: bool,
    /// The frame is too long: nothing of it counts any more.
    skipping: bool,
    counters: Counters,
    checksum: u32,
}

impl<const N: usize> Default for Decoder<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Decoder<N> {
    /// A decoder that has heard nothing.
    pub const fn new() -> Self {
        Self {
            bytes: [0; N],
            length: 0,
            cobs: DecoderState::Idle,
            started: false,
            skipping: false,
            counters: Counters::ZERO,
            checksum: 0,
        }
    }

    /// Returns the counts of the frames that came so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Checksum of the message that was taken last; of no meaning after a frame that was none.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// Forgets the frame that is being received, as when a line is opened anew. Counters stay.
    pub fn reset(&mut self) {
        self.length = 0;
        self.cobs = DecoderState::Idle;
        self.started = false;
        self.skipping = false;
    }

    /// Takes bytes from the front of `line` up to the end of the first frame, and that frame's
    /// message. `None`: all bytes are taken and the frame goes on. Call it until then.
    pub fn take<T: DeserializeOwned>(&mut self, line: &mut &[u8]) -> Option<Result<T, FrameError>> {
        while let Some((&byte, rest)) = line.split_first() {
            *line = rest;
            let frame = self.feed(byte);
            if frame.is_some() {
                return frame;
            }
        }
        None
    }

    /// Takes one byte. When it ends a frame: that frame's message.
    pub fn feed<T: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<T, FrameError>> {
        if byte != 0 {
            self.append(byte);
            return None;
        }
        let frame = self.payload().and_then(message);
        self.reset();
        self.counters.count(&frame);
        Some(frame)
    }

    /// Takes one byte that is not zero.
    #[inline(never)]
    fn append(&mut self, byte: u8) {
        self.started = true;
        if self.skipping {
            return;
        }
        if let Ok(DecodeResult::DataContinue(byte)) = self.cobs.feed(byte) {
            match self.bytes.get_mut(self.length) {
                Some(next) => {
                    *next = byte;
                    self.length += 1;
                }
                None => self.skipping = true,
            }
        }
    }

    /// The bytes of the message in the frame that a zero has ended.
    #[inline(never)]
    fn payload(&mut self) -> Result<&[u8], FrameError> {
        if !self.started {
            return Err(FrameError::Empty);
        }
        if self.skipping {
            return Err(FrameError::TooLong);
        }
        let Ok(DecodeResult::DataComplete) = self.cobs.feed(0) else {
            return Err(FrameError::Stuffing);
        };
        let bytes = self.bytes.get(..self.length).unwrap_or_default();
        match bytes.split_last_chunk::<CHECKSUM_BYTES>() {
            None | Some(([], _)) => Err(FrameError::Truncated),
            Some((message, checksum)) => {
                self.checksum = checksum_behind(0, message);
                match self.checksum == u32::from_le_bytes(*checksum) {
                    true => Ok(message),
                    false => Err(FrameError::Checksum),
                }
            }
        }
    }
}

/// The message in `bytes`, all of them.
#[inline(never)]
fn message<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, FrameError> {
    let mut bytes = Deserializer::from_flavor(Bytes(bytes));
    match (T::deserialize(&mut bytes), bytes.finalize()) {
        (Ok(message), Ok([])) => Ok(message),
        (Ok(_), _) => Err(FrameError::Trailing),
        (Err(_), _) => Err(FrameError::Message),
    }
}

/// Bytes that are left of a message as it is read.
struct Bytes<'de>(&'de [u8]);

impl<'de> Flavor<'de> for Bytes<'de> {
    type Remainder = &'de [u8];
    type Source = &'de [u8];

    // `inline` to be compiled in the crate that receives, as in `encode`.
    #[inline]
    fn pop(&mut self) -> postcard::Result<u8> {
        let (first, rest) = self.0.split_first().ok_or(END)?;
        self.0 = rest;
        Ok(*first)
    }

    // As a part of whoever calls it, for there the length is known.
    #[inline(always)]
    fn try_take_n(&mut self, count: usize) -> postcard::Result<&'de [u8]> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(END)?;
        self.0 = rest;
        Ok(taken)
    }

    #[inline]
    fn finalize(self) -> postcard::Result<Self::Remainder> {
        Ok(self.0)
    }
}

const END: postcard::Error = postcard::Error::DeserializeUnexpectedEnd;
