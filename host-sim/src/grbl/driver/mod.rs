//! Machine behind a sender: pieces of its path, orders, and what the machine tells.

mod hold;
mod probing;
mod refusals;
mod waking;

use super::inputs::ProgramInputs;
use super::outputs::ProgramOutputs;
use super::path::{MOTIONS, PathFeed, QueuedPiece};
use hold::Holds;
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_client::describe::{self, Units as Words};
use trirrr_client::{Conversation, Dialogue, Patience, Turn, status_interval};
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_grbl::{ContactsView, MachineAct, MachinePhase, MachineView, ProbeEnd};
use trirrr_line::LostLine;
use trirrr_protocol::message::{
    Command, Event, Hello, InputState, InputStates, Message, PathPiece, Reply, State, Status,
    TelemetryFields, Transmit,
};
use trirrr_scene::{Scene, offer};
use trirrr_toolpath::ToolPlace;
use waking::Waking;

/// Longest time from one status to the next.
const STATUS_EVERY: Duration = Duration::from_millis(20);

/// Time until a request is made again that the machine did not take yet.
const PAUSE: Duration = Duration::from_millis(4);

/// Age at which a sample counts no more: a machine that is off may send none.
const SAMPLE_AGE: Duration = Duration::from_millis(300);

/// Samples a second: senders ask for five to twenty reports.
const SAMPLES_HZ: f64 = 25.0;

