//! Streams a job: hello, moves as there is room for them, start, and an eye on what becomes of it.

use crate::Failure;
use crate::describe::Units;
use crate::exchange::{Exchange, Patience, Turn};
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_protocol::message::{
    Acting, Command, Event, Hello, Identity, Message, Move, Recovery, Refusal, Reply, Request,
    State, Status, Transmit,
};

/// From one status to the next while nothing else is to be said.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// A machine that runs is asked this many times in the silence after which it would stop.
const STATUS_PER_SILENCE: u32 = 4;

/// What to do next.
#[derive(Clone, Debug, PartialEq)]
pub enum Action<N: Transmit> {
    /// Send this to the machine.
    Send(Request<N>),
    /// Listen; unless something comes, nothing is to be done before this time.
    Wait(Duration),
    /// The machine does not answer: open the port anew and call [`Stream::reconnected`], or give
    /// up.
    Lost,
    /// The job is played to its end, or why not.
    Finished(Result<(), Failure<N>>),
}

/// What a user may ask for while the job runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Come to rest on the path.
    Hold,
    /// Go on.
    Resume,
    /// Come to rest on the path and drop the rest.
    Stop,
}

/// Where the conversation stands.
#[derive(Clone, Debug, PartialEq)]
enum Phase<N: Transmit> {
    /// The next thing is a hello.
    Greeting,
    /// The next thing is the status, the first after a hello.
    Surveying,
    /// The machine does not know where its motors are: the next thing is to home it,
    Homing,
    /// and then to see it stand at its start.
    Awaiting,
    /// A fault is latched, from before the job: the next thing is to acknowledge it.
    Acknowledging,
    /// The machine may stand anywhere: the next thing is to move it to the start of the job.
    Recovering,
    /// The next thing is the telemetry rate.
    Preparing,
    /// Moves, start, status.
    Streaming,
    /// A stop, after which the job ends with this.
    Ending(Failure<N>),
    Finished(Result<(), Failure<N>>),
}

/// A job on its way to a machine.
#[derive(Clone, Debug)]
pub struct Stream<N: Transmit> {
    exchange: Exchange<N>,
    hello: Hello,
    moves: Vec<Move<N>>,
    /// Ticks from one telemetry sample to the next.
    telemetry: u16,
    phase: Phase<N>,
    identity: Option<Identity>,
    status: Option<Status<N>>,
    /// The machine's number of the job's first move, from the first status on.
    base: Option<u32>,
    /// Moves that the machine has taken.
    offered: u32,
    /// Moves that it would still take, as far as known.
    room: u8,
    asked: VecDeque<Ask>,
    stop_asked: bool,
    /// A machine that is not homed is homed.
    homes: bool,
    /// Before the job the machine is brought to where that starts, in so many seconds; none once it
    /// is on its way.
    recovery_s: Option<f64>,
    /// A fault was acknowledged.
    acknowledged: bool,
    /// When to look at the status again.
    look: Duration,
    /// Neither moves nor a start before this.
    pause: Duration,
}

impl<N: Transmit> Stream<N> {
    /// A job of `moves`, for a machine that is what `hello` says, with a telemetry sample every
    /// `telemetry` ticks. The moves' numbers do not matter: the machine says what they have to be.
    /// `conversation`: a number that another conversation with the machine is not likely to have.
    pub fn new(
        moves: Vec<Move<N>>,
        hello: Hello,
        telemetry: u16,
        patience: Patience,
        conversation: u32,
    ) -> Self {
        Self {
            exchange: Exchange::new(patience, conversation),
            hello,
            moves,
            telemetry,
            phase: Phase::Greeting,
            identity: None,
            status: None,
            base: None,
            offered: 0,
            room: 0,
            asked: VecDeque::new(),
            stop_asked: false,
            homes: true,
            recovery_s: None,
            acknowledged: false,
            look: Duration::ZERO,
            pause: Duration::ZERO,
        }
    }

    /// Leaves a machine that is not homed as it is, which ends the job before it begins.
    #[must_use]
    pub fn without_homing(self) -> Self {
        Self {
            homes: false,
            ..self
        }
    }

    /// Before the job, acknowledges a fault that is latched and brings the machine to where the job
    /// starts: by homing one that is not homed, any other by moving its motors there in `seconds`.
    #[must_use]
    pub fn with_recovery(self, seconds: f64) -> Self {
        Self {
            recovery_s: Some(seconds),
            ..self
        }
    }

