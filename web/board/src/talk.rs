//! Conversation with a board in its number type: one client after the other, over the same line.

use crate::scene::TalkScene;
use crate::{BoardCommand, BoardView};
use std::time::Duration;
use trirrr_client::describe::{self, Units};
use trirrr_client::{
    Dialogue, GoalClient, GoalFailure, JobClient, JobWork, ManualClient, Patience, Turn,
    UserCommand,
};
use trirrr_core::setpoint::Pose;
use trirrr_line::Frames;
use trirrr_protocol::message::{
    Command, DriveSample, Event, Goal, Hello, Identity, Message, PROTOCOL, Recovery, Refusal,
    Request, State, Status, Telemetry, Transmit,
};
use trirrr_protocol::wire::schema;
use trirrr_scene::{CarriedTools, JobOutputs, NumberType, in_number_type, offer};

/// Samples of a second: as many as a person sees.
const SAMPLES_HZ: f64 = 25.0;

/// Duration of a recovery, s.
const RECOVERY_S: f64 = 2.0;

/// Fastest that D moves and the platform turns in a step by hand, m/s and rad/s.
const STEP_M_S: f64 = 0.05;
const STEP_RAD_S: f64 = 0.5;

/// Numbers of conversations that one client may use for hellos.
const HELLOS: u32 = 1 << 12;

/// Client that talks.
pub(crate) enum Talking<N: Transmit> {
    /// Commands by hand.
    Manual(Box<ManualClient<N>>),
    /// The scene's job.
    Job(Box<JobClient<N>>),
    /// Steps by hand.
    Steps(Box<GoalClient<N>>),
}

/// End of a client, whichever it is, in words.
enum ClientEnd {
    /// The client has nothing more to do, for this reason.
    Over(String),
    /// The board does not talk with this page.
    Closed(String),
}

/// Conversation with a board, without a port and a clock.
pub(crate) trait Talk {
    /// Appends what is to be sent at `now` to `out`. Returns the time until which nothing is to be done unless something comes.
    fn poll(&mut self, now: Duration, out: &mut Vec<u8>) -> Duration;
    /// Takes bytes of the board.
    fn receive(&mut self, bytes: &[u8], now: Duration);
    /// Gives a command.
    fn command(&mut self, command: BoardCommand) -> Result<(), String>;
    /// Moves by a step from where the last one ends, m and rad.
    fn step(&mut self, by: [f64; 3]) -> Result<(), String>;
    /// Brings the machine to rest, whatever it does.
    fn halt(&mut self);
    /// Takes the sentences out that came since the last call.
    fn take_notes(&mut self) -> Vec<String>;
    /// State of the machine as far as it is known.
    fn view(&self) -> BoardView;
}

/// A board that computes in `N`.
pub(crate) struct BoardTalk<N: Transmit> {
    name: String,
    number: NumberType,
    hello: Hello,
    pub(crate) work: JobWork<N>,
    /// Spare outputs that change with its moves.
    outputs: JobOutputs,
    /// Tools, and the one that the job is for.
    tools: Option<CarriedTools>,
    start: Pose<N>,
    pub(crate) has_homing: bool,
    pub(crate) units: Units,
    samples: u16,
    pub(crate) talking: Talking<N>,
    frames: Frames,
    /// Of the next client.
    conversation: u32,
    identity: Option<Identity>,
    pub(crate) status: Option<Status<N>>,
    pub(crate) sample: Option<Telemetry<N>>,
    pub(crate) drives: Option<DriveSample<N>>,
    /// Pose at the end of the last step, SI.
    aimed: Option<[f64; 3]>,
    is_way_told: bool,
    pub(crate) is_silent: bool,
    pub(crate) closed: Option<String>,
    notes: Vec<String>,
}

/// Key of the messages of a board that computes in `number`.
fn schema_key(number: NumberType) -> u64 {
    in_number_type!(number, N => schema::key::<Request<N>, Message<N>>())
}

