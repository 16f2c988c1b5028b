//! One job on its way to the board: requests of the client, over a port that may fail, and telemetry of
//! the board, into the files.

use super::display::Display;
use super::journal::Journal;
use super::starts::MoveStarts;
use crate::dialogue::reopening;
use crate::failure::CliError;
use crate::numbers::refused;
use crate::player::JobRecorder;
use crate::supply::MoveSupply;
use std::sync::mpsc::Receiver;
use std::time::Duration;
use trirrr_client::describe::{self, Units};
use trirrr_client::records::is_of_a_job;
use trirrr_client::{Dialogue, JobClient, JobPlace, Turn, UserCommand};
use trirrr_line::LostLine;
use trirrr_protocol::message::{
    Acting, Event, InputState, InputStates, Message, Refusal, Reply, State, Telemetry, Transmit,
};
use trirrr_scene::words::short;

/// Limit of the wait for the last samples of a job.
const LAST_SAMPLES: Duration = Duration::from_millis(500);

/// Moves of a long job of which the ticks before them are known: more than a machine holds, and the client beyond those.
const KNOWN: usize = 4096;

/// End of a stream that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamEnd {
    /// The whole job was played.
    Complete,
    /// The user stopped it.
    Stopped,
}

/// Stream under way.
pub(super) struct Session<'a, N: Transmit> {
    pub(super) client: JobClient<N>,
    pub(super) recorder: JobRecorder<'a, N>,
    pub(super) display: Display,
    /// Ticks of the job before each of its moves.
    pub(super) starts: MoveStarts,
    /// Moves of a long job.
    pub(super) supply: Option<MoveSupply<'a, N>>,
    /// Ticks from one sample to the next.
    pub(super) every: u16,
    pub(super) keys: Option<&'a Receiver<UserCommand>>,
    pub(super) journal: Journal,
    /// Place on the job's path of a place on the moves that are played.
    pub(super) place: &'a dyn Fn(JobPlace) -> JobPlace,
    /// The board has sent a sample of a tick after the job.
    pub(super) is_over: bool,
    /// The user was told of the way to the start.
    pub(super) is_way_told: bool,
    /// The job was begun by another stream: where the machine holds it, the user has it resumed.
    pub(super) is_resumed: bool,
    /// The job uses the tool, and can be played from any place on.
    pub(super) uses_tool: bool,
    /// The user has the job resumed behind a door: the rest begins where the tool went off.
    pub(super) goes_back: bool,
    /// Inputs, as they were told last.
    pub(super) inputs: ToldInputs,
    /// A message could not be recorded.
    pub(super) failure: Option<CliError>,
    /// The job has ended; its last samples are waited for until then.
    pub(super) last: Option<Duration>,
}

/// Inputs, as a user was told of them; at first as they were.
#[derive(Default)]
pub(super) struct ToldInputs(Option<InputStates>);

impl ToldInputs {
    /// Returns the changes to `now`, which the user is told of, in words.
    fn changes(&mut self, now: &InputStates) -> Option<String> {
        let before = self.0.replace(*now)?;
        // Each message asks, and few tell of another state.
        (before != *now).then(|| describe::input_changes(Some(&before), now))?
    }
}

impl<N: Transmit> Dialogue<N> for Session<'_, N> {
    /// Refused: the board refuses the scene or a move. Failed: the machine has a fault, or something cannot be written.
    type End = Result<StreamEnd, CliError>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        let turn = self.client.poll(now);
        if matches!(turn, Turn::Done(_)) {
            // Samples of the job are still on the line: answers overtake samples.
            let last = *self.last.get_or_insert(now + LAST_SAMPLES);
            if self.recorder.samples.have_begun() && !self.is_over && now < last {
                return Turn::Wait(last);
            }
        }
        turn.map(|result| self.ended(result))
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        match message {
            Message::Telemetry(sample) => {
                let recorded = self.sample(sample);
                self.fail(recorded);
            }
            Message::Drives(sample) => {
                if !self.is_over {
                    let recorded = self.recorder.drives(sample);
                    self.fail(recorded);
                }
            }
            Message::Event(Event::State { state, acting, .. }) => {
                self.display.state(*state, *acting);
            }
            // To a resume by the user: the job goes on waiting.
            Message::Reply {
                reply: Reply::Refused(refusal @ Refusal::DoorOpen),
                ..
            } => self.refuse(refusal),
            Message::Event(_) | Message::Reply { .. } => {}
        }
        self.client.receive(message, now);
        // A status may tell of inputs before their event comes.
        let status = self.client.status();
        if let Some(text) = status.and_then(|status| self.inputs.changes(&status.inputs)) {
            self.display.note(&text);
        }
    }

    fn stop(&mut self) {
        self.display.note("Ctrl-C: the machine stops on its path");
        self.client.stop();
    }

    fn reconnected(&mut self) {
        self.client.reconnected();
    }

    fn lost(&mut self, why: &LostLine, is_news: bool) {
        if is_news {
            self.display.note(&reopening(why));
        }
    }

    fn attend(&mut self, _: Duration) -> Option<Self::End> {
        if self.failure.is_none() && self.last.is_none() {
            self.tell_way();
            self.listen_to_user();
            let done = self.note().and_then(|()| self.supply());
            self.fail(done);
        }
        self.failure.take().map(Err)
    }
}