    /// Who answered.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// The last status that came.
    pub fn status(&self) -> Option<&Status<N>> {
        self.status.as_ref()
    }

    /// Moves of the job.
    pub fn moves(&self) -> u32 {
        // A machine counts them in 32 bits.
        self.moves.len() as u32
    }

    /// Moves that the machine has taken.
    pub fn offered(&self) -> u32 {
        self.offered
    }

    /// Moves played to their end, as of the last status.
    pub fn done(&self) -> u32 {
        match (self.base, &self.status) {
            (Some(base), Some(status)) => status.done.wrapping_sub(base),
            _ => 0,
        }
    }

    /// The job's move that the machine calls `number`, counted from 0.
    pub fn index(&self, number: u32) -> Option<u32> {
        let index = number.wrapping_sub(self.base?);
        (index < self.moves()).then_some(index)
    }

    /// Requests that had to be sent again so far.
    pub fn repeated(&self) -> u64 {
        self.exchange.repeated()
    }

    /// `failure` in words, in SI units.
    pub fn describe(&self, failure: &Failure<N>) -> String {
        // Before a hello nothing with a unit is reported.
        let units = self.identity.as_ref().map_or(Units::si(1.0), Units::of);
        let index = failure
            .index()
            .and_then(|index| usize::try_from(index).ok());
        let about = index.and_then(|index| self.moves.get(index));
        failure.describe(about.map_or(0, |each| each.ticks), &units)
    }

    /// A wish of the user; it goes before everything but what is being asked.
    pub fn ask(&mut self, ask: Ask) {
        self.asked.push_back(ask);
    }

    /// The port was opened anew: the conversation starts again, the job goes on where it is.
    pub fn reconnected(&mut self) {
        if matches!(
            self.phase,
            Phase::Streaming
                | Phase::Surveying
                | Phase::Homing
                | Phase::Awaiting
                | Phase::Acknowledging
                | Phase::Recovering
                | Phase::Preparing
        ) {
            self.phase = Phase::Greeting;
        }
        self.exchange.forget();
    }

    /// What to do at `now`, counted from any start and never going back.
    pub fn poll(&mut self, now: Duration) -> Action<N> {
        loop {
            if let Phase::Finished(result) = &self.phase {
                return Action::Finished(*result);
            }
            match self.exchange.poll(now) {
                Turn::Send(request) => return Action::Send(request),
                Turn::Wait(until) => return Action::Wait(until),
                Turn::Silent => return Action::Lost,
                Turn::Free => {}
            }
            match self.next(now) {
                Some(Command::Hello(hello)) => self.exchange.greet(hello, now),
                Some(command) => self.exchange.ask(command, now),
                None => return Action::Wait(self.look),
            }
        }
    }

    /// The next thing to say; none before the next look at the status.
    fn next(&mut self, now: Duration) -> Option<Command<N>> {
        match &self.phase {
            Phase::Greeting => return Some(Command::Hello(self.hello)),
            Phase::Surveying => return Some(Command::Status),
            Phase::Homing => return Some(Command::Home),
            Phase::Acknowledging => return Some(Command::ClearFault),
            Phase::Recovering => return self.recovery(),
            Phase::Preparing => {
                return Some(Command::Telemetry {
                    every: self.telemetry,
                });
            }
            Phase::Ending(_) => return Some(Command::Stop),
            Phase::Awaiting | Phase::Streaming | Phase::Finished(_) => {}
        }
        if let Some(ask) = self.asked.pop_front() {
            return Some(match ask {
                Ask::Hold => Command::Hold,
                Ask::Resume => Command::Resume,
                Ask::Stop => Command::Stop,
            });
        }
        if self.look <= now {
            return Some(Command::Status);
        }
        if self.stop_asked || now < self.pause || self.phase == Phase::Awaiting {
            return None;
        }
        let next = self.moves.get(self.offered as usize);
        if let (Some(next), Some(base)) = (next, self.base)
            && self.room > 0
        {
            return Some(Command::Move(Move {
                number: base.wrapping_add(self.offered),
                ..*next
            }));
        }
        self.is_ready().then_some(Command::Start)
    }

