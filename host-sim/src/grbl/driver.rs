//! Machine behind a sender: pieces of its path, orders, and what the machine tells.

use super::inputs::ProgramInputs;
use super::outputs::ProgramOutputs;
use super::path::{PathFeed, QueuedPiece};
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_client::describe::{self, Units as Words};
use trirrr_client::exchange::{Exchange, Patience, Turn};
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_grbl::{MachineAct, MachinePhase, MachineView, ProbeEnd};
use trirrr_protocol::message::{
    Command, Event, Hello, Message, PathPiece, ProbeRun, Recovery, Refusal, Reply, Request, State,
    Status, TelemetryFields, Transmit,
};
use trirrr_scene::{Scene, offer};
use trirrr_toolpath::{Act, Element, ToolCurve, ToolMotion, ToolPlace};

/// Time from one status to the next.
const STATUS_EVERY: Duration = Duration::from_millis(20);

/// Time until a request is made again that the machine did not take yet.
const PAUSE: Duration = Duration::from_millis(4);

/// Age at which a sample counts no more: a machine that is off may send none.
const SAMPLE_AGE: Duration = Duration::from_millis(300);

/// Samples a second: senders ask for five to twenty reports.
const SAMPLES_HZ: f64 = 25.0;

/// Moves that wait before a path that still grows is begun.
const HEAD_START: u32 = 24;

/// Speed to the start of the scene's job, m/s, and shortest time of a way of the motors one by one, s.
const HOME_M_S: f64 = 0.05;
const RECOVER_S: f64 = 3.0;

/// Way to the machine being ready.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Waking {
    homes: bool,
    /// Orders that were given on the way, each once.
    cleared: bool,
    enabled: bool,
    homed: bool,
    on_way: bool,
}

/// Motion with the probe.
#[derive(Clone, Debug, PartialEq)]
enum Probing {
    /// The machine has not begun it. `away`: until the probe lets go.
    Waits { away: bool },
    /// It is under way.
    Runs,
    /// It is over.
    Ended(ProbeEnd),
}

/// Client of a machine for a path without an end, without a port and a clock.
pub(super) struct MachineDriver<N: Transmit> {
    exchange: Exchange<N>,
    hello: Hello,
    greeted: bool,
    units: Units,
    words: Words,
    start: Pose<f64>,
    tick_rate_hz: f64,
    status: Option<Status<N>>,
    place: ToolPlace,
    speed_m_s: f64,
    power: f64,
    /// State in the last sample, and its time.
    sample: Option<(State, Duration)>,
    /// The place that is known is that of the state that is known.
    is_settled: bool,
    orders: VecDeque<Command<N>>,
    feed: PathFeed,
    inputs: ProgramInputs,
    outputs: ProgramOutputs,
    /// Number of the next piece.
    piece: Option<u32>,
    /// Requests that change the machine, and how many of them the status knows.
    changes: u64,
    asked_at: u64,
    known: u64,
    look: Duration,
    pause: Duration,
    waking: Option<Waking>,
    reason: Option<String>,
    refused: Option<String>,
    was_refused: bool,
    probing: Option<Probing>,
    /// The machine cannot serve senders at all.
    pub(super) failure: Option<String>,
}

impl<N: Transmit> MachineDriver<N> {
    /// Creates the driver of the machine of `scene`.
    pub(super) fn new(
        scene: &Scene,
        units: Units,
        hello: Hello,
        patience: Patience,
        conversation: u32,
        corner_m: f64,
    ) -> Self {
        let start = scene.job.start;
        Self {
            exchange: Exchange::new(patience, conversation),
            hello,
            greeted: false,
            units,
            words: Words::of_scene(scene, &units),
            start,
            tick_rate_hz: scene.tick_rate_hz,
            status: None,
            place: place_of(&start),
            speed_m_s: 0.0,
            power: 0.0,
            sample: None,
            is_settled: true,
            orders: VecDeque::new(),
            feed: PathFeed::new(start, corner_m),
            inputs: ProgramInputs::default(),
            outputs: ProgramOutputs::new(&scene.spare_pins),
            piece: None,
            changes: 0,
            asked_at: 0,
            known: 0,
            look: Duration::ZERO,
            pause: Duration::ZERO,
            waking: None,
            reason: None,
            refused: None,
            was_refused: false,
            probing: None,
            failure: None,
        }
    }

