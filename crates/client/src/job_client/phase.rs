//! Phases of a conversation, and the request that each sends next.

use super::JobClient;
use crate::JobFailure;
use std::time::Duration;
use trirrr_protocol::message::scene::SectionName;
use trirrr_protocol::message::{Command, Request, State, Status, Transmit};

/// Phase of a conversation.
///
/// ```text
/// Greeting ─> Meeting ──> Waking ────┬─> Awaiting ─────┐
///    │           │                   ├─> Underway ─> Surveying, or Waking to set off
///    │           │                   └─> Surveying, behind a fault
///    │           └──────> Preparing, Sampling, Naming ─> Streaming <──┘ by Preparing
///    └─> Surveying, once the machine is known: as Meeting, or back into Streaming
/// ```
/// Of a scene with tools Checking comes before Meeting.
/// Every phase may end in Ending or Finished. A lost line leads back to Greeting.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Phase<N: Transmit> {
    /// The client sends a hello.
    Greeting,
    /// The client asks for the platform of the machine, with the tool on it.
    Checking,
    /// The client asks for the first status of the machine.
    Meeting,
    /// The client asks a known machine where the job stands: on a new line, after a fault was
    /// acknowledged, or if both count the moves in different ways.
    Surveying,
    /// The client gives an order on the way of the machine to readiness, or to the start of the job.
    Waking(Command<N>),
    /// The machine has the straight way to the start of the job, proves it, and takes it.
    Underway,
    /// The machine is on its way to readiness, or to the start of the job.
    Awaiting,
    /// The client sets the rate of the telemetry,
    Preparing,
    /// and that of the samples of the drives.
    Sampling,
    /// The client names the job.
    Naming,
    /// The client offers moves, starts them and watches.
    Streaming,
    /// The client stops the machine; then the job has ended with the failure.
    Ending(JobFailure<N>),
    /// The job has ended.
    Finished(Result<(), JobFailure<N>>),
}

/// Next act of the client.
pub(super) enum Next<N: Transmit> {
    /// Ask this.
    Ask(Command<N>),
    /// Listen; nothing is to be said before this time.
    Listen(Duration),
}

impl<N: Transmit> JobClient<N> {
    /// Returns the next act in the present phase.
    pub(super) fn next(&mut self, now: Duration) -> Next<N> {
        if self.hears_user()
            && now >= self.schedule.pause()
            && let Some(command) = self.user.commands.ask()
        {
            return Next::Ask(command.into());
        }
        let order = match &self.phase {
            Phase::Greeting => return Next::Ask(Command::Hello(self.hello)),
            Phase::Checking => return Next::Ask(Command::Read(SectionName::Platform)),
            Phase::Meeting | Phase::Surveying => return Next::Ask(Command::Status),
            Phase::Ending(_) => Command::Stop,
            // Nothing else is begun: the next status says that it has come to rest.
            _ if self.user.has_stopped => return self.watch(now),
            Phase::Awaiting => return self.watch(now),
            Phase::Underway => return self.watch_way(now),
            Phase::Streaming => return self.feed(now),
            Phase::Finished(_) => return Next::Listen(self.schedule.look()),
            Phase::Waking(order) => *order,
            Phase::Preparing => Command::Telemetry {
                every: self.telemetry,
                fields: self.fields,
            },
            Phase::Naming => Command::Job(self.label),
            Phase::Sampling => Command::Drives {
                every: self.drives.unwrap_or(0),
            },
        };
        // The tick takes one order at a time: after a refusal the client waits for a tick.
        match self.schedule.pause() {
            pause if now < pause => Next::Listen(pause),
            _ => Next::Ask(order),
        }
    }

    /// Watches the way to the start. A machine that waits for its host there is resumed.
    fn watch_way(&mut self, now: Duration) -> Next<N> {
        match self.has_to_resume() {
            true => Next::Ask(Command::Resume),
            false => self.watch(now),
        }
    }

    /// Returns true if nothing is in flight.
    fn is_free(&self) -> bool {
        self.exchange.open().next().is_none()
    }

    /// Returns true if the machine waits for its host, and nothing is in flight.
    fn has_to_resume(&self) -> bool {
        self.is_free() && self.status.as_ref().is_some_and(Status::waits_for_host)
    }

    /// Returns true if the machine is known, and the job goes on: the commands of the user go before all else.
    fn hears_user(&self) -> bool {
        let is_over = matches!(self.phase, Phase::Ending(_) | Phase::Finished(_));
        self.status.is_some() && !is_over && self.phase != Phase::Greeting
    }

    /// Asks for the status in time.
    fn watch(&mut self, now: Duration) -> Next<N> {
        match self.schedule.look() {
            // One question at a time.
            _ if self
                .exchange
                .open()
                .any(|open| open.command == Command::Status) =>
            {
                Next::Listen(Duration::MAX)
            }
            look if look <= now => Next::Ask(Command::Status),
            look => Next::Listen(look),
        }
    }

    /// Watches, offers moves as the machine has room, and starts them.
    fn feed(&mut self, now: Duration) -> Next<N> {
        let look = match self.watch(now) {
            Next::Listen(look) if now >= self.schedule.pause() => look,
            next => return next,
        };
        if self.has_to_resume() {
            return Next::Ask(Command::Resume);
        }
        let is_free = self.is_free();
        match self.progress.next_offer() {
            // The machine does not say for how many pieces it has room.
            Some(offer) if is_free || !self.progress.is_path() => {
                self.progress.count_offered(&offer);
                Next::Ask(offer)
            }
            None if is_free && self.is_ready() => Next::Ask(Command::Start),
            _ => Next::Listen(look),
        }
    }

    /// Returns true if a request may follow those in flight: moves with their levels and questions for the status may, behind each other.
    pub(super) fn goes_on(&self) -> bool {
        let follows = |request: &Request<N>| {
            request.command.brings_moves() || request.command == Command::Status
        };
        self.phase == Phase::Streaming
            && self.exchange.has_room()
            && self.exchange.open().all(follows)
    }

    /// Returns true if moves are in flight.
    pub(super) fn offers(&self) -> bool {
        let mut open = self.exchange.open();
        open.any(|request| request.command.brings_moves())
    }

    /// Returns true if the machine stands, has judged all moves that it has taken, and has moves to
    /// play. That happens more than once: a machine that gets moves too slowly comes to rest at the
    /// end of those that it has.
    fn is_ready(&self) -> bool {
        self.status.as_ref().is_some_and(|status| {
            status.state == State::Idle
                && (status.admitted == status.next || status.planning)
                && status.admitted != status.done
        })
    }
}
