//! Plays a job on a machine: hello, moves as the machine has room for them, start, and an eye on the
//! job to its end.

mod levels;
mod phase;
mod progress;
mod reply;
mod schedule;
mod status;
mod supply;
mod work;

use crate::describe::Units;
use crate::dialogue::{Dialogue, Turn};
use crate::exchange::{Exchange, Patience};
use crate::user_commands::{UserCommand, UserCommands};
use crate::wake::{Clears, Wake};
use crate::{BegunJob, JobFailure, JobMark, JobPlace};
use phase::{Next, Phase};
use progress::JobProgress;
use schedule::Schedule;
use std::time::Duration;
pub use supply::{MoveChecksum, SuppliedMoves};
use trirrr_protocol::message::{
    Acting, Command, Event, Hello, Identity, JobLabel, Message, Move, Reply, Request, State,
    Status, Telemetry, TelemetryFields, Transmit,
};
use trirrr_scene::{CarriedTools, JobOutputs};
pub use work::{JobWork, switched_label};

/// Client that plays one job on a machine, without a port and a clock of its own.
#[derive(Clone, Debug)]
pub struct JobClient<N: Transmit> {
    exchange: Exchange<N>,
    hello: Hello,
    /// Name of the job.
    label: JobLabel,
    /// Tools of the scene, and the one that the job is for.
    tools: Option<CarriedTools>,
    /// Ticks from one telemetry sample to the next,
    telemetry: u16,
    /// and what is in it.
    fields: TelemetryFields,
    /// The same of the drives, where they tell something.
    drives: Option<u16>,
    progress: JobProgress<N>,
    identity: Option<Identity>,
    status: Option<Status<N>>,
    /// Request with which the machine has taken moves last, in this conversation.
    last_taken: Option<u32>,
    /// Dry ticks of the machine at the first status.
    dry_before: u32,
    approach: Approach<N>,
    user: User,
    schedule: Schedule,
    phase: Phase<N>,
    /// The machine has the name of the job: moves are of it.
    is_named: bool,
    /// The machine had the job that another client has begun.
    has_joined: bool,
    /// Last place that a sample has told, with the tool of the job allowed.
    reached: JobPlace,
}

/// Means to bring the machine to the start of the job.
#[derive(Clone, Debug)]
struct Approach<N: Transmit> {
    /// Way of a machine to readiness. A machine that is not homed may be homed.
    wake: Wake<N>,
    /// Duration of the way to the start of the job, s. `None` without such a way, and once the
    /// machine is on it.
    recovery_s: Option<f64>,
    /// The client has enabled the machine, and waits until it is on.
    is_enabling: bool,
    /// The client has seen where the machine stands.
    is_near: bool,
    /// The straight way to the start of the job, which the machine has taken.
    way: Option<Move<N>>,
    /// The machine has begun the job for another client: items that it had taken, as far as that one knew, and the number of its first move.
    attachment: Option<BegunJob>,
}

/// Commands of the user.
#[derive(Clone, Debug, Default)]
struct User {
    commands: UserCommands,
    /// The machine has executed a stop.
    has_stopped: bool,
}

impl<N: Transmit> JobClient<N> {
    /// Creates the client of a job of `work`, moves or a path, for a machine that is what `hello` says, with a telemetry
    /// sample every `telemetry` ticks.
    ///
    /// The client replaces the numbers of the moves by those that the machine expects. Another
    /// conversation with the machine should have another number `conversation`.
    pub fn new(
        work: impl Into<JobWork<N>>,
        hello: Hello,
        telemetry: u16,
        patience: Patience,
        conversation: u32,
    ) -> Self {
        let work = work.into();
        Self {
            exchange: Exchange::new(patience, conversation),
            hello,
            label: work.label(""),
            tools: None,
            telemetry,
            fields: TelemetryFields::ALL,
            drives: None,
            progress: JobProgress::new(work),
            identity: None,
            status: None,
            last_taken: None,
            dry_before: 0,
            approach: Approach {
                wake: Wake::new(Clears::Nothing, true, None),
                recovery_s: None,
                is_enabling: false,
                is_near: false,
                way: None,
                attachment: None,
            },
            user: User::default(),
            schedule: Schedule::new(),
            phase: Phase::Greeting,
            is_named: false,
            has_joined: false,
            reached: JobPlace::default(),
        }
    }

