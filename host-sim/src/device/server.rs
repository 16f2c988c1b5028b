//! Work of a device between two ticks: its client, and the messages of the machine.

use super::event_log::EventLog;
use super::inputs::PressedInputs;
use super::motors::{self, Motors};
use crate::serve::{FrameKind, Hub, Standing};
use std::io;
use std::time::Instant;
use trirrr_client::local::LocalService;
use trirrr_drives::ObeyingDrives;
use trirrr_line::Frames;
use trirrr_protocol::message::{Command, Message, Reply, Request};
use trirrr_service::ServiceNumber;

/// Slices of background work between two looks at the link.
const SLICES: u32 = 64;

/// Machine that serves one client at a time.
pub(super) struct Server<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    around: Surroundings<N>,
    hub: Hub,
    log: EventLog,
    /// Frame of the message that is sent.
    frame: Vec<u8>,
}

/// Simulated parts around the service.
pub(super) struct Surroundings<N: ServiceNumber> {
    /// Motors, if the machine has to be homed.
    pub(super) motors: Option<Motors>,
    /// Drives, if they tell where they are.
    pub(super) drives: Option<ObeyingDrives<N>>,
    /// Emergency stop, door, probe and limit switches.
    pub(super) inputs: PressedInputs,
    /// One unit of length of the machine, m.
    pub(super) length_m: f64,
}

impl<'a, N: ServiceNumber> Server<'a, N> {
    pub(super) fn new(
        machine: &'a mut dyn LocalService<N>,
        around: Surroundings<N>,
        hub: Hub,
        log: EventLog,
    ) -> Self {
        Self {
            machine,
            around,
            hub,
            log,
            frame: Vec::new(),
        }
    }

    /// Computes one tick and sends its messages.
    ///
    /// # Errors
    /// As [`Server::serve`].
    pub(super) fn tick(&mut self) -> io::Result<()> {
        let start = Instant::now();
        let Surroundings {
            motors,
            drives,
            inputs,
            length_m,
        } = &mut self.around;
        let place = self.machine.motion().map(|played| {
            let position = &played.0.pose.position;
            [position.x, position.y].map(|each| each.to_f64() * *length_m)
        });
        let readings = inputs.read(place);
        self.machine.sense(readings.interlocks);
        self.machine.sense_digital(readings.spare);
        if let Some(motors) = motors {
            self.machine.inputs(motors.inputs());
        }
        if let Some(drives) = drives {
            let mut readings = drives.measure();
            if let Some(motors) = motors {
                motors.press(&mut readings);
            }
            self.machine.hear(readings);
        }
        self.machine.tick();
        let shift = self.machine.shift();
        if let Some(drives) = drives {
            if let Some(by) = shift {
                drives.shift(by);
            }
            drives.apply(self.machine.output());
        }
        if let Some(motors) = motors {
            let shift = shift.map(|by| by.map(N::angle_to_f64));
            motors.follow(motors::angles(self.machine.motors()), shift);
            if shift.is_some() {
                self.log.referenced(motors.errors());
            }
        }
        let took = u32::try_from(start.elapsed().as_nanos());
        self.machine.report_timing(took.unwrap_or(u32::MAX));
        self.log.tick();
        self.serve().map(|_| ())
    }

    /// Executes requests of the client, works a little, and sends messages. Never waits. Returns true if
    /// there is more to do.
    ///
    /// # Errors
    /// The listener is lost.
    pub(super) fn serve(&mut self) -> io::Result<bool> {
        let heard = self.listen();
        self.hub.accept()?;
        let busy = (0..SLICES).all(|_| self.machine.step());
        while let Some(message) = self.machine.outgoing() {
            self.log.message(&message);
            let kind = FrameKind::of(&message);
            self.frame(message);
            self.hub.put(&self.frame, kind);
        }
        self.hub.flush();
        for note in self.hub.take_notes() {
            self.log.note(&note);
        }
        Ok(heard || busy)
    }

    /// Counts a tick that came too late.
    pub(super) fn count_late(&mut self) {
        self.machine.count_late();
    }

    /// Ends the service. Returns the event log, and the number of clients.
    pub(super) fn end(self) -> (EventLog, u64) {
        if let Some(motors) = &self.around.motors {
            self.log.left(motors.errors());
        }
        (self.log, self.hub.clients())
    }

    /// Answers the requests of the client. Returns true if there were any.
    fn listen(&mut self) -> bool {
        let requests: Vec<Request<N>> = self.hub.requests();
        let heard = !requests.is_empty();
        for request in requests {
            // The answer to the one before may have been the last.
            if !self.hub.takes(matches!(request.command, Command::Hello(_))) {
                break;
            }
            let reply = self.machine.answer(&request);
            self.log.answered(&request, &reply);
            self.reply(request.sequence, reply);
            while let Some((sequence, reply)) = self.machine.answer_kept() {
                self.log.answered_kept(&reply);
                self.reply(sequence, reply);
            }
        }
        heard
    }

    fn reply(&mut self, sequence: u32, reply: Reply<N>) {
        let standing = Standing::of(&reply);
        self.frame(Message::Reply { sequence, reply });
        self.hub.judge(standing, &self.frame);
    }

    /// Puts the bytes of `message` into the frame. Samples that the client has lost are lost as those that were lost in the machine.
    fn frame(&mut self, mut message: Message<N>) {
        let dropped = self.hub.dropped();
        match &mut message {
            Message::Telemetry(sample) => sample.lost = sample.lost.wrapping_add(dropped),
            Message::Reply {
                reply: Reply::Status(status),
                ..
            } => status.lost = status.lost.wrapping_add(dropped),
            _ => {}
        }
        self.frame.clear();
        Frames::append(&message, &mut self.frame);
    }
}