impl<N: Transmit> BoardTalk<N> {
    /// Prepares the conversation with the board of `scene`.
    pub(crate) fn new(scene: TalkScene, conversation: u32) -> Self {
        let hello = Hello {
            protocol: PROTOCOL,
            schema: schema_key(scene.number),
            scene: scene.key,
        };
        let samples = (scene.units.tick_rate_hz / SAMPLES_HZ).round();
        // From float to integer the cast saturates.
        let samples = samples.max(1.0) as u16;
        let moves = offer::moves_in_units::<N>(&scene.moves);
        Self {
            name: scene.name,
            number: scene.number,
            hello,
            work: JobWork::of(moves, &scene.levels),
            outputs: scene.outputs,
            tools: scene.tools,
            start: offer::pose(&scene.start),
            has_homing: scene.has_homing,
            units: scene.units,
            samples,
            talking: Talking::Manual(manual(hello, samples, conversation)),
            frames: Frames::default(),
            conversation: conversation.wrapping_add(HELLOS),
            identity: None,
            status: None,
            sample: None,
            drives: None,
            aimed: None,
            is_way_told: false,
            is_silent: false,
            closed: None,
            notes: Vec::new(),
        }
    }
}

/// A client for commands by hand. It takes any scene: that of the board is compared by name.
fn manual<N: Transmit>(hello: Hello, samples: u16, conversation: u32) -> Box<ManualClient<N>> {
    let hello = Hello { scene: 0, ..hello };
    Box::new(ManualClient::new(
        hello,
        samples,
        Patience::default(),
        conversation,
    ))
}

impl<N: Transmit> BoardTalk<N> {
    /// Number of a new conversation.
    fn next_conversation(&mut self) -> u32 {
        let conversation = self.conversation;
        self.conversation = conversation.wrapping_add(HELLOS);
        conversation
    }

    fn take_hands(&mut self) {
        let conversation = self.next_conversation();
        self.talking = Talking::Manual(manual(self.hello, self.samples, conversation));
        self.aimed = None;
        // A step begins where the machine stands now: the next status says where.
        if let Some(status) = &mut self.status {
            status.end = None;
        }
    }

    fn play(&mut self, attached: bool) {
        let (work, conversation) = (self.work.clone(), self.next_conversation());
        let patience = Patience::default();
        let client = JobClient::new(work, self.hello, self.samples, patience, conversation);
        let client = client.named(&self.name).without_homing();
        let client = client.with_drives(self.samples);
        let client = client
            .with_tools(self.tools.clone())
            .with_outputs(&self.outputs);
        self.talking = Talking::Job(Box::new(match attached {
            true => client.attached((0, None)),
            false => client,
        }));
        self.is_way_told = false;
    }

    fn turn(&mut self, now: Duration) -> Turn<N, ClientEnd> {
        match &mut self.talking {
            Talking::Manual(client) => {
                let turn = client.poll(now);
                turn.map(|refusal| ClientEnd::Closed(self.why_closed(&refusal)))
            }
            Talking::Job(client) => {
                let turn = client.poll(now);
                turn.map(|end| {
                    ClientEnd::Over(match end {
                        Ok(()) => "the job is played to its end".into(),
                        Err(failure) => client.describe(&failure),
                    })
                })
            }
            Talking::Steps(client) => {
                if let Some(violation) = client.take_refused() {
                    self.aimed = None;
                    let why = describe::violation(&violation, 0, &self.units);
                    self.notes.push(format!("no motion to the goal: {why}"));
                }
                let why = |failure: GoalFailure<N>| failure.describe(&self.units);
                let turn = client.poll(now);
                turn.map(|end| ClientEnd::Over(end.err().map_or_else(String::new, why)))
            }
        }
    }

    fn why_closed(&self, refusal: &Refusal<N>) -> String {
        if let Refusal::Schema { expected } = refusal
            && let Some(number) = describe::board::number_type(*expected)
        {
            return format!(
                "the board computes in {number}, the scene in {}: write number = \"{number}\" into the scene, or build the board's image from it",
                self.number
            );
        }
        describe::refusal(refusal, 0, &self.units)
    }

    /// Compares the scene of the board with that of the page.
    fn meet(&mut self, identity: &Identity) {
        let board = describe::board::name(&identity.name);
        if identity.scene != self.hello.scene {
            let text = match board == self.name {
                true => format!(
                    "the board was built from another version of the scene {board} (key {:#010x}, here {:#010x}): open that version, or \
                     build the board's image from this one",
                    identity.scene, self.hello.scene
                ),
                false => format!(
                    "the board has the scene {board}, the page shows {}: open {board}",
                    self.name
                ),
            };
            self.closed = Some(text);
        } else if self.identity.is_none() {
            self.notes.push(format!(
                "connected: scene {board} in {}, {} ticks per second; firmware {}",
                self.number,
                identity.tick_rate_hz,
                describe::board::firmware(&identity.firmware)
            ));
            let start = &identity.board.start;
            if start.is_failure() {
                let why = describe::board::start(start);
                self.notes.push(format!("the board started anew: {why}"));
            }
            let oddities = [
                describe::board::clock(identity.board.clock),
                describe::board::reference(identity.reference),
            ];
            self.notes
                .extend(oddities.into_iter().flatten().map(String::from));
        }
        self.identity = Some(identity.clone());
    }

