//! Questions to a machine, one after the other.

use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::refused;
use crate::stream::{Port, conversation};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use trirrr_client::describe::{self, Units};
use trirrr_client::exchange::{Exchange, Turn};
use trirrr_client::local;
use trirrr_line::OtherClient;
use trirrr_protocol::message::{Command, Message, Refusal, Reply, State, Status};
use trirrr_scene::Scene;
use trirrr_service::ServiceNumber;

/// Longest wait for the board before Ctrl-C is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Conversation with a machine.
pub(super) struct Talk<'a, N: ServiceNumber> {
    exchange: Exchange<N>,
    port: Port,
    units: Units,
    start: Instant,
    stop: &'a AtomicBool,
    /// Messages that came beside the answers.
    heard: Vec<Message<N>>,
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
            exchange: Exchange::new(patience, conversation()),
            port,
            units: Units::of_scene(scene, &units),
            start: Instant::now(),
            stop,
            heard: Vec::new(),
        };
        let hello = local::hello::<N>(scene);
        talk.exchange.greet(hello, talk.start.elapsed());
        match talk.converse()? {
            Reply::Hello(_) => Ok(talk),
            Reply::Refused(refusal) => {
                let text = describe::refusal(&refusal, 0, &talk.units);
                Err(refused(&refusal, text))
            }
            _ => Err(CliError::Failed("the board answers something else".into())),
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
        self.exchange.ask(command, self.start.elapsed());
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
                    let came = self.listen(LOOK)?;
                    self.heard.extend(came);
                    continue;
                }
                Reply::Refused(refusal) => Err(CliError::Refused(describe::refusal(
                    &refusal,
                    0,
                    &self.units,
                ))),
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
            _ => Err(CliError::Failed("the board answers something else".into())),
        }
    }

    /// Acknowledges a fault, and clears the errors of drives that are off.
    ///
    /// # Errors
    /// As [`Self::done`].
    pub(super) fn clear(&mut self) -> Result<(), CliError> {
        if matches!(self.status()?.state, State::Fault | State::Disabled) {
            self.done(Command::ClearFault)?;
            // The tick has to hear of it, and the drives.
            let came = self.listen(Duration::from_millis(200))?;
            self.heard.extend(came);
        }
        Ok(())
    }

    /// Listens for `wait`. Returns what came.
    ///
    /// # Errors
    /// Failed: the port.
    pub(super) fn listen(&mut self, wait: Duration) -> Result<Vec<Message<N>>, CliError> {
        let mut came = std::mem::take(&mut self.heard);
        let end = Instant::now() + wait;
        while let left = end.saturating_duration_since(Instant::now())
            && !left.is_zero()
        {
            came.extend(self.receive(left)?);
        }
        Ok(came)
    }

    fn receive(&mut self, wait: Duration) -> Result<Vec<Message<N>>, CliError> {
        self.port.receive(wait).map_err(lost)
    }

    fn converse(&mut self) -> Result<Reply<N>, CliError> {
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return Err(CliError::Failed("ended by Ctrl-C".into()));
            }
            match self.exchange.poll(self.start.elapsed()) {
                Turn::Send(request) => self.port.send(&request).map_err(lost)?,
                Turn::Wait(until) => {
                    let wait = until.saturating_sub(self.start.elapsed()).min(LOOK);
                    for message in self.receive(wait)? {
                        match self.exchange.receive(&message) {
                            Some((_, reply)) => return Ok(reply),
                            None => self.heard.push(message),
                        }
                    }
                }
                Turn::Silent | Turn::Free => {
                    return Err(CliError::Failed("the board does not answer".into()));
                }
            }
        }
    }
}

fn lost(error: std::io::Error) -> CliError {
    CliError::Failed(match OtherClient::is_in(&error) {
        true => error.to_string(),
        false => format!("the port is lost: {error}"),
    })
}
