//! One request at a time: asked, repeated until it is answered, given up.
//!
//! A request that is executed but whose answer is lost is repeated with the same sequence number;
//! the machine answers it again and does not execute it again. So every request is executed once,
//! or it is not known whether it was, which the next hello and status tell.

use std::time::Duration;
use trirrr_protocol::message::{Command, Hello, Message, Reply, Request, Transmit};

/// How long to wait for an answer, and how often to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// An answer that takes longer is asked for again; after each time the wait doubles, up to
    /// eight times this.
    pub answer: Duration,
    /// Requests in all before the machine counts as silent, at least 1.
    pub attempts: u32,
}

impl Default for Patience {
    /// A frame of 300 bytes takes 26 ms at 115,200 baud; with what a machine may have to say before
    /// its answer, 200 ms are enough. Together 200 + 400 + 800 + 4 * 1600 ms.
    fn default() -> Self {
        Self {
            answer: Duration::from_millis(200),
            attempts: 7,
        }
    }
}

/// The wait doubles this often at most.
const DOUBLINGS: u32 = 3;

/// What there is to do next. Time is an argument, counted from any start.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn<N: Transmit> {
    /// Send this.
    Send(Request<N>),
    /// Listen; unless something comes, there is nothing to do before this time.
    Wait(Duration),
    /// Every attempt went without an answer.
    Silent,
    /// Everything is answered.
    Free,
}

/// A request that waits for its answer.
#[derive(Clone, Debug)]
struct Open<N: Transmit> {
    request: Request<N>,
    sent: u32,
    due: Duration,
}

/// Requests and their answers, in step.
#[derive(Clone, Debug)]
pub struct Exchange<N: Transmit> {
    patience: Patience,
    /// Of the next request.
    sequence: u32,
    /// Of the next hello: each has its own, so that a late answer to an old one is not taken for
    /// the answer to the new one.
    hello: u32,
    open: Option<Open<N>>,
    repeated: u64,
}

impl<N: Transmit> Exchange<N> {
    /// Nothing is said yet. Hellos are numbered from `hello`: two clients, or two runs of one,
    /// should not use the same.
    pub fn new(patience: Patience, hello: u32) -> Self {
        Self {
            patience,
            sequence: 0,
            hello,
            open: None,
            repeated: 0,
        }
    }

    /// Requests that had to be sent again so far.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Opens the conversation, anew if need be: whatever was open is dropped.
    pub fn greet(&mut self, hello: Hello, now: Duration) {
        self.hello = self.hello.wrapping_add(1);
        self.put(self.hello, Command::Hello(hello), now);
    }

    /// Asks `command`, dropping whatever was open.
    pub fn ask(&mut self, command: Command<N>, now: Duration) {
        self.put(self.sequence, command, now);
    }

    /// Drops what is open: its answer is not waited for any longer.
    pub fn forget(&mut self) {
        self.open = None;
    }

    fn put(&mut self, sequence: u32, command: Command<N>, now: Duration) {
        self.open = Some(Open {
            request: Request { sequence, command },
            sent: 0,
            due: now,
        });
    }

    /// What to do at `now`.
    pub fn poll(&mut self, now: Duration) -> Turn<N> {
        let Some(open) = &mut self.open else {
            return Turn::Free;
        };
        if now < open.due {
            return Turn::Wait(open.due);
        }
        if open.sent >= self.patience.attempts.max(1) {
            return Turn::Silent;
        }
        self.repeated += u64::from(open.sent > 0);
        open.due = now + self.patience.answer * (1 << open.sent.min(DOUBLINGS));
        open.sent += 1;
        Turn::Send(open.request)
    }

    /// Takes what the machine said: the open request and its answer, if this is it. Everything
    /// else leaves the exchange as it is.
    pub fn receive(&mut self, message: &Message<N>) -> Option<(Command<N>, Reply<N>)> {
        let Message::Reply { sequence, reply } = message else {
            return None;
        };
        let command = self.open.as_ref()?.request.command;
        if *sequence != self.open.as_ref()?.request.sequence || !answers(&command, reply) {
            return None;
        }
        self.open = None;
        match reply {
            Reply::Hello(identity) => self.sequence = identity.next_sequence,
            // A refused hello has no place in the sequence, and neither has what comes before one.
            _ if matches!(command, Command::Hello(_)) => {}
            _ => self.sequence = self.sequence.wrapping_add(1),
        }
        Some((command, reply.clone()))
    }
}

/// Whether `reply` is of the kind that answers `command`. An answer to another request of the same
/// number, from an earlier conversation, mostly is not.
fn answers<N: Transmit>(command: &Command<N>, reply: &Reply<N>) -> bool {
    match (command, reply) {
        (_, Reply::Refused(_)) => true,
        (Command::Hello(_), _) => matches!(reply, Reply::Hello(_)),
        (Command::Status, _) => matches!(reply, Reply::Status(_)),
        (Command::Read(_), _) => matches!(reply, Reply::Section(_)),
        _ => matches!(reply, Reply::Done),
    }
}