/// Moves that wait before a path that still grows is begun. The machine may want more of them: those that come to rest.
const HEAD_START: u32 = 24;

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
    conversation: Conversation<N>,
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
    /// Time from one status to the next.
    every: Duration,
    look: Duration,
    pause: Duration,
    /// Time before which no order is asked: the machine had no room for the one before.
    busy: Duration,
    /// Moves that the machine had when it refused a start as too early.
    early: Option<u32>,
    waking: Option<Waking<N>>,
    holds: Holds,
    /// The door is or was open, and the sender does not know yet.
    is_door_hold: bool,
    /// Reason for which the line to the machine is lost.
    lost: Option<String>,
    /// Most moves for which there was room.
    queue: u16,
    reason: Option<String>,
    refused: Option<String>,
    was_refused: bool,
    probing: Option<Probing>,
    /// The machine cannot serve senders at all.
    failure: Option<String>,
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
            conversation: Conversation::new(hello, patience, conversation),
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
            every: STATUS_EVERY,
            look: Duration::ZERO,
            pause: Duration::ZERO,
            busy: Duration::ZERO,
            early: None,
            waking: None,
            holds: Holds::default(),
            is_door_hold: false,
            lost: None,
            queue: 0,
            reason: None,
            refused: None,
            was_refused: false,
            probing: None,
            failure: None,
        }
    }

    /// The machine as it is known now, with the changes of its inputs since the view before.
    pub(super) fn view(&mut self) -> MachineView {
        let inputs = self
            .status
            .map_or(InputStates::ABSENT, |status| status.inputs);
        MachineView {
            phase: self.phase(),
            reason: self.lost.clone().or_else(|| self.reason.clone()),
            place: self.place,
            speed_m_s: self.speed_m_s,
            power: self.power,
            room: match self.waking {
                Some(_) => 0,
                None => self.feed.room(),
            },
            free: self.free(),
            stands: self.is_settled && self.status.is_some_and(|status| stands(status.state)),
            is_empty: self.is_empty(),
            contacts: ContactsView {
                door: inputs.door.is_active(),
                probe: inputs.probe.is_active(),
                limits: inputs.limits.map(InputState::is_active),
            },
            is_door_hold: self.is_door_hold,
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

    /// Reason for which the line to the machine is lost.
    pub(super) fn why_lost(&self) -> Option<&str> {
        self.lost.as_deref()
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

    /// Returns true while the machine comes to rest.
    pub(super) fn is_stopping(&self) -> bool {
        let states = [State::Slowing, State::Stopping, State::Disabling];
        self.status
            .is_some_and(|status| states.contains(&status.state))
    }

    /// Motions for which there is room, in the machine, too.
    fn free(&self) -> usize {
        let room = self.status.map_or(0, |status| status.room);
        let share = MOTIONS * usize::from(room) / usize::from(self.queue.max(1));
        match self.is_empty() {
            true => MOTIONS,
            false => self.feed.room().min(share).min(MOTIONS - 1),
        }
    }

    fn phase(&self) -> MachinePhase {
        if self.lost.is_some() {
            return MachinePhase::Lost;
        }
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
                self.begin_waking(act == MachineAct::Home);
            }
            MachineAct::Sleep => self.order(Command::Disable),
            MachineAct::Hold => self.hold(),
            MachineAct::Resume => self.resume(),
            MachineAct::Stop => {
                self.drop_holds();
                self.drop_program();
                self.order_stop();
            }
            MachineAct::Feed(percent) => {
                // The last one counts.
                let is_other = |order: &Command<N>| !matches!(order, Command::FeedOverride { .. });
                self.orders.retain(is_other);
                self.order(Command::FeedOverride { percent });
            }
        }
    }

    /// The machine does not play what it was given. It comes to rest, and drops the rest: moves before the refused one may end moving, and
    /// would wait for ever.
    fn refuse(&mut self, why: String) {
        self.refused = Some(why);
        self.feed.clear();
        self.outputs.clear();
        self.piece = None;
        self.order_stop();
    }

    /// Drops what the machine has not taken, and what it was to become.
    fn drop_program(&mut self) {
        self.feed.clear();
        self.waking = None;
        self.probing = None;
        self.outputs.clear();
        self.piece = None;
    }

    fn order(&mut self, command: Command<N>) {
        self.orders.push_back(command);
    }

    /// A stop waits for no other order, and ends what would begin a motion.
    fn order_stop(&mut self) {
        let outlasts = |order: &Command<N>| {
            matches!(
                order,
                Command::FeedOverride { .. }
                    | Command::Output { .. }
                    | Command::Telemetry { .. }
                    | Command::Disable
            )
        };
        self.orders.retain(outlasts);
        self.orders.push_front(Command::Stop);
    }

    fn next(&mut self, now: Duration) -> Option<Command<N>> {
        if now >= self.busy
            && let Some(order) = self.orders.pop_front()
        {
            return Some(order);
        }
        let Some(status) = self.status.filter(|_| now < self.look) else {
            return Some(Command::Status);
        };
        if now < self.pause {
            return None;
        }
        if let Some(order) = self.hold_order(&status, now) {
            return Some(order);
        }
        if self.is_held() {
            return None;
        }
        let waits = status.state == State::Idle && status.next != status.done;
        let is_whole = !status.planning && status.admitted == status.next;
        let is_ahead =
            status.next.wrapping_sub(status.done) >= HEAD_START && self.early != Some(status.next);
        if waits && (is_whole || is_ahead) && self.is_fresh() {
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
            self.refuse("the machine plans no arc on which A bends".into());
            return None;
        };
        Some(Command::Path(PathPiece {
            number,
            last,
            ..piece
        }))
    }

    fn on_status(&mut self, status: Status<N>, now: Duration) {
        self.look = now + self.every;
        self.known = self.asked_at;
        self.status = Some(status);
        self.lost = None;
        self.queue = self.queue.max(status.room);
        self.watch_door(&status);
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
            self.refuse(why.unwrap_or_else(|| "the machine has refused the motion".into()));
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
}

impl<N: Transmit> Dialogue<N> for MachineDriver<N> {
    /// Reason why the machine cannot serve senders at all.
    type End = String;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        loop {
            if let Some(failure) = self.failure.take() {
                return Turn::Done(failure);
            }
            match self.conversation.poll(now) {
                Turn::Done(()) => {}
                turn => return turn.map(|()| String::new()),
            }
            let Some(command) = self.next(now) else {
                return Turn::Wait(self.look);
            };
            match command {
                Command::Status => self.asked_at = self.changes,
                Command::Telemetry { .. } => {}
                _ => self.changes += 1,
            }
            self.conversation.ask(command, now);
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
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
            Message::Event(Event::State { .. } | Event::Fault(_) | Event::Inputs(_)) => {
                self.look = self.look.min(now)
            }
            Message::Event(Event::Digital(states)) => self.inputs.take_event(*states),
            _ => {}
        }
        let Some((command, reply)) = self.conversation.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => {
                self.every = status_interval(STATUS_EVERY, &identity);
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
                if matches!(
                    command,
                    Command::Start | Command::Probe { .. } | Command::Resume
                ) {
                    self.started();
                }
                if let Command::OutputsAt(switch) = command {
                    self.outputs.are_told(switch.number);
                }
            }
            Reply::Refused(refusal) => self.on_refusal(&command, refusal, now),
            Reply::Section(_) | Reply::Kept { .. } | Reply::Update(_) => {}
        }
    }

    /// Brings the machine to rest and switches it off.
    fn stop(&mut self) {
        self.take(MachineAct::Stop);
        self.take(MachineAct::Sleep);
    }

    fn reconnected(&mut self) {
        self.conversation.reconnected();
    }

    /// The program is dropped; the machine stops by itself, and is told to once it is found again.
    fn lost(&mut self, why: &LostLine, _: bool) {
        self.lost = Some(format!("the line to the machine is lost: {why}"));
        self.refused = None;
        self.orders.clear();
        self.drop_program();
        self.order(Command::Stop);
    }
}

/// No motor moves.
fn stands(state: State) -> bool {
    !moves(state) && !matches!(state, State::Homing | State::Recovering | State::Reacting)
}

/// The tool point moves along the path, or may.
fn moves(state: State) -> bool {
    matches!(state, State::Running | State::Slowing | State::Stopping)
}

pub(super) fn place_of(pose: &Pose<f64>) -> ToolPlace {
    ToolPlace {
        position_m: pose.position.into(),
        alpha_rad: pose.angle,
    }
}
