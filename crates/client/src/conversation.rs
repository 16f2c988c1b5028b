//! Conversation with one machine: the hello, requests and answers, and what the machine has said last.

use crate::dialogue::Turn;
use crate::exchange::{Exchange, Patience};
use std::time::Duration;
use trirrr_protocol::message::{
    Command, Hello, Identity, Message, Refusal, Reply, Request, Status, Transmit,
};

/// Conversation that begins with a hello, and again where the machine was switched off and on, or another client came between.
#[derive(Clone, Debug)]
pub struct Conversation<N: Transmit> {
    exchange: Exchange<N>,
    hello: Hello,
    greeted: bool,
    identity: Option<Identity>,
    status: Option<Status<N>>,
}

impl<N: Transmit> Conversation<N> {
    /// Creates the conversation of number `number` with a machine that is what `hello` says.
    pub fn new(hello: Hello, patience: Patience, number: u32) -> Self {
        Self {
            exchange: Exchange::new(patience, number),
            hello,
            greeted: false,
            identity: None,
            status: None,
        }
    }

    /// Returns the identity of the machine that answered.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Returns the last status.
    pub fn status(&self) -> Option<&Status<N>> {
        self.status.as_ref()
    }

    /// Returns the last status, for what an event says of it.
    pub(crate) fn status_mut(&mut self) -> Option<&mut Status<N>> {
        self.status.as_mut()
    }

    /// Begins the conversation again on a port that was opened anew.
    pub fn reconnected(&mut self) {
        self.greeted = false;
        self.exchange.forget();
    }

    /// Returns true if the machine takes another request.
    pub fn has_room(&self) -> bool {
        self.exchange.has_room()
    }

    /// Asks `command`, behind the requests that are open.
    pub fn ask(&mut self, command: Command<N>, now: Duration) {
        self.exchange.ask(command, now);
    }

    /// Returns the next act at `now`: done once the machine is greeted and every request is answered.
    pub fn poll(&mut self, now: Duration) -> Turn<N, ()> {
        match self.exchange.poll(now) {
            Turn::Done(()) if !self.greeted => {
                self.exchange.greet(self.hello, now);
                self.exchange.poll(now)
            }
            turn => turn,
        }
    }

    /// Takes a message of the machine. Returns the command and its answer if the message is one. A refusal that only asks for another
    /// hello ends here: the command is not given again.
    pub fn receive(&mut self, message: &Message<N>) -> Option<(Command<N>, Reply<N>)> {
        let (Request { command, .. }, reply) = self.exchange.receive(message)?;
        match &reply {
            Reply::Hello(identity) => {
                self.greeted = true;
                self.identity = Some(identity.clone());
            }
            Reply::Refused(
                Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused,
            ) if !matches!(command, Command::Hello(_)) => {
                self.greeted = false;
                return None;
            }
            _ => {}
        }
        Some((command, reply))
    }

    /// Keeps the status that the machine has told. Returns the one before.
    pub fn keep(&mut self, status: Status<N>) -> Option<Status<N>> {
        self.status.replace(status)
    }
}