    /// Leaves a machine that is not homed as it is, which ends the job before it begins.
    #[must_use]
    pub fn without_homing(mut self) -> Self {
        self.approach.wake.homes = false;
        self
    }

    /// Acknowledges a fault that was latched before the job, and brings the machine to the start of
    /// the job. A machine that is not homed is homed; any other moves there in `seconds`.
    #[must_use]
    pub fn with_recovery(mut self, seconds: f64) -> Self {
        self.approach.recovery_s = Some(seconds);
        self.approach.wake.clears = Clears::Hindrances;
        self
    }

    /// Gives the job a name, for whoever asks the machine what it plays: ASCII, cut where it is longer than 32 bytes.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        self.label.name = trirrr_service::name(name);
        self
    }

    /// Lets spare outputs change with the moves of the job, as `outputs` says. Not of a path that the machine plans: its moves are not known
    /// here.
    #[must_use]
    pub fn with_outputs(mut self, outputs: &JobOutputs) -> Self {
        self.label = switched_label(self.label, outputs);
        self.progress.set_outputs(outputs);
        self
    }

    /// Has the machine tell its platform first: a job is not begun on one that carries another tool than it is for. A job that
    /// another client has [begun](Self::attached) is not asked: it was begun with this tool.
    #[must_use]
    pub fn with_tools(mut self, tools: Option<CarriedTools>) -> Self {
        self.tools = tools;
        self
    }

    /// Asks for samples with `fields` only. Others are 0 in them.
    #[must_use]
    pub fn with_fields(mut self, fields: TelemetryFields) -> Self {
        self.fields = fields;
        self
    }

    /// Goes on with a job that another client has begun: the job of the same name, with the same items, of which the machine has the part
    /// `begun` or more. The same job may have been played before: the number of its first move tells them apart. A machine that waits for its
    /// host is resumed, and goes on at the very place. One that has lost the job ends it: [`JobFailure::Restarted`], [`JobFailure::OtherJob`],
    /// [`JobFailure::Dropped`].
    #[must_use]
    pub fn attached(mut self, begun: BegunJob) -> Self {
        self.approach.attachment = Some(begun);
        self
    }

    /// Returns true if the client has found the machine with the job that it [goes on with](Self::attached): what ends the job from then on is
    /// another end of it.
    pub fn has_joined(&self) -> bool {
        self.has_joined
    }

    /// Returns the way to the start of the job that the machine has taken, while it is on it.
    pub fn way(&self) -> Option<&Move<N>> {
        self.approach.way.as_ref()
    }

    /// Returns the failure by which the job has ended.
    pub fn failure(&self) -> Option<&JobFailure<N>> {
        match &self.phase {
            Phase::Finished(Err(failure)) => Some(failure),
            _ => None,
        }
    }

    /// Returns the place of the job at which it lost its tool: at a stop, a fault or an open door. The machine stands behind it.
    pub fn interrupted(&self) -> Option<JobPlace> {
        self.left(self.status.as_ref()?)
    }

    /// The same as of `status`. On the way to its start the machine has nothing of the job.
    fn left(&self, status: &Status<N>) -> Option<JobPlace> {
        let interruption = status.interrupted.filter(|_| self.is_named)?;
        Some(JobPlace {
            index: self.index(interruption.number)?,
            at: interruption.at,
        })
    }

    /// Returns the last place of the job that was played with its tool, as far as known: where a job that is lost goes on.
    pub fn reached(&self) -> JobPlace {
        self.interrupted().unwrap_or(self.reached)
    }

    /// Returns the number of the job's first move on the machine, once the machine has the name of the job. No other job has it.
    pub fn first_move(&self) -> Option<u32> {
        self.is_named.then(|| self.progress.first_move())?
    }

    /// Asks for a sample of the drives every `every` ticks, too. A machine whose drives tell nothing plays the job without.
    #[must_use]
    pub fn with_drives(mut self, every: u16) -> Self {
        self.drives = Some(every);
        self
    }

    /// Asks for the status every `interval`, at least.
    #[must_use]
    pub fn with_status_every(mut self, interval: Duration) -> Self {
        self.schedule.limit(interval);
        self
    }

    /// Returns the identity of the machine that answered.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Returns the last status.
    pub fn status(&self) -> Option<&Status<N>> {
        self.status.as_ref()
    }

    /// Returns the number of moves of the job, or of pieces.
    pub fn moves(&self) -> u32 {
        self.progress.items()
    }

    /// Returns the word for what the job is made of: a move, or a piece.
    pub fn item(&self) -> &'static str {
        match self.progress.is_path() {
            true => "piece",
            false => "move",
        }
    }

    /// Returns the number of moves, or of pieces, that the machine has taken.
    pub fn offered(&self) -> u32 {
        self.progress.has_taken()
    }

    /// Returns the number of moves played to their end, as of the last status; that of pieces where all are.
    pub fn done(&self) -> u32 {
        let status = self.status.as_ref();
        status.map_or(0, |status| self.done_of(status))
    }

    /// The same as of `status`. The machine counts moves on its way to rest as over.
    fn done_of(&self, status: &Status<N>) -> u32 {
        let done = self.progress.done(status);
        self.left(status)
            .map_or(done, |place| done.min(place.index))
    }

    /// Returns the index, counted from 0, of the move that the machine calls `number`.
    pub fn index(&self, number: u32) -> Option<u32> {
        self.progress.index(number)
    }

    /// Returns true if `sample` is the last of the job: at the end of the last move.
    pub fn is_last(&self, sample: &Telemetry<N>) -> bool {
        let index = self.index(sample.number);
        index.is_some_and(|index| {
            let ticks = self.progress.get(index).map(|each| each.ticks);
            index + 1 == self.moves() && ticks == Some(sample.at) && sample.part == 0
        })
    }

    /// Returns the ticks in which the machine waited for moves since the conversation began: its queue was empty.
    pub fn dry_ticks(&self) -> u32 {
        let dry = self.status.as_ref().map(|status| status.dry_ticks);
        dry.map_or(0, |dry| dry.wrapping_sub(self.dry_before))
    }

    /// Returns the moves that the machine holds behind the one under way, and the most that it holds, as of the last status.
    pub fn queued(&self) -> Option<[u16; 2]> {
        let (identity, status) = (self.identity.as_ref()?, self.status.as_ref()?);
        Some([identity.queue.saturating_sub(status.room), identity.queue])
    }

    /// Returns the number of requests that had to be sent again.
    pub fn repeated(&self) -> u64 {
        self.exchange.repeated()
    }

    /// Describes `failure` in words and SI units.
    pub fn describe(&self, failure: &JobFailure<N>) -> String {
        if let (JobFailure::OtherTool(found), Some(tools)) = (failure, &self.tools) {
            return tools.complaint(*found);
        }
        // Before a hello nothing with a unit is reported.
        let units = self.identity.as_ref().map_or(Units::si(1.0), Units::of);
        let about = failure.index().and_then(|index| self.progress.get(index));
        failure.describe(self.item(), about.map_or(0, |each| each.ticks), &units)
    }

    /// Takes a command of the user. The command goes before everything but the open request. A stop of a machine that has not told its status
    /// yet ends the job at once: nothing of it was begun.
    pub fn command(&mut self, command: UserCommand) {
        let is_fresh = self.status.is_none() && self.approach.attachment.is_none();
        match command {
            UserCommand::Stop if is_fresh && self.failure().is_none() => {
                self.phase = Phase::Finished(Err(JobFailure::Stopped { done: 0 }));
            }
            command => self.user.commands.push(command),
        }
    }

    /// Takes note of the place of a sample, if the tool of the job is allowed there: not on a ramp to rest behind a stop, a fault or a door.
    fn on_sample(&mut self, sample: &Telemetry<N>) {
        let plays = match sample.state {
            State::Running => true,
            State::Slowing | State::Holding => sample.acting != Acting::Door,
            _ => false,
        };
        if let Some(index) = self.index(sample.number).filter(|_| plays && self.is_named) {
            let at = sample.at;
            self.reached = self.reached.max(JobPlace { index, at });
        }
    }

    fn enter(&mut self, phase: Phase<N>) {
        if matches!(phase, Phase::Ending(_)) {
            self.schedule.hurry();
        }
        self.phase = phase;
    }
}