    /// The machine as it is known now, with the changes of its inputs since the view before.
    pub(super) fn view(&mut self) -> MachineView {
        MachineView {
            phase: self.phase(),
            reason: self.reason.clone(),
            place: self.place,
            speed_m_s: self.speed_m_s,
            power: self.power,
            room: match self.waking {
                Some(_) => 0,
                None => self.feed.room(),
            },
            is_empty: self.is_empty(),
            feed_percent: self.status.map_or(100, |status| status.feed_percent),
            probe: match &self.probing {
                Some(Probing::Ended(end)) => Some(end.clone()),
                _ => None,
            },
            inputs: self.inputs.view(),
        }
    }

    /// Takes the reason out for which the machine has refused a piece.
    pub(super) fn take_refused(&mut self) -> Option<String> {
        self.refused.take()
    }

    /// Returns true once the machine has answered.
    pub(super) fn is_known(&self) -> bool {
        self.status.is_some()
    }

    /// Returns true if the drives are off, and nothing was asked since.
    pub(super) fn is_off(&self) -> bool {
        let is_off = |status: &Status<N>| matches!(status.state, State::Disabled | State::Fault);
        self.orders.is_empty() && self.is_fresh() && self.status.as_ref().is_some_and(is_off)
    }

    fn phase(&self) -> MachinePhase {
        let Some(status) = &self.status else {
            return MachinePhase::Off;
        };
        if self.waking.is_some() {
            return MachinePhase::Waking;
        }
        match status.state {
            // It stands, and the place is still that of the way there.
            State::Idle if !self.is_settled => MachinePhase::Running,
            State::Holding if !self.is_settled => MachinePhase::Slowing,
            State::Idle => MachinePhase::Idle,
            State::Running => MachinePhase::Running,
            State::Slowing => MachinePhase::Slowing,
            State::Holding => MachinePhase::Holding,
            State::Stopping | State::Disabling => MachinePhase::Stopping,
            State::Fault | State::Reacting => MachinePhase::Fault,
            State::Cleared
            | State::Recovering
            | State::Unhomed
            | State::Homing
            | State::Disabled
            | State::Enabling => MachinePhase::Off,
        }
    }

    /// The machine stands, knows of nothing to play, and so does this.
    fn is_empty(&self) -> bool {
        let Some(status) = &self.status else {
            return false;
        };
        let stands = match status.state {
            State::Idle => status.next == status.done && !status.planning,
            State::Disabled | State::Fault | State::Unhomed | State::Cleared => true,
            _ => false,
        };
        stands
            && self.is_settled
            && self.feed.is_empty()
            && self.orders.is_empty()
            && self.is_fresh()
    }

    /// The status knows of all that was asked.
    fn is_fresh(&self) -> bool {
        self.known == self.changes
    }

    /// Takes an act of the sender.
    pub(super) fn take(&mut self, act: MachineAct) {
        if matches!(self.probing, Some(Probing::Ended(_))) {
            self.probing = None;
        }
        match act {
            MachineAct::Motion(element) => self.feed.push(&element),
            MachineAct::Probe { element, away } => {
                self.feed.push(&element);
                self.feed.flush();
                self.probing = Some(Probing::Waits { away });
            }
            MachineAct::Flush => self.feed.flush(),
            MachineAct::Output(act) => {
                if let Some(command) = self.outputs.switch(act) {
                    self.order(command);
                }
            }
            MachineAct::End => self.outputs.end(),
            MachineAct::Unlock | MachineAct::Home => {
                self.reason = None;
                self.outputs.clear();
                self.waking = Some(Waking {
                    homes: act == MachineAct::Home,
                    cleared: false,
                    enabled: false,
                    homed: false,
                    on_way: false,
                });
            }
            MachineAct::Sleep => self.order(Command::Disable),
            MachineAct::Hold => self.order(Command::Hold),
            MachineAct::Resume => self.order(Command::Resume),
            MachineAct::Stop => {
                self.feed.clear();
                self.waking = None;
                self.probing = None;
                self.outputs.clear();
                self.order(Command::Stop);
            }
            MachineAct::Feed(percent) => self.order(Command::FeedOverride { percent }),
        }
    }

    /// Begins the conversation again on a port that was opened anew.
    pub(super) fn reconnected(&mut self) {
        self.greeted = false;
        self.exchange.forget();
    }