impl<N: Transmit> Session<'_, N> {
    /// Keeps the first failure: the stream ends by it.
    fn fail(&mut self, done: Result<(), CliError>) {
        self.failure = self.failure.take().or(done.err());
    }

    /// Writes the journal now and then. The name of the job is written at once: before the machine has a move of it.
    fn note(&mut self) -> Result<(), CliError> {
        self.journal.take(&self.client, self.place);
        self.journal.note(&self.client, false)
    }

    /// Supplies the client with the moves that it wants.
    fn supply(&mut self) -> Result<(), CliError> {
        let Some(supply) = &self.supply else {
            return Ok(());
        };
        while let Some(index) = self.client.wants() {
            let chunk = supply.read(index)?;
            let ticks = chunk.moves.iter().map(|each| each.common().ticks);
            self.starts.extend(index, chunk.before, ticks);
            self.starts.keep(KNOWN);
            self.client.supply(index, chunk.moves);
        }
        Ok(())
    }

    /// Says that the machine goes to the start of the job, and for how long.
    fn tell_way(&mut self) {
        let (Some(way), Some(identity)) = (self.client.way(), self.client.identity()) else {
            return;
        };
        if !std::mem::replace(&mut self.is_way_told, true) {
            let seconds = short(f64::from(way.ticks) / identity.tick_rate_hz);
            let text = format!(
                "the machine goes to the start of the job first, straight, with the tool off: {seconds} s"
            );
            self.display.note(&text);
        }
    }

    fn listen_to_user(&mut self) {
        let asked: Vec<_> = self.keys.iter().flat_map(|keys| keys.try_iter()).collect();
        for ask in asked {
            match ask {
                UserCommand::Resume => self.resume(),
                ask => {
                    self.goes_back &= !matches!(ask, UserCommand::Stop | UserCommand::Disable);
                    self.client.command(ask);
                }
            }
        }
        if self.is_resumed
            && let Some(status) = self.client.status()
        {
            self.is_resumed = false;
            let holds = matches!(status.state, State::Slowing | State::Holding);
            if holds && matches!(status.acting, Acting::Hold | Acting::Door) {
                self.resume();
            }
        }
    }

    /// Goes on with a job that is held. On the ramp to rest behind a door the path was left without the tool: the machine goes back to where it
    /// was opened.
    fn resume(&mut self) {
        let status = self.client.status();
        let behind_door = status.filter(|status| status.acting == Acting::Door && self.uses_tool);
        match behind_door.map(|status| status.inputs.door) {
            None => self.client.command(UserCommand::Resume),
            Some(InputState::Active) => self.refuse(&Refusal::DoorOpen),
            Some(_) => {
                self.goes_back = true;
                self.client.command(UserCommand::Stop);
            }
        }
    }

    /// Says that the machine does not go on yet. The words need no units.
    fn refuse(&self, refusal: &Refusal<N>) {
        let why = describe::refusal(refusal, 0, &Units::si(1.0));
        self.display.note(&format!("refused: {why}"));
    }

    fn sample(&mut self, sample: &Telemetry<N>) -> Result<(), CliError> {
        // On the way to its start the machine has nothing of the job.
        let index = self.client.index(sample.number);
        let Some(index) = index.filter(|_| self.client.offered() > 0) else {
            return Ok(());
        };
        if !is_of_a_job(sample.state) {
            self.is_over |= self.recorder.samples.have_begun();
            return Ok(());
        }
        if self.is_over {
            return Ok(());
        }
        let record = self.recorder.samples.record(sample, self.every);
        let record = record.map_err(|status| {
            CliError::Failed(format!(
                "the board is where the scene's machine cannot be, in tick {}: {status}",
                sample.tick
            ))
        })?;
        self.recorder.write(&record, sample)?;
        let before = self.starts.before(index).unwrap_or(0);
        let at = before + u64::from(sample.at);
        self.display.values(at, &record, self.client.queued());
        Ok(())
    }

    fn ended(
        &self,
        result: Result<(), trirrr_client::JobFailure<N>>,
    ) -> Result<StreamEnd, CliError> {
        use trirrr_client::JobFailure as Lost;
        let failure = match result {
            Ok(()) => return Ok(StreamEnd::Complete),
            Err(Lost::Stopped { .. }) => return Ok(StreamEnd::Stopped),
            Err(failure) => failure,
        };
        let text = self.client.describe(&failure);
        let text = match failure {
            Lost::Fault(_) => format!(
                "{text}; the same command with --resume acknowledges it, and goes on where the tool went off"
            ),
            Lost::Occupied(State::Holding) => format!(
                "{text}: it has the job of another stream, which --resume with the folder of that one goes on with; `trirrr disable` ends it"
            ),
            _ => text,
        };
        Err(match failure {
            Lost::Refused { refusal, .. } => refused(&refusal, text),
            Lost::Inadmissible { .. } | Lost::OtherTool(_) => CliError::Refused(text),
            _ => CliError::Failed(text),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::ToldInputs;
    use trirrr_protocol::message::{InputState, InputStates};

    /// A status or an event may be the first to tell of a door: the user is told once.
    #[test]
    fn a_door_is_told_once_whatever_tells_of_it() {
        let closed = InputStates {
            door: InputState::Clear,
            ..InputStates::ABSENT
        };
        let open = InputStates {
            door: InputState::Active,
            ..closed
        };
        let mut told = ToldInputs::default();
        assert_eq!(told.changes(&closed), None);
        assert_eq!(told.changes(&open).as_deref(), Some("door open"));
        assert_eq!(told.changes(&open), None);
        assert_eq!(told.changes(&closed).as_deref(), Some("door closed"));
    }
}
