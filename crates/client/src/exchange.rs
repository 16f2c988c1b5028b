//! Requests in flight: sent, repeated until the machine answers, given up.
//!
//! A request whose answer is lost is repeated with the same sequence number. The machine answers again
//! and does not execute the request again. Where no answer comes at all, the next hello and status
//! tell whether the request was executed.
//!
//! Several requests may be in flight, as many as the machine takes. It executes them in the order of their numbers, and keeps
//! those that come before one that is missing. A line keeps the order of its frames. So an answer, or the word that a request
//! is kept, tells which frames before it are lost: these are repeated at once, and nothing else.

use crate::dialogue::Turn;
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_protocol::message::{Command, Hello, Identity, Message, Reply, Request, Transmit};

/// Time to wait for an answer, and number of requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Wait for the first answer. The wait doubles with each request, up to eight times this.
    pub answer: Duration,
    /// Requests before the machine counts as silent, at least 1.
    pub attempts: u32,
}

impl Patience {
    /// Returns the time without an answer after which the machine counts as silent.
    pub fn total(&self) -> Duration {
        let waits = (0..self.attempts.max(1)).map(|asked| self.wait(asked));
        waits.sum()
    }

    /// Returns the wait for an answer behind `asked` others.
    fn wait(&self, asked: u32) -> Duration {
        self.answer * (1 << asked.min(DOUBLINGS))
    }
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

/// Request that waits for its answer.
#[derive(Clone, Debug)]
struct Open<N: Transmit> {
    request: Request<N>,
    /// Times that it was sent because no answer came.
    attempts: u32,
    due: Duration,
    /// Place among all frames of its last sending.
    order: u64,
    /// Its frame, or that of its answer, is lost.
    is_lost: bool,
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
    /// Requests that may be in flight.
    window: u32,
    /// Requests in flight, in the order of their numbers.
    open: VecDeque<Open<N>>,
    sent: u64,
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
            window: 1,
            open: VecDeque::new(),
            sent: 0,
            repeated: 0,
        }
    }

    /// Returns the patience with the machine.
    pub fn patience(&self) -> Patience {
        self.patience
    }

    /// Returns the number of requests that had to be sent again.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Opens the conversation, and drops all open requests.
    pub fn greet(&mut self, hello: Hello, now: Duration) {
        self.forget();
        self.hello = self.hello.wrapping_add(1);
        self.put(self.hello, Command::Hello(hello), now);
    }

    /// Asks `command`, behind the requests that are open. Nothing is asked where the machine would take no other request:
    /// see [`has_room`](Self::has_room).
    pub fn ask(&mut self, command: Command<N>, now: Duration) {
        if self.has_room() {
            self.put(self.sequence, command, now);
            self.sequence = self.sequence.wrapping_add(1);
        }
    }

    /// Returns true if the machine takes another request.
    pub fn has_room(&self) -> bool {
        self.open.front().is_none_or(|first| {
            let is_hello = matches!(first.request.command, Command::Hello(_));
            !is_hello && self.sequence.wrapping_sub(first.request.sequence) < self.window
        })
    }

    /// Returns the open requests, the oldest first.
    pub fn open(&self) -> impl Iterator<Item = &Request<N>> {
        self.open.iter().map(|open| &open.request)
    }

    /// Drops the open requests.
    pub fn forget(&mut self) {
        self.open.clear();
    }

    /// Sends the open requests again, under their numbers, on a port that was opened anew: a machine that has executed one repeats
    /// its answer. A machine that was switched on meanwhile refuses them: the owner says hello.
    pub fn reopened(&mut self, now: Duration) {
        for open in &mut self.open {
            (open.attempts, open.due, open.is_lost) = (0, now, false);
        }
    }

    fn put(&mut self, sequence: u32, command: Command<N>, now: Duration) {
        self.open.push_back(Open {
            request: Request { sequence, command },
            attempts: 0,
            due: now,
            order: 0,
            is_lost: false,
        });
    }

    /// Returns the next act at `now`: done once every request is answered.
    pub fn poll(&mut self, now: Duration) -> Turn<N, ()> {
        let is_due = |open: &&mut Open<N>| open.is_lost || open.due <= now;
        let Some(open) = self.open.iter_mut().find(is_due) else {
            let due = self.open.iter().map(|open| open.due).min();
            return due.map_or(Turn::Done(()), Turn::Wait);
        };
        if !open.is_lost {
            if open.attempts >= self.patience.attempts.max(1) {
                return Turn::Reconnect;
            }
            open.due = now + self.patience.wait(open.attempts);
            open.attempts += 1;
        }
        self.repeated += u64::from(open.order != 0);
        self.sent += 1;
        (open.order, open.is_lost) = (self.sent, false);
        Turn::Send(open.request)
    }

    /// Takes a message of the machine. Returns the request and its answer if the message is the answer to an open one. Every other
    /// message returns none; some tell what is lost.
    pub fn receive(&mut self, message: &Message<N>) -> Option<(Request<N>, Reply<N>)> {
        let Message::Reply { sequence, reply } = message else {
            return None;
        };
        let is_asked = |open: &Open<N>| open.request.sequence == *sequence;
        let index = self.open.iter().position(is_asked)?;
        let order = self.open.get(index)?.order;
        if let Reply::Kept { missing } = reply {
            self.is_lost(order, |open| open.request.sequence == *missing);
            return None;
        }
        let command = self.open.get(index)?.request.command;
        if !answers(&command, reply) {
            return None;
        }
        let request = self.open.remove(index)?.request;
        match reply {
            Reply::Hello(identity) => {
                self.sequence = identity.next_sequence;
                self.window = u32::from(identity.window).max(1);
            }
            // The machine has answered all before it, in their order.
            _ => {
                let behind = |other: u32| request.sequence.wrapping_sub(other) as i32 > 0;
                self.is_lost(order, |open| behind(open.request.sequence));
            }
        }
        Some((request, reply.clone()))
    }

    /// The frames of these requests that were sent before `order` are lost.
    fn is_lost(&mut self, order: u64, which: impl Fn(&Open<N>) -> bool) {
        for open in self.open.iter_mut().filter(|open| which(open)) {
            open.is_lost |= open.order < order;
        }
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
        (Command::UpdateStatus, _) => matches!(reply, Reply::Update(_)),
        _ => matches!(reply, Reply::Done),
    }
}