    /// Returns the next act at `now`.
    pub(super) fn poll(&mut self, now: Duration) -> Turn<N> {
        loop {
            let turn = self.exchange.poll(now);
            if turn != Turn::Free {
                return turn;
            }
            if !self.greeted {
                self.exchange.greet(self.hello, now);
                continue;
            }
            match self.next(now) {
                Some(command) => {
                    match command {
                        Command::Status => self.asked_at = self.changes,
                        Command::Telemetry { .. } => {}
                        _ => self.changes += 1,
                    }
                    self.exchange.ask(command, now);
                }
                None => return Turn::Wait(self.look),
            }
        }
    }

    fn order(&mut self, command: Command<N>) {
        self.orders.push_back(command);
    }

    fn next(&mut self, now: Duration) -> Option<Command<N>> {
        if let Some(order) = self.orders.pop_front() {
            return Some(order);
        }
        let Some(status) = self.status.filter(|_| now < self.look) else {
            return Some(Command::Status);
        };
        if now < self.pause {
            return None;
        }
        // A machine that was cut off waits for its host, not for the sender.
        if status.waits_for_host() {
            self.pause = now + STATUS_EVERY;
            return Some(Command::Resume);
        }
        let waits = status.state == State::Idle && status.next != status.done;
        let is_whole = !status.planning && status.admitted == status.next;
        if waits
            && (is_whole || status.next.wrapping_sub(status.done) >= HEAD_START)
            && self.is_fresh()
        {
            return match self.probing {
                None => Some(Command::Start),
                Some(Probing::Waits { away }) => Some(Command::Probe { away }),
                // Nothing moves on behind a contact.
                Some(Probing::Runs | Probing::Ended(_)) => None,
            };
        }
        let is_on = matches!(
            status.state,
            State::Idle | State::Running | State::Slowing | State::Holding
        );
        let QueuedPiece {
            piece,
            feed_m_s,
            tool,
            last,
        } = self.feed.front().filter(|_| is_on)?;
        // The first move of a path that begins at rest is the one move whose number is known.
        let rests = status.state == State::Idle && status.next == status.done && !status.planning;
        if rests
            && self.is_fresh()
            && let Some(switch) = self.outputs.with_path(status.next)
        {
            return Some(Command::OutputsAt(switch));
        }
        let number = *self.piece.get_or_insert(status.piece);
        let Some(piece) = offer::piece(&piece, feed_m_s, tool, &self.units) else {
            self.feed.clear();
            self.refused = Some("the machine plans no arc on which A bends".into());
            return None;
        };
        Some(Command::Path(PathPiece {
            number,
            last,
            ..piece
        }))
    }

