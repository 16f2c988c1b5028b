//! Work below the tick, a bounded slice at a time.

use super::image_scene::{MessageRef, SceneBackground};
use super::line::{Line, ReceivedBytes};
use super::{log, update};
use crate::scene::{Interlocks, Scalar};
use crate::tick::heartbeat::Monitor;
use embedded_hal_nb::serial::Write;
use heapless::spsc::Consumer;
use trirrr_protocol::message::{Event, Reply};
use trirrr_service::features::Feature;

/// Messages between two slices, at the most: as many as samples wait.
const MESSAGES: usize = 8;

/// Half of the service that talks, with the line, the log and the watchdog's condition.
///
/// `W` is the line's transmitter, `L` that of the log, `R` the line's receiver: the queue that an interrupt fills, or a DMA.
pub struct Background<W, L, R = Consumer<'static, u8>> {
    service: SceneBackground,
    line: Line,
    receiver: R,
    transmitter: W,
    log: L,
    heartbeat: Monitor,
    /// The last message was a reply.
    replied: bool,
}

impl<W: Write<u8>, L: Write<u8>, R: ReceivedBytes> Background<W, L, R> {
    /// Joins the service's half with the line's receiver and both transmitters.
    pub fn new(service: SceneBackground, receiver: R, transmitter: W, log: L) -> Self {
        Self {
            service,
            line: Line::new(),
            receiver,
            transmitter,
            log,
            heartbeat: Monitor::default(),
            replied: false,
        }
    }

    /// Works below every interrupt and never returns. Calls `after_tick` after each tick that was in time, with `true` if the watchdog is to
    /// be fed.
    pub fn run(&mut self, mut after_tick: impl FnMut(bool)) -> ! {
        // No sleep: out of sleep a tick starts late, a debugger loses the core, and in an emulator time
        // jumps with the host's.
        loop {
            if self.heartbeat.has_beaten() {
                after_tick(self.heartbeat.feeds());
            }
            self.line.send(&mut self.transmitter);
            // A slice of admission may outlast a tick: all that the line takes goes out before it, or samples
            // are lost.
            for _ in 0..MESSAGES {
                if !self.converse() {
                    break;
                }
            }
            step(&mut self.service);
            log::drain(&mut self.log);
            update::restart_if_asked();
        }
    }

    /// Takes what has come, and puts the next message on the line. Returns `true` if there was one.
    // A call: the loop around it would be unrolled.
    #[inline(never)]
    fn converse(&mut self) -> bool {
        self.line.listen(&mut self.receiver);
        let has_put = put_next(&mut self.service, &mut self.line, &mut self.replied);
        if has_put {
            self.line.send(&mut self.transmitter);
        }
        has_put
    }
}

/// Checks a part of a move.
// A call: inlined, the board's crate would compile the whole background for speed.
#[inline(never)]
fn step(service: &mut SceneBackground) {
    service.step();
}

/// Puts the next message on the line if it is free. Replies and other messages take turns: none starves the other.
/// Returns `true` if there was one.
#[inline(never)]
fn put_next(service: &mut SceneBackground, line: &mut Line, replied: &mut bool) -> bool {
    if !line.is_free() {
        return false;
    }
    if *replied && put_message(service, line) {
        *replied = false;
        return true;
    }
    *replied = put_reply(service, line);
    *replied || put_message(service, line)
}

/// Executes the next request that has come, and puts its reply on the line.
fn put_reply(service: &mut SceneBackground, line: &mut Line) -> bool {
    let (sequence, reply) = match service.answer_kept() {
        Some(kept) => kept,
        None => match line.request() {
            Some((request, checksum)) => (request.sequence, service.answer(&request, checksum)),
            None => return false,
        },
    };
    // A host that speaks in this layout can talk to the program, and replace it.
    if let Reply::Hello(_) = &reply {
        update::confirm_program();
    }
    let reply = &reply;
    line.put(&MessageRef::Reply { sequence, reply });
    true
}

/// Puts an event or a sample on the line.
fn put_message(service: &mut SceneBackground, line: &mut Line) -> bool {
    service.send_next(|message| {
        if let MessageRef::Event(event) = message {
            log_event(event);
        }
        line.put(message);
    })
}

fn log_event(event: &Event<Scalar>) {
    match event {
        Event::Verdict(verdict) if verdict.violation.is_some() => {
            defmt::warn!("move {=u32} is not admitted", verdict.number);
        }
        Event::Verdict(_) => {}
        // As a number: names would be in the image. docs/wire.md lists them in this order.
        Event::State { state, done, .. } => {
            defmt::info!("state {=u8}, {=u32} moves done", *state as u8, done);
        }
        Event::Fault(fault) => defmt::error!("fault in tick {=u32}", fault.tick),
        Event::Inputs(inputs) if Interlocks::EXISTS => defmt::info!(
            "emergency stop {=u8}, door {=u8}, probe {=u8}",
            inputs.emergency_stop as u8,
            inputs.door as u8,
            inputs.probe as u8
        ),
        _ => {}
    }
}
