//! Messages of both sides as bytes of a link.

use serde::Serialize;
use serde::de::DeserializeOwned;
use trirrr_protocol::message::{Message, Request};
use trirrr_protocol::wire::schema::longest;
use trirrr_protocol::wire::{Counters, Decoder, decoded_length, encode, frame_length};

/// Most bytes of a message of either side: no number type takes more than binary64.
pub(crate) const MESSAGE_BYTES: usize = {
    let (request, message) = (longest::<Request<f64>>(), longest::<Message<f64>>());
    if request > message { request } else { message }
};

/// Most bytes of a frame of either side.
const FRAME_BYTES: usize = frame_length(MESSAGE_BYTES);

/// Frames of one link, in both directions.
#[derive(Debug, Default)]
pub struct Frames {
    decoder: Decoder<{ decoded_length(MESSAGE_BYTES) }>,
}

impl Frames {
    /// Appends the frame of `message` to `bytes`.
    pub fn append<T: Serialize>(message: &T, bytes: &mut Vec<u8>) {
        let start = bytes.len();
        bytes.resize(start + FRAME_BYTES, 0);
        // The greatest length follows from the types of the messages: every message fits.
        let length = encode(message, &mut bytes[start..]).map_or(0, <[u8]>::len);
        debug_assert!(length > 0);
        bytes.truncate(start + length);
    }

    /// Hands every message in `line` to `take`. Frames that are damaged or cut off are counted and
    /// dropped.
    pub fn receive<T: DeserializeOwned>(&mut self, mut line: &[u8], mut take: impl FnMut(T)) {
        while let Some(frame) = self.decoder.take(&mut line) {
            if let Ok(message) = frame {
                take(message);
            }
        }
    }

    /// Returns the counters of the frames that came.
    pub fn counters(&self) -> Counters {
        self.decoder.counters()
    }
}
