//! Line to the host: bytes to requests, messages to frames.

use crate::service::{Message, MessageRef, Request};
use embedded_hal_nb::serial::Write;
use heapless::spsc::Consumer;
use trirrr_protocol::wire::schema::longest;
use trirrr_protocol::wire::{Decoder, decoded_length, encode, frame_length};

/// Baud rate of the line.
pub const BAUD: u32 = 921_600;
/// Baud rate of the log.
pub const LOG_BAUD: u32 = 115_200;

/// Places of the queue from the line's interrupt to the background; one stays empty. At 921,600 baud they
/// last for 2.7 ms.
pub const RECEIVED: usize = 256;

/// Background's end of that queue.
pub(crate) type Received = Consumer<'static, u8>;

/// Longest request with its checksum, bytes.
const REQUEST: usize = decoded_length(longest::<Request>());

/// Longest frame of a message, bytes.
const FRAME: usize = frame_length(longest::<Message>());

/// Both directions of the line, above the hardware.
pub(crate) struct Line {
    received: Received,
    decoder: Decoder<REQUEST>,
    frame: [u8; FRAME],
    /// Bytes of the frame that are sent, then all of its bytes.
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

    /// Takes the next request and its checksum out of the received bytes. Drops damaged frames: the host
    /// repeats them.
    pub(crate) fn request(&mut self) -> Option<(Request, u32)> {
        while let Some(byte) = self.received.dequeue() {
            if let Some(Ok(request)) = self.decoder.feed(byte) {
                return Some((request, self.decoder.checksum()));
            }
        }
        None
    }

    /// Returns `true` once the last message is sent.
    pub(crate) fn is_free(&self) -> bool {
        self.sent == self.length
    }

    /// Encodes `message` to be sent. Only while the line [is free](Line::is_free).
    pub(crate) fn put(&mut self, message: &MessageRef) {
        self.sent = 0;
        // Always fits: the room follows from the type of the message.
        self.length = encode(message, &mut self.frame).map_or(0, <[u8]>::len);
    }

    /// Hands bytes to the hardware until it would have to wait.
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