impl<N: Transmit> Dialogue<N> for JobClient<N> {
    /// The job was played to its end, or the reason why not.
    type End = Result<(), JobFailure<N>>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        loop {
            if let Phase::Finished(result) = &self.phase {
                return Turn::Done(*result);
            }
            let due = match self.exchange.poll(now) {
                Turn::Wait(until) if self.goes_on() => until,
                Turn::Done(()) => Duration::MAX,
                turn => return turn.map(Ok),
            };
            match self.next(now) {
                Next::Ask(Command::Hello(hello)) => self.exchange.greet(hello, now),
                Next::Ask(command) => self.exchange.ask(command, now),
                Next::Listen(until) => return Turn::Wait(until.min(due)),
            }
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(event) = message {
            // An event is a hint: it may be late, or come twice. The status says what holds.
            let is_news = match (event, &mut self.status) {
                (Event::State { state, .. }, Some(status)) => {
                    std::mem::replace(&mut status.state, *state) != *state
                }
                (Event::Inputs(inputs), Some(status)) => {
                    std::mem::replace(&mut status.inputs, *inputs) != *inputs
                }
                (Event::Verdict(verdict), _) => verdict.violation.is_some(),
                _ => true,
            };
            match is_news {
                true => self.schedule.look_at(now),
                false => self.schedule.look_soon(now),
            }
            return;
        }
        if let Message::Telemetry(sample) = message {
            return self.on_sample(sample);
        }
        let Some((Request { sequence, command }, reply)) = self.exchange.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => self.on_hello(identity),
            Reply::Status(status) => self.on_status(sequence, status, now),
            Reply::Refused(refusal) => self.on_refusal(&command, refusal, now),
            Reply::Done => {
                self.user.commands.settle(&command);
                if command.offered().is_some() {
                    self.last_taken = Some(sequence);
                }
                self.on_done(&command, now);
            }
            Reply::Section(section) => self.on_section(&section),
            // The exchange has the first, and the client asks for no other.
            Reply::Kept { .. } | Reply::Update(_) => {}
        }
    }

    fn stop(&mut self) {
        self.command(UserCommand::Stop);
    }

    /// The job goes on where it is.
    fn reconnected(&mut self) {
        if !matches!(self.phase, Phase::Ending(_) | Phase::Finished(_)) {
            self.phase = Phase::Greeting;
        }
        self.user.commands.recall();
        self.exchange.forget();
    }
}

#[cfg(test)]
mod tests;

impl JobMark {
    /// Takes in what `client` knows. `place` tells the place on the whole job of one on the moves of the client.
    pub fn note<N: Transmit>(
        &mut self,
        client: &JobClient<N>,
        place: impl Fn(JobPlace) -> JobPlace,
    ) {
        // A client that has not found the job knows less than the mark.
        if let Some(first_move) = client.first_move() {
            (self.taken, self.first_move) = (client.offered(), Some(first_move));
            self.reached = self.reached.max(place(client.reached()));
        }
    }
}