/// Identity of a simulated machine that takes eight requests at a time.
#[cfg(test)]
pub(crate) fn identity_of_tests(next_sequence: u32) -> trirrr_protocol::message::Identity {
    use trirrr_protocol::message::{
        AngleReference, Board, Firmware, Identity, NAME_CAPACITY, PROTOCOL,
    };

    Identity {
        protocol: PROTOCOL,
        schema: 0,
        scene: 0,
        name: [0; NAME_CAPACITY],
        tick_rate_hz: 1000.0,
        length_m: 1.0,
        time_s: 1.0,
        mass_kg: 1.0,
        ramp_ticks: 100,
        silence_ticks: 1000,
        queue: 256,
        window: 8,
        batch: 4,
        next_sequence,
        reference: AngleReference::Declared,
        board: Board::HOST,
        firmware: Firmware::SIMULATOR,
        levels: 0,
    }
}

/// Statuses within the host timeout, after which a machine would stop.
const STATUS_PER_TIMEOUT: u32 = 4;

/// Returns the time from one status to the next: `most`, or less where the machine takes its host for lost before that.
pub fn status_interval(most: Duration, identity: &Identity) -> Duration {
    let timeout_s = f64::from(identity.silence_ticks) / identity.tick_rate_hz;
    let interval = Duration::try_from_secs_f64(timeout_s / f64::from(STATUS_PER_TIMEOUT));
    // Without a timeout of its own, a machine says 0 ticks.
    match interval {
        Ok(interval) if !interval.is_zero() => interval.min(most),
        _ => most,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::{Identity, PROTOCOL};

    const ANSWER: Duration = Duration::from_millis(200);

    fn reply(sequence: u32, reply: Reply<f64>) -> Message<f64> {
        Message::Reply { sequence, reply }
    }

    /// An exchange behind its hello: the machine takes `window` requests, the first of number 40.
    fn greeted(window: u8) -> Exchange<f64> {
        let mut exchange = Exchange::new(Patience::default(), 6);
        let hello = Hello {
            protocol: PROTOCOL,
            schema: 0,
            scene: 0,
        };
        exchange.greet(hello, Duration::ZERO);
        assert!(!exchange.has_room(), "nothing before the answer");
        assert_eq!(sent(&mut exchange, Duration::ZERO), [7]);
        let identity = Identity {
            window,
            ..identity_of_tests(40)
        };
        let (request, _) = exchange.receive(&reply(7, Reply::Hello(identity))).unwrap();
        assert_eq!(request.sequence, 7);
        exchange
    }

    /// Numbers of the requests that are sent at `now`.
    fn sent(exchange: &mut Exchange<f64>, now: Duration) -> Vec<u32> {
        let mut numbers = Vec::new();
        while let Turn::Send(request) = exchange.poll(now) {
            numbers.push(request.sequence);
        }
        numbers
    }

    fn ask(exchange: &mut Exchange<f64>, count: usize) {
        for _ in 0..count {
            exchange.ask(Command::Start, Duration::ZERO);
        }
    }

    #[test]
    fn no_more_is_in_flight_than_the_machine_takes() {
        for window in [0, 1, 4] {
            let mut exchange = greeted(window);
            ask(&mut exchange, 10);
            let most = u32::from(window.max(1));
            let all: Vec<u32> = (40..40 + most).collect();
            assert_eq!(sent(&mut exchange, Duration::ZERO), all);
            assert!(!exchange.has_room());
            // Only the oldest makes room.
            if most > 1 {
                assert!(exchange.receive(&reply(41, Reply::Done)).is_some());
                assert!(!exchange.has_room());
            }
            assert!(exchange.receive(&reply(40, Reply::Done)).is_some());
            assert!(exchange.has_room());
        }
    }

    #[test]
    fn a_request_that_is_lost_is_repeated_at_once_and_alone() {
        let mut exchange = greeted(4);
        ask(&mut exchange, 4);
        assert_eq!(sent(&mut exchange, Duration::ZERO).len(), 4);
        // 40 is lost; all behind it say so, and it is sent once.
        for kept in [41, 42] {
            let kept = reply(kept, Reply::Kept { missing: 40 });
            assert_eq!(exchange.receive(&kept), None);
        }
        assert_eq!(sent(&mut exchange, Duration::ZERO), [40]);
        let kept = reply(43, Reply::Kept { missing: 40 });
        assert_eq!(exchange.receive(&kept), None);
        assert_eq!(sent(&mut exchange, Duration::ZERO), [0; 0]);
        assert_eq!(exchange.repeated(), 1);
        for number in 40..44 {
            assert!(exchange.receive(&reply(number, Reply::Done)).is_some());
        }
        assert_eq!(exchange.poll(ANSWER * 100), Turn::Done(()));
    }

    #[test]
    fn an_answer_that_is_lost_is_asked_for_at_once_and_alone() {
        let mut exchange = greeted(4);
        ask(&mut exchange, 3);
        assert_eq!(sent(&mut exchange, Duration::ZERO).len(), 3);
        assert!(exchange.receive(&reply(41, Reply::Done)).is_some());
        assert_eq!(sent(&mut exchange, Duration::ZERO), [40]);
        // That of 42 was sent before 40 was repeated.
        assert!(exchange.receive(&reply(42, Reply::Done)).is_some());
        assert_eq!(sent(&mut exchange, Duration::ZERO), [0; 0]);
        assert!(exchange.receive(&reply(40, Reply::Done)).is_some());
        assert_eq!(exchange.poll(Duration::ZERO), Turn::Done(()));
    }

    /// The last frame of all has none behind it that would tell.
    #[test]
    fn what_nothing_tells_of_is_repeated_in_time_and_given_up() {
        let mut exchange = greeted(4);
        ask(&mut exchange, 2);
        assert_eq!(sent(&mut exchange, Duration::ZERO), [40, 41]);
        assert!(exchange.receive(&reply(40, Reply::Done)).is_some());
        assert_eq!(exchange.poll(Duration::ZERO), Turn::Wait(ANSWER));
        let mut now = Duration::ZERO;
        for _ in 1..Patience::default().attempts {
            let Turn::Wait(until) = exchange.poll(now) else {
                panic!("it waits");
            };
            now = until;
            assert_eq!(sent(&mut exchange, now), [41]);
        }
        assert_eq!(exchange.poll(now + ANSWER * 8), Turn::Reconnect);
        // A port that is opened anew begins again, under the same number.
        now += ANSWER * 8;
        exchange.reopened(now);
        assert_eq!(sent(&mut exchange, now), [41]);
        assert!(exchange.receive(&reply(41, Reply::Done)).is_some());
        assert_eq!(exchange.poll(now), Turn::Done(()));
    }
}