    fn note_event(&mut self, event: &Event<N>) {
        // Each move that the machine begins would be a line.
        let is_told = match event {
            Event::State { state, acting, .. } => self
                .status
                .as_ref()
                .is_some_and(|status| (status.state, status.acting) == (*state, *acting)),
            _ => false,
        };
        if let (Event::State { state, acting, .. }, Some(status)) = (event, &mut self.status) {
            (status.state, status.acting) = (*state, *acting);
        }
        if !is_told && let Some(text) = describe::event(event, 0, &self.units) {
            self.notes.push(text);
        }
    }

    /// Takes over what the client has learnt.
    fn learn(&mut self) {
        let (identity, status) = match &self.talking {
            Talking::Manual(client) => (client.identity(), client.status()),
            Talking::Job(client) => (client.identity(), client.status()),
            Talking::Steps(client) => (client.identity(), client.status()),
        };
        let identity = identity.cloned();
        if let Some(status) = status {
            let fresh = self.status.is_none();
            let not_enabled = self.status.as_ref().and_then(|status| status.not_enabled);
            let (state, acting) = (status.state, status.acting);
            if fresh {
                self.notes.push(describe::state(state, acting));
                let fault = status.fault.as_ref();
                let fault = fault.map(|fault| describe::fault(fault, &self.units));
                self.notes
                    .extend(fault.map(|fault| format!("fault: {fault}")));
            }
            if let Some(why) = status
                .not_enabled
                .filter(|_| status.not_enabled != not_enabled)
            {
                let why = describe::not_enabled(&why);
                self.notes.push(format!("not enabled: {why}"));
            }
            self.status = Some(*status);
        }
        if let Talking::Job(client) = &self.talking
            && let (Some(way), Some(identity)) = (client.way(), client.identity())
            && !std::mem::replace(&mut self.is_way_told, true)
        {
            let seconds = f64::from(way.ticks) / identity.tick_rate_hz;
            self.notes.push(format!(
                "the machine goes to the start of the job first, straight, with the tool off: {seconds} s"
            ));
        }
        if let Some(identity) = identity.filter(|identity| Some(identity) != self.identity.as_ref())
        {
            self.meet(&identity);
        }
    }

    pub(crate) fn state(&self) -> Option<State> {
        self.status.as_ref().map(|status| status.state)
    }

    /// Gives a command of the user to whichever client talks.
    fn pass(&mut self, command: UserCommand) {
        match &mut self.talking {
            Talking::Manual(client) => client.command(command.into()),
            Talking::Job(client) => client.command(command),
            Talking::Steps(client) => client.command(command),
        }
    }

    fn by_hand(&mut self, command: Command<N>) {
        if let Talking::Manual(client) = &mut self.talking {
            client.command(command);
        }
    }

    /// Pose where the last step ends, or the machine's own motion, SI.
    fn end(&self) -> Option<[f64; 3]> {
        self.aimed
            .or_else(|| Some(self.pose(&self.status.as_ref()?.end?)))
    }
}

impl<N: Transmit> Talk for BoardTalk<N> {
    fn poll(&mut self, now: Duration, out: &mut Vec<u8>) -> Duration {
        loop {
            self.learn();
            if self.closed.is_some() {
                return Duration::MAX;
            }
            match self.turn(now) {
                Turn::Send(request) => Frames::append(&request, out),
                Turn::Wait(until) => return until,
                Turn::Done(ClientEnd::Closed(why)) => self.closed = Some(why),
                Turn::Done(ClientEnd::Over(text)) => {
                    if !text.is_empty() {
                        self.notes.push(text);
                    }
                    self.take_hands();
                }
                Turn::Reconnect => {
                    if !std::mem::replace(&mut self.is_silent, true) {
                        self.notes.push("the board does not answer".into());
                    }
                    match &mut self.talking {
                        Talking::Manual(client) => client.reconnected(),
                        Talking::Job(client) => client.reconnected(),
                        // Nobody waits any more for a step that was asked for some time ago.
                        Talking::Steps(_) => self.take_hands(),
                    }
                }
            }
        }
    }

