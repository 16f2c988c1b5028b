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
use crate::exchange::{Exchange, Patience, Turn};
use crate::{JobFailure, JobPlace};
use phase::{Next, Phase};
use progress::JobProgress;
use schedule::Schedule;
use std::collections::VecDeque;
use std::time::Duration;
pub use supply::{MoveChecksum, SuppliedMoves};
use trirrr_protocol::message::{
    Command, Event, Hello, Identity, JobLabel, Message, Move, Reply, Request, Status, Telemetry,
    TelemetryFields, Transmit,
};
use trirrr_scene::{CarriedTools, JobOutputs};
pub use work::{JobWork, switched_label};

/// Next act of the owner of the port.
#[derive(Clone, Debug, PartialEq)]
pub enum Action<N: Transmit> {
    /// Send this to the machine.
    Send(Request<N>),
    /// Listen; unless something comes, nothing is to be done before this time.
    Wait(Duration),
    /// The machine does not answer: open the port anew and call [`JobClient::reconnected`], or give
    /// up.
    Lost,
    /// The job has ended: played to its end, or why not.
    Finished(Result<(), JobFailure<N>>),
}

/// Command of the user while the job runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UserCommand {
    /// Come to rest on the path.
    Hold,
    /// Go on.
    Resume,
    /// Come to rest on the path and drop the rest.
    Stop,
    /// Come to rest as by a stop, then switch the drives off.
    Disable,
    /// Play at so many percent of normal speed, 1 to 100, from now on.
    FeedOverride(u8),
}

impl<N: Transmit> From<UserCommand> for Command<N> {
    fn from(command: UserCommand) -> Self {
        match command {
            UserCommand::Hold => Self::Hold,
            UserCommand::Resume => Self::Resume,
            UserCommand::Stop => Self::Stop,
            UserCommand::Disable => Self::Disable,
            UserCommand::FeedOverride(percent) => Self::FeedOverride { percent },
        }
    }
}

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
}

/// Means to bring the machine to the start of the job.
#[derive(Clone, Debug)]
struct Approach<N: Transmit> {
    /// A machine that is not homed may be homed.
    homing: bool,
    /// Duration of the way to the start of the job, s. `None` without such a way, and once the
    /// machine is on it.
    recovery_s: Option<f64>,
    /// The client has acknowledged a fault.
    acknowledged: bool,
    /// The client has enabled the machine,
    enabled: bool,
    /// and waits until it is on.
    is_enabling: bool,
    /// The client has seen where the machine stands.
    is_near: bool,
    /// The straight way to the start of the job, which the machine has taken.
    way: Option<Move<N>>,
    /// The machine has begun the job for another client: items that it had taken, as far as that one knew.
    attachment: Option<u32>,
}

/// Commands of the user.
#[derive(Clone, Debug, Default)]
struct User {
    waiting: VecDeque<UserCommand>,
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
                homing: true,
                recovery_s: None,
                acknowledged: false,
                enabled: false,
                is_enabling: false,
                is_near: false,
                way: None,
                attachment: None,
            },
            user: User::default(),
            schedule: Schedule::new(),
            phase: Phase::Greeting,
        }
    }

    /// Leaves a machine that is not homed as it is, which ends the job before it begins.
    #[must_use]
    pub fn without_homing(mut self) -> Self {
        self.approach.homing = false;
        self
    }

    /// Acknowledges a fault that was latched before the job, and brings the machine to the start of
    /// the job. A machine that is not homed is homed; any other moves there in `seconds`.
    #[must_use]
    pub fn with_recovery(mut self, seconds: f64) -> Self {
        self.approach.recovery_s = Some(seconds);
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

    /// Goes on with a job that another client has begun: the job of the same name, with the same items, of which the machine had
    /// taken `taken` or more. A machine that waits for its host is resumed, and goes on at the very
    /// place. One that has lost the job ends it: [`JobFailure::Restarted`], [`JobFailure::OtherJob`], [`JobFailure::Dropped`].
    #[must_use]
    pub fn attached(mut self, taken: u32) -> Self {
        self.approach.attachment = Some(taken);
        self
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

    /// Returns the place of the job at which the machine has left it: at a stop or a fault since it was switched on.
    pub fn interrupted(&self) -> Option<JobPlace> {
        let interruption = self.status.as_ref()?.interrupted?;
        Some(JobPlace {
            index: self.index(interruption.number)?,
            at: interruption.at,
        })
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
        status.map_or(0, |status| self.progress.done(status))
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

    /// Takes a command of the user. The command goes before everything but the open request.
    pub fn command(&mut self, command: UserCommand) {
        self.user.waiting.push_back(command);
    }

    /// Begins the conversation again on a port that was opened anew. The job goes on where it is.
    pub fn reconnected(&mut self) {
        if !matches!(self.phase, Phase::Ending(_) | Phase::Finished(_)) {
            self.phase = Phase::Greeting;
        }
        self.exchange.forget();
    }

    /// Returns the next act at `now`, counted from any start and never going back.
    pub fn poll(&mut self, now: Duration) -> Action<N> {
        loop {
            if let Phase::Finished(result) = &self.phase {
                return Action::Finished(*result);
            }
            let due = match self.exchange.poll(now) {
                Turn::Send(request) => return Action::Send(request),
                Turn::Wait(until) if !self.goes_on() => return Action::Wait(until),
                Turn::Wait(until) => until,
                Turn::Silent => return Action::Lost,
                Turn::Free => Duration::MAX,
            };
            match self.next(now) {
                Next::Ask(Command::Hello(hello)) => self.exchange.greet(hello, now),
                Next::Ask(command) => self.exchange.ask(command, now),
                Next::Listen(until) => return Action::Wait(until.min(due)),
            }
        }
    }

    /// Takes a message of the machine.
    pub fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(event) = message {
            // An event is a hint: it may be late, or come twice. The status says what holds.
            let is_news = match (event, &mut self.status) {
                (Event::State { state, .. }, Some(status)) => {
                    std::mem::replace(&mut status.state, *state) != *state
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
        let Some((Request { sequence, command }, reply)) = self.exchange.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => self.on_hello(identity),
            Reply::Status(status) => self.on_status(sequence, status, now),
            Reply::Refused(refusal) => self.on_refusal(&command, refusal, now),
            Reply::Done => {
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

    fn enter(&mut self, phase: Phase<N>) {
        if matches!(phase, Phase::Ending(_)) {
            self.schedule.hurry();
        }
        self.phase = phase;
    }
}

#[cfg(test)]
mod tests;
