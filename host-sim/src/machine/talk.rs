//! Questions to a machine, one after the other.

use crate::dialogue::carry;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::refused;
use crate::stream::conversation;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_client::describe::{self, Units};
use trirrr_client::exchange::Exchange;
use trirrr_client::{Dialogue, Turn, local};
use trirrr_line::{Line, Port, Retry};
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{Command, Message, Refusal, Reply, Status};
use trirrr_scene::Scene;
use trirrr_service::ServiceNumber;

/// Limit of the wait for a stop to be taken.
const REST: Duration = Duration::from_secs(1);

/// Wait until a command is repeated that the machine was too busy for.
const BUSY: Duration = Duration::from_millis(20);

/// Conversation with a machine.
pub(super) struct Talk<'a, N: ServiceNumber> {
    inquiry: Inquiry<N>,
    port: Port,
    units: Units,
    stop: &'a AtomicBool,
}

impl<'a, N: ServiceNumber> Talk<'a, N> {
    /// Opens the port to the machine of `scene`, and says hello.
    ///
    /// # Errors
    /// Refused: the scene in this number type, or by the board. Failed: the port, or no answer.
    pub(super) fn open(
        args: &MachineArgs,
        scene: &Scene,
        stop: &'a AtomicBool,
    ) -> Result<Self, CliError> {
        let (port, units, patience) = args.open::<N>(scene)?;
        let mut talk = Self {
            inquiry: Inquiry {
                exchange: Exchange::new(patience, conversation()),
                heard: Vec::new(),
                end: Duration::ZERO,
                result: None,
            },
            // The command is given again by the user.
            port: port.retrying(Retry::Never),
            units: Units::of_scene(scene, &units),
            stop,
        };
        let (hello, now) = (local::hello::<N>(scene), talk.now());
        talk.inquiry.exchange.greet(hello, now);
        match talk.converse()? {
            Reply::Hello(_) => Ok(talk),
            Reply::Refused(refusal) => {
                let text = describe::refusal(&refusal, 0, &talk.units);
                Err(refused(&refusal, text))
            }
            _ => Err(other_answer()),
        }
    }

    /// Returns the units of the machine.
    pub(super) fn units(&self) -> Units {
        self.units
    }

    /// Asks, and waits for the answer.
    ///
    /// # Errors
    /// Failed: the port, or no answer.
    pub(super) fn ask(&mut self, command: Command<N>) -> Result<Reply<N>, CliError> {
        let now = self.now();
        self.inquiry.exchange.ask(command, now);
        self.converse()
    }

    /// Has a command done.
    ///
    /// # Errors
    /// As [`Self::ask`]; refused: by the board.
    pub(super) fn done(&mut self, command: Command<N>) -> Result<(), CliError> {
        loop {
            return match self.ask(command)? {
                Reply::Refused(Refusal::Busy) => {
                    let came = self.listen(BUSY)?;
                    self.inquiry.heard.extend(came);
                    continue;
                }
                Reply::Refused(refusal) => Err(self.refused(&refusal)),
                _ => Ok(()),
            };
        }
    }

    /// Returns the status.
    ///
    /// # Errors
    /// As [`Self::ask`].
    pub(super) fn status(&mut self) -> Result<Status<N>, CliError> {
        match self.ask(Command::Status)? {
            Reply::Status(status) => Ok(status),
            _ => Err(other_answer()),
        }
    }

    /// Reads a part of the scene.
    ///
    /// # Errors
    /// As [`Self::done`].
    pub(super) fn section(&mut self, name: SectionName) -> Result<Section, CliError> {
        match self.ask(Command::Read(name))? {
            Reply::Section(section) => Ok(section),
            Reply::Refused(refusal) => Err(self.refused(&refusal)),
            _ => Err(other_answer()),
        }
    }

    /// Failure by a refusal of the board.
    pub(super) fn refused(&self, refusal: &Refusal<N>) -> CliError {
        CliError::Refused(describe::refusal(refusal, 0, &self.units))
    }

    /// Returns true if the user has asked for the end.
    pub(super) fn is_interrupted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Has the machine come to rest on its path, behind Ctrl-C, too. Answers to what was asked before come first.
    pub(super) fn bring_to_rest(&mut self) {
        let begun = self.now();
        self.inquiry.exchange.ask(Command::Stop, begun);
        while self.now() < begun + REST {
            self.inquiry.end = begun + REST;
            match self.drive(&AtomicBool::new(false)) {
                Ok(Some(Reply::Refused(Refusal::Busy))) => {
                    let _ = self.listen(BUSY);
                    let now = self.now();
                    self.inquiry.exchange.ask(Command::Stop, now);
                }
                Ok(Some(_)) if self.inquiry.exchange.open().next().is_some() => {}
                _ => return,
            }
        }
    }

    /// Listens for `wait`. Returns what came.
    ///
    /// # Errors
    /// Failed: the port.
    pub(super) fn listen(&mut self, wait: Duration) -> Result<Vec<Message<N>>, CliError> {
        self.inquiry.end = self.now() + wait;
        // The next question is not asked behind Ctrl-C.
        let _: Option<Reply<N>> = self.drive(&AtomicBool::new(false))?;
        Ok(std::mem::take(&mut self.inquiry.heard))
    }

    fn now(&self) -> Duration {
        Line::<N>::now(&self.port)
    }

    fn drive(&mut self, stop: &AtomicBool) -> Result<Option<Reply<N>>, CliError> {
        carry(&mut self.inquiry, &mut self.port, stop)?
    }

    fn converse(&mut self) -> Result<Reply<N>, CliError> {
        self.inquiry.end = Duration::MAX;
        let reply = self.drive(self.stop)?;
        reply.ok_or_else(|| CliError::Failed("the board does not answer".into()))
    }
}

/// Failure by an answer that is none to the question.
pub(super) fn other_answer() -> CliError {
    CliError::Failed("the board answers something else".into())
}

/// Dialogue of one question, or of none for some time.
struct Inquiry<N: ServiceNumber> {
    exchange: Exchange<N>,
    /// Messages that came beside the answers.
    heard: Vec<Message<N>>,
    /// Time of the end without an answer.
    end: Duration,
    result: Option<Result<Reply<N>, CliError>>,
}

impl<N: ServiceNumber> Dialogue<N> for Inquiry<N> {
    type End = Result<Option<Reply<N>>, CliError>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        if let Some(result) = self.result.take() {
            return Turn::Done(result.map(Some));
        }
        match self.exchange.poll(now) {
            Turn::Done(()) if now < self.end => Turn::Wait(self.end),
            turn => turn.map(|()| Ok(None)),
        }
    }

    fn receive(&mut self, message: &Message<N>, _: Duration) {
        match self.exchange.receive(message) {
            Some((_, reply)) => self.result = Some(Ok(reply)),
            None => self.heard.push(message.clone()),
        }
    }

    fn stop(&mut self) {
        self.result = Some(Err(CliError::Failed("ended by Ctrl-C".into())));
    }

    fn reconnected(&mut self) {}
}
