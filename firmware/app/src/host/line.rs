//! Line to the host: bytes to requests, messages to frames.

use super::image_scene::{Message, MessageRef, Request};
use crate::scene::Scalar;
use embedded_hal_nb::serial::Write;
use heapless::spsc::Consumer;
use trirrr_core::number::Arithmetic;
use trirrr_protocol::message::WINDOW;
use trirrr_protocol::wire::schema::longest;
use trirrr_protocol::wire::{Decoder, decoded_length, encode, frame_length};

/// Baud rate of the line.
pub const BAUD: u32 = 921_600;

/// Receiver's end of the line.
pub trait ReceivedBytes {
    /// Takes the next byte that has come. Returns none if no further one is there.
    fn next_byte(&mut self) -> Option<u8>;
}

impl ReceivedBytes for Consumer<'static, u8> {
    fn next_byte(&mut self) -> Option<u8> {
        self.dequeue()
    }
}

/// Longest request with its checksum, bytes.
const REQUEST: usize = decoded_length(longest::<Request>());

/// Most bytes of the requests that a host has sent and has no answer to. A receiver with room for them loses none, however long the
/// background is away.
pub const IN_FLIGHT: usize = WINDOW * frame_length(longest::<Request>());

/// The image computes in fixed point.
pub const IS_FIXED: bool = !Scalar::PROPAGATES_NON_FINITE;

/// Longest frame of a message, bytes.
const FRAME: usize = frame_length(longest::<Message>());

/// Both directions of the line, above the hardware.
pub(crate) struct Line {
    decoder: Decoder<REQUEST>,
    /// Request that has come, and its checksum.
    request: Option<(Request, u32)>,
    frame: [u8; FRAME],
    /// Bytes of the frame that are sent, then all of its bytes.
    sent: usize,
    length: usize,
}

impl Line {
    pub(crate) fn new() -> Self {
        Self {
            decoder: Decoder::new(),
            request: None,
            frame: [0; FRAME],
            sent: 0,
            length: 0,
        }
    }

    /// Takes received bytes up to the end of a request.
    pub(crate) fn listen(&mut self, receiver: &mut impl ReceivedBytes) {
        while self.request.is_none()
            && let Some(byte) = receiver.next_byte()
        {
            self.hear(byte);
        }
    }

    /// Takes a byte. Drops damaged frames: the host repeats them.
    // A call: inlined, the board's crate would compile the decoder for speed.
    #[inline(never)]
    fn hear(&mut self, byte: u8) {
        if let Some(Ok(request)) = self.decoder.feed(byte) {
            self.request = Some((request, self.decoder.checksum()));
        }
    }

    /// Takes the request that has come, and its checksum.
    pub(crate) fn request(&mut self) -> Option<(Request, u32)> {
        self.request.take()
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
    #[inline(never)]
    pub(crate) fn send(&mut self, transmitter: &mut impl Write<u8>) {
        while let Some(&byte) = self
            .frame
            .get(self.sent..self.length)
            .and_then(<[u8]>::first)
        {
            if transmitter.write(byte).is_err() {
                break;
            }
            self.sent += 1;
        }
        // A transmitter with a buffer begins now.
        let _ = transmitter.flush();
    }
}
