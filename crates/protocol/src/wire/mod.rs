//! Messages as bytes on a line: postcard, a CRC-32, COBS, a zero.
//!
//! ```text
//! message ──postcard──> bytes ──CRC-32──> bytes, 4 checksum bytes ──COBS──> no zeros ──> 0
//! ```
//! The zero ends a frame and stands nowhere else, so that whoever listens finds the start of the
//! next frame after any damage. `docs/wire.md` is the specification, for other languages.
//!
//! Nothing here knows what the messages say: [`encode`] takes whatever can be serialised,
//! [`Decoder`] gives whatever is asked for. Neither allocates nor panics; what is on the line can
//! only change counters.
//!
//! ```
//! use trirrr_protocol::wire::{Decoder, encode};
//!
//! let mut frame = [0; 32];
//! let frame = encode(&(7u32, -0.5f32), &mut frame)?;
//!
//! let mut decoder = Decoder::<16>::new();
//! let mut line = frame as &[u8];
//! assert_eq!(decoder.take(&mut line), Some(Ok((7u32, -0.5f32))));
//! assert!(line.is_empty());
//! # Ok::<(), trirrr_protocol::wire::BufferTooSmall>(())
//! ```

mod content;
mod decoder;
mod encode;
mod error;
pub mod schema;
#[cfg(test)]
mod tests;

pub use content::{of_bytes, to_bytes};
pub use decoder::Decoder;
pub use encode::{BufferTooSmall, checksum, encode};
pub use error::{Counters, FrameError};

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// CRC-32/ISO-HDLC, the one of Ethernet and zlib: polynomial 0x04C11DB7, reflected, starting from
/// and inverted with 0xFFFFFFFF; the check value of "123456789" is 0xCBF43926.
///
/// Bit by bit: a table would be a KiB of flash, to save a few dozen instructions a byte in what runs
/// below the tick and waits for the line anyway.
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The checksum of the bytes whose checksum is `before` and of `bytes` behind them; that of no bytes is
/// 0. So a checksum under way is a number, and the algorithm a constant of the code.
#[inline]
fn checksum_behind(before: u32, bytes: &[u8]) -> u32 {
    // What a checksum starts from is neither inverted nor reflected.
    let mut digest = CRC.digest_with_initial((!before).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

/// Checksum of `bytes`, that of frames.
pub fn checksum_of_bytes(bytes: &[u8]) -> u32 {
    checksum_behind(0, bytes)
}

/// Bytes of the checksum, least significant first.
const CHECKSUM_BYTES: usize = 4;

/// Bytes that a decoder must hold for messages of up to `message` bytes.
pub const fn decoded_length(message: usize) -> usize {
    message + CHECKSUM_BYTES
}

/// Most bytes of the frame of a message of up to `message` bytes, its zero included.
pub const fn frame_length(message: usize) -> usize {
    cobs::max_encoding_length(decoded_length(message)) + 1
}
