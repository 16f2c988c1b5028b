//! Event log of a device on standard output: clients that come and go, states, verdicts, faults. Each
//! line has the time since the device was switched on.

use std::io::{self, Write};
use trirrr_client::describe::{self, Units};
use trirrr_protocol::message::{Command, Event, Message, Reply, Request, Transmit};
use trirrr_scene::{Scene, SparePins, visible};

/// Event log of one device.
pub(super) struct EventLog {
    units: Units,
    /// Spare outputs and inputs of the machine.
    pins: SparePins,
    /// Nothing is printed.
    is_quiet: bool,
    ticks: u64,
    requests: u64,
    /// Number and ticks of the last move that was offered, for the text of its verdict.
    offered: (u32, u32),
}

impl EventLog {
    /// Log of the machine of `scene`, which computes in `units`.
    pub(super) fn new(units: Units, scene: &Scene, is_quiet: bool) -> Self {
        Self {
            units,
            pins: scene.spare_pins.clone(),
            is_quiet,
            ticks: 0,
            requests: 0,
            offered: (0, 0),
        }
    }

    /// Returns the numbers of ticks and requests.
    pub(super) fn totals(&self) -> [u64; 2] {
        [self.ticks, self.requests]
    }

    pub(super) fn tick(&mut self) {
        self.ticks += 1;
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
        let ticks = match (event, self.offered) {
            (Event::Verdict(verdict), (number, ticks)) if number == verdict.number => ticks,
            _ => 0,
        };
        if let Event::Digital(states) = event {
            self.note(&describe::digital(states, &self.pins));
        } else if let Some(text) = describe::event(event, ticks, &self.units) {
            self.note(&text);
        }
    }

    /// Notes `text`.
    pub(super) fn note(&self, text: &str) {
        if self.is_quiet {
            return;
        }
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
        Command::Levels(_) => "levels of power",
        Command::Listed(_) => "a move with levels",
        Command::Start => "start",
        Command::Probe { .. } => "probe",
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
        Command::UpdateStatus => "state of an update",
        Command::Update(_) => "update",
        Command::Output { .. } => "output",
        Command::OutputsAt(_) => "outputs with a move",
    }
}
