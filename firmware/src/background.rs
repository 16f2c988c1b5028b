//! What is done below the tick, a bounded slice at a time.

use crate::line::{Line, Received};
use crate::station;
use embedded_hal_nb::serial::Write;
use trirrr_core::message::Message;

/// The half of the service that talks, and the line it talks over.
pub(crate) struct Background<W> {
    service: station::Background,
    line: Line<W>,
}

impl<W: Write<u8>> Background<W> {
    pub(crate) fn new(service: station::Background, received: Received, transmitter: W) -> Self {
        Self {
            service,
            line: Line::new(received, transmitter),
        }
    }

    /// A slice: answers a request or says what there is to say, and judges a part of a move.
    /// Whether there is more to do at once.
    pub(crate) fn step(&mut self) -> bool {
        self.line.send();
        if self.line.is_free()
            && let Some(message) = self.message()
        {
            self.line.put(&message);
        }
        let judging = self.service.step();
        judging || !self.line.is_free() || self.line.has_received()
    }

    /// Replies first, then events, then telemetry.
    fn message(&mut self) -> Option<Message<crate::scene::Scalar>> {
        match self.line.request() {
            Some(request) => Some(Message::Reply {
                sequence: request.sequence,
                reply: self.service.receive(&request),
            }),
            None => self.service.outgoing(),
        }
    }
}