    /// Takes a message of the machine.
    pub(super) fn receive(&mut self, message: &Message<N>, now: Duration) {
        match message {
            Message::Telemetry(sample) => {
                let metres = self.units.length_m();
                let setpoint = &sample.setpoint;
                let [x, y] = [setpoint.pose.position.x, setpoint.pose.position.y];
                self.place = ToolPlace {
                    position_m: [x, y].map(|each| each.to_f64() * metres),
                    alpha_rad: N::angle_to_f64(setpoint.pose.angle),
                };
                let velocity = <[N; 3]>::from(setpoint.velocity).map(N::to_f64);
                self.speed_m_s = velocity[0].hypot(velocity[1]) * metres / self.units.time_s();
                self.power = sample.tool.to_f64();
                self.sample = Some((sample.state, now));
            }
            Message::Event(Event::State { .. } | Event::Fault(_)) => self.look = self.look.min(now),
            Message::Event(Event::Digital(states)) => self.inputs.take_event(*states),
            _ => {}
        }
        let Some((Request { command, .. }, reply)) = self.exchange.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(_) => {
                self.greeted = true;
                self.look = now;
                let every = (self.tick_rate_hz / SAMPLES_HZ).round().clamp(1.0, 65535.0);
                let fields = TelemetryFields(TelemetryFields::SETPOINT.0 | TelemetryFields::TOOL.0);
                self.orders.push_front(Command::Telemetry {
                    every: every as u16,
                    fields,
                });
            }
            Reply::Status(status) => self.on_status(status, now),
            Reply::Done => {
                self.look = now;
                if let Command::Path(piece) = command
                    && self.piece == Some(piece.number)
                {
                    self.piece = Some(piece.number.wrapping_add(1));
                    self.feed.pop();
                }
                if matches!(command, Command::Probe { .. }) {
                    self.probing = Some(Probing::Runs);
                }
                if let Command::OutputsAt(switch) = command {
                    self.outputs.are_told(switch.number);
                }
            }
            Reply::Refused(refusal) => self.on_refusal(&command, refusal, now),
            Reply::Section(_) | Reply::Kept { .. } | Reply::Update(_) => {}
        }
    }

    fn on_status(&mut self, status: Status<N>, now: Duration) {
        self.look = now + STATUS_EVERY;
        self.known = self.asked_at;
        self.status = Some(status);
        if let Some(states) = status.digital {
            self.inputs.take_status(states);
        }
        let is_old = |(state, time): (State, Duration)| moves(state) && now < time + SAMPLE_AGE;
        self.is_settled = moves(status.state) || !self.sample.is_some_and(is_old);
        if !self.is_settled {
            self.look = now + PAUSE;
        } else if !moves(status.state) {
            (self.speed_m_s, self.power) = (0.0, 0.0);
        }
        if let Some(end) = status
            .end
            .filter(|_| status.state != State::Running && self.is_empty())
        {
            // Samples are seldom: at rest this is the very place.
            let metres = self.units.length_m();
            let pose = end.pose;
            self.place = ToolPlace {
                position_m: [pose.position.x, pose.position.y].map(|each| each.to_f64() * metres),
                alpha_rad: N::angle_to_f64(pose.angle),
            };
            if self.waking.is_none() {
                self.feed.stand(&self.place);
            }
        }
        let is_refused = status.refused.is_some();
        if let Some(verdict) = status.refused.filter(|_| !self.was_refused) {
            let why = verdict
                .violation
                .map(|violation| describe::violation(&violation, 0, &self.words));
            self.refused = Some(why.unwrap_or_else(|| "the machine has refused the motion".into()));
            self.feed.clear();
            self.outputs.clear();
            self.piece = None;
        }
        self.was_refused = is_refused;
        if let Some(fault) = status.fault
            && self.waking.is_none()
        {
            self.reason = Some(describe::fault(&fault, &self.words));
            self.feed.clear();
            self.outputs.clear();
            self.piece = None;
        }
        if self.is_empty() {
            self.outputs.rest();
        }
        self.end_probing(&status);
        if self.waking.is_some() && self.is_fresh() {
            self.wake(&status);
        }
    }

    /// Takes the end of a motion with the probe.
    fn end_probing(&mut self, status: &Status<N>) {
        if status.fault.is_some() {
            self.probing = None;
        }
        let is_over = status.state == State::Idle && status.next == status.done && !status.planning;
        if self.probing != Some(Probing::Runs) || !is_over || !self.is_fresh() {
            return;
        }
        let end = match status.probe {
            Some(ProbeRun::Armed) => return,
            Some(ProbeRun::Touched(contact)) => {
                let metres = self.units.length_m();
                // Where the drives tell more, they tell where the probe truly was.
                let pose = contact.measured.unwrap_or(contact.pose);
                ProbeEnd::Touched(ToolPlace {
                    position_m: [pose.position.x, pose.position.y]
                        .map(|each| each.to_f64() * metres),
                    alpha_rad: N::angle_to_f64(pose.angle),
                })
            }
            Some(ProbeRun::NotTouched) | None => ProbeEnd::NotTouched,
        };
        self.probing = Some(Probing::Ended(end));
        self.feed.clear();
        self.piece = None;
    }

    /// The next step on the way to a machine that is ready.
    fn wake(&mut self, status: &Status<N>) {
        let Some(mut waking) = self.waking else {
            return;
        };
        let fail = match status.state {
            State::Fault if !waking.cleared => {
                waking.cleared = true;
                self.order(Command::ClearFault);
                None
            }
            State::Fault => Some(match &status.fault {
                Some(fault) => describe::fault(fault, &self.words),
                None => "the fault does not go away".into(),
            }),
            State::Disabled
                if !waking.cleared
                    && !waking.enabled
                    && status
                        .not_enabled
                        .is_some_and(|why| why.wants_acknowledgement()) =>
            {
                waking.cleared = true;
                self.order(Command::ClearFault);
                None
            }
            State::Disabled if !waking.enabled => {
                waking.enabled = true;
                self.order(Command::Enable);
                None
            }
            State::Disabled => Some(match &status.not_enabled {
                Some(why) => format!("not enabled: {}", describe::not_enabled(why)),
                None => "the drives went off again".into(),
            }),
            State::Unhomed if waking.homes && !waking.homed => {
                waking.homed = true;
                self.order(Command::Home);
                None
            }
            State::Unhomed => Some("the machine does not know where its motors are: $H homes it".into()),
            State::Cleared if waking.homes && !waking.homed => {
                waking.homed = true;
                let ticks = (RECOVER_S * self.tick_rate_hz).round().max(1.0) as u32;
                self.order(Command::Recover(Recovery {
                    to: offer::pose(&self.units.pose(&self.start)),
                    ticks,
                }));
                None
            }
            State::Cleared => Some(
                "the platform's pose is not known after the fault: $H brings the machine to its start, slowly".into(),
            ),
            State::Idle if !self.is_empty() => None,
            State::Idle if waking.homes && !waking.on_way && !self.is_at_start() => {
                waking.on_way = true;
                self.feed.stand(&self.place);
                self.feed.push(&way_to(place_of(&self.start)));
                self.feed.flush();
                None
            }
            State::Idle => {
                self.feed.stand(&self.place);
                self.waking = None;
                return;
            }
            _ => None,
        };
        self.waking = match fail {
            Some(reason) => {
                self.reason = Some(reason);
                None
            }
            None => Some(waking),
        };
    }

    fn is_at_start(&self) -> bool {
        let start = place_of(&self.start);
        let off = (0..2).map(|axis| self.place.position_m[axis] - start.position_m[axis]);
        off.chain([self.place.alpha_rad - start.alpha_rad])
            .all(|off| off.abs() < 1e-6)
    }

    fn on_refusal(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        match (command, refusal) {
            (_, Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused) => {
                self.greeted = false;
            }
            (Command::Path(_), Refusal::MoveNumber { expected }) => self.piece = Some(expected),
            (Command::Path(_), Refusal::NoPaths) => {
                self.failure = Some(
                    "the machine plans no paths: its scene needs `plans_paths = true` in [service], and a number type with a floating point"
                        .into(),
                );
            }
            (Command::Hello(_), refusal) => {
                self.failure = Some(describe::refusal(&refusal, 0, &self.words));
            }
            (
                Command::Path(_),
                Refusal::QueueFull
                | Refusal::Busy
                | Refusal::Undecided
                | Refusal::Retargeting
                | Refusal::StartVelocity
                | Refusal::State(_),
            ) => {
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
            (Command::Path(_), refusal) => {
                self.refused = Some(describe::refusal(&refusal, 0, &self.words));
                self.feed.clear();
                self.piece = None;
            }
            (Command::Output { .. }, Refusal::Busy) => {
                self.orders.push_front(*command);
                self.pause = now + PAUSE;
            }
            (Command::Output { .. }, refusal)
            | (Command::OutputsAt(_), refusal @ Refusal::NoOutput { .. }) => {
                self.refused = Some(describe::refusal(&refusal, 0, &self.words));
                self.feed.clear();
                self.outputs.clear();
                self.piece = None;
            }
            // What waits is dropped: closing the door must start nothing.
            (
                Command::Probe { .. },
                Refusal::NoProbe
                | Refusal::ProbeTouches
                | Refusal::ProbeOpen
                | Refusal::DoorOpen
                | Refusal::LimitSwitch { .. },
            ) => {
                let why = describe::refusal(&refusal, 0, &self.words);
                self.probing = Some(Probing::Ended(ProbeEnd::Refused(why)));
                self.feed.clear();
                self.piece = None;
                self.order(Command::Stop);
            }
            (Command::Start, Refusal::DoorOpen | Refusal::LimitSwitch { .. }) => {
                self.refused = Some(describe::refusal(&refusal, 0, &self.words));
                self.feed.clear();
                self.piece = None;
                self.order(Command::Stop);
            }
            // Too early or too late: the next status says what holds.
            _ => {
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
        }
    }
}

/// The tool point moves along the path, or may.
fn moves(state: State) -> bool {
    matches!(state, State::Running | State::Slowing | State::Stopping)
}

/// Straight, slow motion with the tool off.
fn way_to(to: ToolPlace) -> Element {
    Element {
        line: 0,
        tool: None,
        act: Act::Motion(ToolMotion {
            curve: ToolCurve::Line,
            to,
            feed_m_s: Some(HOME_M_S),
            stops: true,
        }),
    }
}

pub(super) fn place_of(pose: &Pose<f64>) -> ToolPlace {
    ToolPlace {
        position_m: pose.position.into(),
        alpha_rad: pose.angle,
    }
}
