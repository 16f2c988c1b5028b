//! What is done below the tick, a bounded slice at a time.

use crate::line::{Line, Received};
use crate::scene::Scalar;
use crate::{log, station};
use embedded_hal_nb::serial::Write;
use trirrr_core::message::{Event, Message};

/// The half of the service that talks, the line it talks over, and the port of the log.
pub(crate) struct Background<W, L> {
    service: station::Background,
    line: Line<W>,
    log: L,
}

impl<W: Write<u8>, L: Write<u8>> Background<W, L> {
    pub(crate) fn new(
        service: station::Background,
        received: Received,
        transmitter: W,
        log: L,
    ) -> Self {
        Self {
            service,
            line: Line::new(received, transmitter),
            log,
        }
    }

    /// A slice: answers a request or says what there is to say, judges a part of a move, logs.
    pub(crate) fn step(&mut self) {
        self.line.send();
        if self.line.is_free()
            && let Some(message) = self.message()
        {
            self.line.put(&message);
        }
        self.service.step();
        log::drain(&mut self.log);
    }

    /// Replies first, then events, then telemetry.
    fn message(&mut self) -> Option<Message<Scalar>> {
        if let Some(request) = self.line.request() {
            return Some(Message::Reply {
                sequence: request.sequence,
                reply: self.service.receive(&request),
            });
        }
        let message = self.service.outgoing()?;
        if let Message::Event(event) = &message {
            note(event);
        }
        Some(message)
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
