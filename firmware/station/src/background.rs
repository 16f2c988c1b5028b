//! What is done below the tick, a bounded slice at a time.

use crate::line::{Line, Received};
use crate::scene::Scalar;
use crate::service::{self, MessageRef};
use embedded_hal_nb::serial::Write;
use trirrr_protocol::message::Event;

/// The half of the service that talks, and the line it talks over.
pub struct Background {
    service: service::Background,
    line: Line,
}

impl Background {
    pub(crate) fn new(service: service::Background, received: Received) -> Self {
        Self {
            service,
            line: Line::new(received),
        }
    }

    /// Gives the line what its hardware takes without waiting.
    pub fn send(&mut self, transmitter: &mut impl Write<u8>) {
        self.line.send(transmitter);
    }

    /// A slice: answers a request or says what there is to say, judges a part of a move.
    // A call, for the same reason as that of `build`.
    #[inline(never)]
    pub fn step(&mut self) {
        if self.line.is_free() {
            self.speak();
        }
        self.service.step();
    }

    /// Replies first, then events, then telemetry.
    fn speak(&mut self) {
        if let Some((request, checksum)) = self.line.request() {
            self.line.put(&MessageRef::Reply {
                sequence: request.sequence,
                reply: &self.service.receive(&request, checksum),
            });
            return;
        }
        self.service.send_next(|message| {
            if let MessageRef::Event(event) = message {
                note(event);
            }
            self.line.put(message);
        });
    }
}

/// What happened, for the log.
fn note(event: &Event<Scalar>) {
    match event {
        Event::Verdict(verdict) if verdict.violation.is_some() => {
            defmt::warn!("move {=u32} is not admitted", verdict.number);
        }
        Event::Verdict(_) => {}
        // By their places in docs/wire.md.
        Event::State { state, done, .. } => {
            defmt::info!("state {=u8}, {=u32} moves done", *state as u8, done);
        }
        Event::Fault(fault) => defmt::error!("fault in tick {=u32}", fault.tick),
    }
}