    fn receive(&mut self, bytes: &[u8], now: Duration) {
        let mut messages: Vec<Message<N>> = Vec::new();
        self.frames.receive(bytes, |message| messages.push(message));
        for message in &messages {
            if std::mem::take(&mut self.is_silent) {
                self.notes.push("the board answers again".into());
            }
            match message {
                Message::Event(event) => self.note_event(event),
                Message::Telemetry(sample) => self.sample = Some(*sample),
                Message::Drives(sample) => self.drives = Some(*sample),
                Message::Reply { .. } => {}
            }
            match &mut self.talking {
                Talking::Manual(client) => {
                    client.receive(message, now);
                    if let Some(refusal) = client.take_refused() {
                        let why = describe::refusal(&refusal, 0, &self.units);
                        self.notes.push(format!("refused: {why}"));
                    }
                }
                Talking::Job(client) => client.receive(message, now),
                Talking::Steps(client) => client.receive(message, now),
            }
        }
        self.learn();
    }

    fn command(&mut self, command: BoardCommand) -> Result<(), String> {
        if let Some(why) = self.hindrance(command) {
            return Err(why.into());
        }
        match command {
            BoardCommand::Enable => self.by_hand(Command::Enable),
            BoardCommand::Acknowledge => self.by_hand(Command::ClearFault),
            BoardCommand::Disable => self.pass(UserCommand::Disable),
            BoardCommand::Hold => self.pass(UserCommand::Hold),
            BoardCommand::Stop => self.pass(UserCommand::Stop),
            BoardCommand::Run => self.play(false),
            BoardCommand::Resume => match &self.talking {
                // A job that was begun before: its client supplies the rest of its moves.
                Talking::Manual(_) => {
                    self.play(true);
                    self.pass(UserCommand::Resume);
                }
                _ => self.pass(UserCommand::Resume),
            },
            BoardCommand::Home => {
                let ticks = (RECOVERY_S * self.units.tick_rate_hz).round() as u32;
                self.by_hand(match self.has_homing {
                    true => Command::Home,
                    false => Command::Recover(Recovery {
                        to: self.start,
                        ticks,
                    }),
                });
            }
            BoardCommand::Step => return Err("a step has a length".into()),
        }
        Ok(())
    }

    fn step(&mut self, by: [f64; 3]) -> Result<(), String> {
        let is_stepping = matches!(self.talking, Talking::Steps(_));
        if let Some(why) = self.hindrance(BoardCommand::Step).filter(|_| !is_stepping) {
            return Err(why.into());
        }
        let end = self
            .end()
            .ok_or("the machine has not said yet where it stands")?;
        let pose = [0, 1, 2].map(|axis| end[axis] + by[axis]);
        let [x, y, turn] = by;
        let seconds = (x.hypot(y) / STEP_M_S).max(turn.abs() / STEP_RAD_S);
        let goal = Goal {
            to: Pose::from_f64(
                pose[0] / self.units.length_m,
                pose[1] / self.units.length_m,
                pose[2],
            ),
            velocity: [N::ZERO; 3],
            cut: true,
            least_ticks: (seconds * self.units.tick_rate_hz).round() as u32,
        };
        if !is_stepping {
            let conversation = self.next_conversation();
            let client = GoalClient::new(self.hello, Patience::default(), conversation);
            self.talking = Talking::Steps(Box::new(client));
        }
        if let Talking::Steps(client) = &mut self.talking {
            client.aim(goal);
            client.finish();
        }
        self.aimed = Some(pose);
        Ok(())
    }

    fn halt(&mut self) {
        let is_step = matches!(self.talking, Talking::Steps(_));
        match self.state() {
            Some(State::Running) if !is_step => self.pass(UserCommand::Hold),
            // It is pressed again: the job is not lost by that.
            Some(State::Slowing | State::Holding) if !is_step => {}
            _ => self.pass(UserCommand::Stop),
        }
        if is_step {
            self.aimed = None;
        }
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    fn view(&self) -> BoardView {
        self.shown()
    }
}
