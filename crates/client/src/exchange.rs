//! One request at a time: sent, repeated until the machine answers, given up.
//!
//! A request whose answer is lost is repeated with the same sequence number. The machine answers again
//! and does not execute the request again. Where no answer comes at all, the next hello and status
//! tell whether the request was executed.

use std::time::Duration;
use trirrr_protocol::message::{Command, Hello, Message, Reply, Request, Transmit};

/// Time to wait for an answer, and number of requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Wait for the first answer. The wait doubles with each request, up to eight times this.
    pub answer: Duration,
    /// Requests before the machine counts as silent, at least 1.
    pub attempts: u32,
}

impl Default for Patience {
    /// Waits 200 + 400 + 800 + 4 * 1600 ms. A frame of 300 bytes takes 26 ms at 115,200 baud, and other
    /// messages may come before the answer.
    fn default() -> Self {
        Self {
            answer: Duration::from_millis(200),
            attempts: 7,
        }
    }
}

/// Number of times that the wait doubles.
const DOUBLINGS: u32 = 3;

/// Next act. Times count from any start.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn<N: Transmit> {
    /// Send this request.
    Send(Request<N>),
    /// Listen; unless something comes, there is nothing to do before this time.
    Wait(Duration),
    /// No attempt was answered.
    Silent,
    /// Every request is answered.
    Free,
}

/// Request that waits for its answer.
#[derive(Clone, Debug)]
struct Open<N: Transmit> {
    request: Request<N>,
    sent: u32,
    due: Duration,
}

/// Keeps requests and their answers in step.
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
    /// Creates an exchange without requests. Hellos are numbered from `hello`, which another client, or
    /// another run of this one, should not use.
    pub fn new(patience: Patience, hello: u32) -> Self {
        Self {
            patience,
            sequence: 0,
            hello,
            open: None,
            repeated: 0,
        }
    }

    /// Returns the number of requests that had to be sent again.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Opens the conversation, and drops the open request.
    pub fn greet(&mut self, hello: Hello, now: Duration) {
        self.hello = self.hello.wrapping_add(1);
        self.put(self.hello, Command::Hello(hello), now);
    }

    /// Asks `command`, and drops the open request.
    pub fn ask(&mut self, command: Command<N>, now: Duration) {
        self.put(self.sequence, command, now);
    }

    /// Drops the open request.
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

    /// Returns the next act at `now`.
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

    /// Takes a message of the machine. Returns the open request and its answer if the message is that
    /// answer; every other message leaves the exchange unchanged.
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

/// Returns true if `reply` is of the kind that answers `command`. An answer to a request of an earlier
/// conversation, with the same number, mostly is not.
fn answers<N: Transmit>(command: &Command<N>, reply: &Reply<N>) -> bool {
    match (command, reply) {
        (_, Reply::Refused(_)) => true,
        (Command::Hello(_), _) => matches!(reply, Reply::Hello(_)),
        (Command::Status, _) => matches!(reply, Reply::Status(_)),
        (Command::Read(_), _) => matches!(reply, Reply::Section(_)),
        _ => matches!(reply, Reply::Done),
    }
}
