//! Event log of a device on standard output: clients that come and go, states, verdicts, faults. Each
//! line has the time since the device was switched on.

use super::client::Client;
use std::io::{self, Write};
use std::net::SocketAddr;
use trirrr_client::describe::{self, Units};
use trirrr_protocol::message::{Command, Event, Message, Reply, Request, Transmit};
use trirrr_scene::visible;

/// Event log of one device.
pub(super) struct EventLog {
    units: Units,
    ticks: u64,
    clients: u64,
    requests: u64,
    /// Number and ticks of the last move that was offered, for the text of its verdict.
    offered: (u32, u32),
}

impl EventLog {
    pub(super) fn new(units: Units) -> Self {
        Self {
            units,
            ticks: 0,
            clients: 0,
            requests: 0,
            offered: (0, 0),
        }
    }

    /// Returns the numbers of ticks, clients and requests.
    pub(super) fn totals(&self) -> [u64; 3] {
        [self.ticks, self.clients, self.requests]
    }

    pub(super) fn tick(&mut self) {
        self.ticks += 1;
    }

    pub(super) fn connected(&mut self, from: SocketAddr) {
        self.clients += 1;
        self.note(&format!("client {from} is connected"));
    }

    pub(super) fn turned_away(&self, from: SocketAddr, by: SocketAddr) {
        self.note(&format!("client {from} is turned away: {by} is connected"));
    }

    pub(super) fn replaced(&self, by: SocketAddr) {
        self.note(&format!("the client is silent, {by} takes its place"));
    }

    pub(super) fn gone(&self, client: &Client, error: &io::Error) {
        let (dropped, damaged) = (client.dropped(), client.damaged());
        let mut text = format!("client {} is gone: {error}", client.from());
        if dropped > 0 {
            text += &format!("; {dropped} samples dropped, for it did not read");
        }
        if damaged > 0 {
            text += &format!("; {damaged} damaged frames");
        }
        self.note(&text);
    }

    /// Notes a request that was refused. Events show the effect of the others.
    pub(super) fn answered<N: Transmit>(&mut self, request: &Request<N>, reply: &Reply<N>) {
        self.requests += 1;
        let mut ticks = 0;
        if let Some(offered) = request.command.offered() {
            ticks = offered.ticks;
            self.offered = (offered.last(), ticks);
        }
        self.refused(name(&request.command), ticks, reply);
    }

    /// Notes the answer to a request that waited for one that was missing.
    pub(super) fn answered_kept<N: Transmit>(&self, reply: &Reply<N>) {
        self.refused("request that was kept", 0, reply);
    }

    fn refused<N: Transmit>(&self, what: &str, ticks: u32, reply: &Reply<N>) {
        if let Reply::Refused(refusal) = reply {
            let why = describe::refusal(refusal, ticks, &self.units);
            self.note(&format!("{what} refused: {why}"));
        }
    }

    /// Notes that a motor has found its reference. `errors` are the differences between the true angles
    /// of the motors and the commanded ones, rad.
    pub(super) fn referenced(&self, errors: [f64; 3]) {
        self.motors("a motor is found", errors);
    }

    /// Notes the `errors` of the motors at the end, rad.
    pub(super) fn left(&self, errors: [f64; 3]) {
        self.motors("switched off", errors);
    }

    fn motors(&self, what: &str, errors: [f64; 3]) {
        let errors = errors.map(|error| format!("{error:.6}"));
        let errors = errors.join(", ");
        self.note(&format!(
            "{what}: the motors are {errors} rad from where they are thought"
        ));
    }

    /// Notes an event of the machine. Telemetry is left out.
    pub(super) fn message<N: Transmit>(&self, message: &Message<N>) {
        let Message::Event(event) = message else {
            return;
        };
        match event {
            Event::Verdict(verdict) => {
                if let Some(violation) = &verdict.violation {
                    let ticks = match self.offered {
                        (number, ticks) if number == verdict.number => ticks,
                        _ => 0,
                    };
                    let why = describe::violation(violation, ticks, &self.units);
                    let counted = verdict.number.wrapping_add(1);
                    self.note(&format!("move {counted} is not admitted: {why}"));
                }
            }
            Event::State {
                state,
                acting,
                done,
            } => {
                let state = describe::state(*state, *acting);
                self.note(&format!("{state}, {done} moves done"));
            }
            Event::Fault(fault) => {
                self.note(&format!("fault: {}", describe::fault(fault, &self.units)));
            }
        }
    }

    fn note(&self, text: &str) {
        let t = self.ticks as f64 / self.units.tick_rate_hz;
        // A closed standard output does not stop the device.
        let mut out = io::stdout().lock();
        let _ = writeln!(out, "{t:>10.3} s  {}", visible(text)).and_then(|()| out.flush());
    }
}

/// Returns the name of a command.
fn name<N: Transmit>(command: &Command<N>) -> &'static str {
    match command {
        Command::Hello(_) => "hello",
        Command::Status => "status",
        Command::Read(_) => "read",
        Command::Replace(_) => "replace",
        Command::Move(_) | Command::Quintic(_) => "move",
        Command::Moves(_) => "moves",
        Command::Start => "start",
        Command::Hold => "hold",
        Command::Resume => "resume",
        Command::Stop => "stop",
        Command::ClearFault => "clear fault",
        Command::Recover(_) => "recover",
        Command::Telemetry { .. } => "telemetry",
        Command::Job(_) => "the name of a job",
        Command::Home => "home",
        Command::FeedOverride { .. } => "feed override",
        Command::Retarget(_) => "retarget",
        Command::Path(_) => "path",
        Command::Enable => "enable",
        Command::Disable => "disable",
        Command::Drives { .. } => "drives",
    }
}