    /// The way to the start of the job.
    fn recovery(&self) -> Option<Command<N>> {
        let (identity, seconds) = (self.identity.as_ref()?, self.recovery_s?);
        let ticks = (seconds * identity.tick_rate_hz).round().max(1.0);
        Some(Command::Recover(Recovery {
            to: self.moves.first()?.from,
            // Saturates, and is refused then.
            ticks: ticks as u32,
        }))
    }

    /// Whether the machine stands, with everything judged that it has taken, and has moves to play.
    /// Not only once: where moves come too slowly, it comes to rest at the end of what it has.
    fn is_ready(&self) -> bool {
        self.status.as_ref().is_some_and(|status| {
            status.state == State::Idle
                && status.admitted == status.next
                && status.admitted != status.done
        })
    }

    /// Takes what the machine said.
    pub fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(event) = message {
            // A hint, no more: it may be late, or come twice. The status says what holds.
            self.look = self.look.min(now);
            if let (Event::State { state, .. }, Some(status)) = (event, &mut self.status) {
                status.state = *state;
            }
            return;
        }
        let Some((command, reply)) = self.exchange.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => self.greeted(identity),
            Reply::Status(status) => self.surveyed(status, now),
            Reply::Refused(refusal) => self.refused(&command, refusal, now),
            Reply::Done => self.executed(&command, now),
            // Never asked for.
            Reply::Section(_) => {}
        }
    }

    fn finish(&mut self, result: Result<(), Failure<N>>) {
        self.phase = Phase::Finished(result);
    }

    /// Ends the job with `failure`, once the machine was told to stop.
    fn end(&mut self, failure: Failure<N>) {
        if !matches!(self.phase, Phase::Ending(_) | Phase::Finished(_)) {
            self.phase = Phase::Ending(failure);
        }
    }

    fn greeted(&mut self, identity: Identity) {
        self.identity = Some(identity);
        self.phase = Phase::Surveying;
    }

    fn surveyed(&mut self, status: Status<N>, now: Duration) {
        self.look = now + self.status_every();
        self.room = status.room;
        let first = matches!(self.phase, Phase::Surveying | Phase::Awaiting);
        let base = *self.base.get_or_insert(status.next);
        let taken = status.next.wrapping_sub(base);
        let standing = matches!(status.state, State::Idle);
        // One that was acknowledged is told of until the tick has heard of it.
        let latched = !self.acknowledged || status.state == State::Fault;
        if let Some(fault) = status.fault
            && latched
        {
            if self.phase == Phase::Surveying && self.status.is_none() && self.recovery_s.is_some()
            {
                self.phase = Phase::Acknowledging;
            }
            self.status = Some(status);
            if self.phase == Phase::Acknowledging {
                // What the moves are counted from is known afterwards.
                self.base = None;
                return;
            }
            return self.finish(Err(Failure::Fault(fault)));
        }
        if let Some(verdict) = status.refused
            && let Some(violation) = verdict.violation
            && let Some(index) = self.index(verdict.number)
        {
            self.status = Some(status);
            return self.end(Failure::Inadmissible { index, violation });
        }
        let before = self.status.replace(status);
        if first && self.offered == 0 && !self.is_at_start(&status, before.is_none()) {
            return;
        }
        // Ticks only go forwards.
        let restarted =
            before.is_some_and(|before| status.tick.wrapping_sub(before.tick) > u32::MAX / 2);
        if let Some(identity) = &self.identity
            && (restarted || taken > self.moves())
        {
            // Taken less than before is seen as a huge number.
            return self.finish(Err(Failure::Restarted(identity.board.start)));
        }
        if first && before.is_none() && (!standing || status.next != status.done) {
            return self.finish(Err(Failure::Occupied(status.state)));
        }
        // A machine that was stopped in the last move has dropped nothing that it had not begun.
        let stopped = standing && matches!(status.acting, Acting::Stop | Acting::Silence);
        if taken < self.offered || (stopped && self.done() > 0) {
            let done = self.done();
            return self.finish(Err(match self.stop_asked {
                true => Failure::Stopped { done },
                false => Failure::Dropped {
                    done,
                    acting: status.acting,
                },
            }));
        }
        // More only where the answer to the last move was lost with the line.
        self.offered = taken;
        if self.done() == self.moves() && standing {
            return self.finish(Ok(()));
        }
        if first {
            self.phase = Phase::Preparing;
        }
    }

    /// Whether the machine stands where its job may start, as far as homing and recovering go; else,
    /// what is to be done about it. `anew`: nothing was known of it before.
    fn is_at_start(&mut self, status: &Status<N>, anew: bool) -> bool {
        match status.state {
            State::Unhomed
                if self.homes && (self.phase == Phase::Surveying || self.recovery_s.is_some()) =>
            {
                self.phase = Phase::Homing;
            }
            // But not one that has moves of another job.
            State::Idle | State::Cleared
                if self.recovery_s.is_some() && status.next == status.done =>
            {
                self.phase = Phase::Recovering;
            }
            // On its way, for this client unless another one is there.
            State::Homing | State::Recovering | State::Stopping
                if !anew || self.recovery_s.is_some() =>
            {
                self.phase = Phase::Awaiting;
            }
            State::Unhomed | State::Cleared if self.phase == Phase::Awaiting => {
                self.finish(Err(match self.stop_asked {
                    true => Failure::Stopped { done: 0 },
                    false => Failure::Dropped {
                        done: 0,
                        acting: status.acting,
                    },
                }));
            }
            _ => return true,
        }
        false
    }

    /// How long to leave the machine alone.
    fn status_every(&self) -> Duration {
        let silence = self.identity.as_ref().and_then(|identity| {
            let seconds = f64::from(identity.silence_ticks) / identity.tick_rate_hz;
            let interval = seconds / f64::from(STATUS_PER_SILENCE);
            (interval > 0.0).then(|| Duration::try_from_secs_f64(interval).ok())?
        });
        silence.map_or(STATUS_EVERY, |silence| silence.min(STATUS_EVERY))
    }

    fn executed(&mut self, command: &Command<N>, now: Duration) {
        match command {
            Command::Telemetry { .. } => self.phase = Phase::Streaming,
            Command::Home => {
                self.recovery_s = None;
                self.phase = Phase::Awaiting;
                self.look = now;
            }
            Command::ClearFault => {
                self.acknowledged = true;
                self.phase = Phase::Surveying;
            }
            Command::Recover(_) => {
                self.recovery_s = None;
                self.phase = Phase::Awaiting;
                self.look = now;
            }
            Command::Move(_) => {
                self.offered += 1;
                self.room = self.room.saturating_sub(1);
                if let Some(status) = &mut self.status {
                    status.next = status.next.wrapping_add(1);
                }
                // Its verdict takes a moment.
                if self.room == 0 || self.offered == self.moves() {
                    self.look = now;
                }
            }
            Command::Start => {
                if let Some(status) = &mut self.status {
                    status.state = State::Running;
                }
            }
            Command::Stop => match &self.phase {
                Phase::Ending(failure) => {
                    let failure = *failure;
                    self.finish(Err(failure));
                }
                _ => {
                    self.stop_asked = true;
                    self.look = now;
                }
            },
            _ => {}
        }
    }

    fn refused(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        match (command, refusal) {
            (Command::Hello(_), refusal) => self.finish(Err(Failure::Refused {
                index: None,
                refusal,
            })),
            // The machine was switched off and on, or another client came between.
            (_, Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused) => {
                self.phase = match std::mem::replace(&mut self.phase, Phase::Greeting) {
                    Phase::Ending(failure) => Phase::Finished(Err(failure)),
                    _ => Phase::Greeting,
                };
            }
            // Not now: the status will say when.
            (Command::Move(_), Refusal::QueueFull | Refusal::Busy) => self.wait(now),
            (
                Command::Start,
                Refusal::Undecided | Refusal::NothingQueued | Refusal::EndsMoving | Refusal::Busy,
            ) => self.wait(now),
            (_, Refusal::Busy) => self.wait(now),
            // What the machine has taken is not what we think: the status says it.
            (Command::Move(_), Refusal::MoveNumber { .. }) => self.phase = Phase::Surveying,
            // A wish that came too late or too early, and no harm.
            (Command::Hold | Command::Resume, _) => {}
            _ => match self.phase.clone() {
                Phase::Ending(failure) => self.finish(Err(failure)),
                _ => {
                    let index = matches!(command, Command::Move(_)).then_some(self.offered);
                    self.end(Failure::Refused { index, refusal });
                }
            },
        }
    }

    /// Looks at the status at once, and says nothing else before the one after.
    fn wait(&mut self, now: Duration) {
        self.pause = now + self.status_every() / 4;
        self.look = self.pause;
    }
}
