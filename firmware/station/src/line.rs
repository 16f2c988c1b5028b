//! The line to the host: requests out of bytes, frames out of messages.

use crate::service::{Message, MessageRef, Request};
use embedded_hal_nb::serial::Write;
use heapless::spsc::Consumer;
use trirrr_protocol::wire::schema::longest;
use trirrr_protocol::wire::{Decoder, decoded_length, encode, frame_length};

/// Bits per second on the line.
pub const BAUD: u32 = 921_600;
/// Bits per second on the log's.
pub const LOG_BAUD: u32 = 115_200;

/// Bytes that may wait between the interrupt and the background, and one place that stays empty:
/// what 921,600 baud bring in 2.7 ms.
pub const RECEIVED: usize = 256;

/// The queue from the interrupt.
pub type Received = Consumer<'static, u8>;

/// Most bytes of a request with its checksum.
const REQUEST: usize = decoded_length(longest::<Request>());

/// Most bytes of the frame of a message.
const FRAME: usize = frame_length(longest::<Message>());

/// Both directions of the line, above the hardware.
pub(crate) struct Line {
    received: Received,
    decoder: Decoder<REQUEST>,
    frame: [u8; FRAME],
    /// Bytes of the frame that are sent, and all that it has.
    sent: usize,
    length: usize,
}

impl Line {
    pub(crate) fn new(received: Received) -> Self {
        Self {
            received,
            decoder: Decoder::new(),
            frame: [0; FRAME],
            sent: 0,
            length: 0,
        }
    }

    /// The next request, from the bytes that have come so far, and its checksum. Damaged frames are
    /// dropped: the host asks again.
    pub(crate) fn request(&mut self) -> Option<(Request, u32)> {
        while let Some(byte) = self.received.dequeue() {
            if let Some(Ok(request)) = self.decoder.feed(byte) {
                return Some((request, self.decoder.checksum()));
            }
        }
        None
    }

    /// Whether the last message is on its way and the next one can be put.
    pub(crate) fn is_free(&self) -> bool {
        self.sent == self.length
    }

    /// Makes `message` the next to be sent. Only when the line [is free](Line::is_free).
    pub(crate) fn put(&mut self, message: &MessageRef) {
        self.sent = 0;
        // The frame has room for any message: its length follows from the type.
        self.length = encode(message, &mut self.frame).map_or(0, <[u8]>::len);
    }

    /// Gives the hardware what it takes without waiting.
    pub(crate) fn send(&mut self, transmitter: &mut impl Write<u8>) {
        while let Some(&byte) = self
            .frame
            .get(self.sent..self.length)
            .and_then(<[u8]>::first)
        {
            if transmitter.write(byte).is_err() {
                return;
            }
            self.sent += 1;
        }
    }
}
