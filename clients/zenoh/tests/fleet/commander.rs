//! A client of one machine: numbers its commands, and repeats what is not answered.

use serde_json::{Value, json};
use std::time::{Duration, Instant};
use zenoh::liveliness::LivelinessToken;
use zenoh::{Session, Wait};

/// Wait for an answer until the command is repeated.
const ANSWER: Duration = Duration::from_secs(2);

/// Longest wait for anything.
pub(crate) const PATIENCE: Duration = Duration::from_secs(90);

/// Answer to a command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    pub(crate) outcome: String,
    pub(crate) text: String,
}

impl Answer {
    fn of(value: &Value) -> Self {
        let word = |name: &str| value[name].as_str().unwrap_or_default().to_owned();
        Self {
            outcome: word("outcome"),
            text: word("text"),
        }
    }

    pub(crate) fn is_accepted(&self) -> bool {
        self.outcome == "accepted"
    }
}

/// Asks `key` once. `None`: no answer came.
pub(crate) fn ask(session: &Session, key: &str, payload: Option<&Value>) -> Option<Value> {
    let query = session.get(key).timeout(ANSWER);
    let replies = match payload {
        Some(payload) => query.payload(payload.to_string()).wait(),
        None => query.wait(),
    };
    let reply = replies.unwrap().into_iter().next()?;
    let sample = reply.result().ok()?;
    Some(serde_json::from_slice(&sample.payload().to_bytes()).unwrap())
}

pub(crate) struct Commander {
    session: Session,
    machine: String,
    client: String,
    run: String,
    next: u64,
    pub(crate) token: Option<LivelinessToken>,
    /// Commands that were sent, each once, and times that one was repeated.
    pub(crate) sent: u64,
    pub(crate) repeated: u64,
}

impl Commander {
    /// Says hello to `machine`, with a liveliness token.
    pub(crate) fn new(session: &Session, machine: &str, client: &str) -> Self {
        let hello = json!({ "client": client });
        let key = format!("trirrr/{machine}/command/hello");
        let begin = Instant::now();
        let greeted = loop {
            match ask(session, &key, Some(&hello)) {
                Some(greeted) => break greeted,
                None => assert!(begin.elapsed() < PATIENCE, "{machine} does not answer"),
            }
        };
        let token = format!("trirrr/{machine}/control/{client}");
        let token = session.liveliness().declare_token(token).wait().unwrap();
        Self {
            session: session.clone(),
            machine: machine.into(),
            client: client.into(),
            run: greeted["session"].as_str().unwrap().into(),
            next: greeted["next_seq"].as_u64().unwrap(),
            token: Some(token),
            sent: 0,
            repeated: 0,
        }
    }

    /// Sends a command under the next number, and again under the same one until it is answered. Returns the answer.
    pub(crate) fn command(&mut self, verb: &str, arguments: Value) -> Answer {
        let payload = self.payload(self.next, arguments);
        self.next += 1;
        self.sent += 1;
        self.send(verb, &payload)
    }

    /// Sends a command as [`command`](Self::command), and once more though it is answered. Both answers have to be the same.
    pub(crate) fn twice(&mut self, verb: &str, arguments: Value) -> Answer {
        let number = self.next;
        let answer = self.command(verb, arguments.clone());
        let payload = self.payload(number, arguments);
        self.repeated += 1;
        assert_eq!(self.send(verb, &payload), answer, "{} {verb}", self.machine);
        answer
    }

    fn payload(&self, number: u64, mut arguments: Value) -> Value {
        arguments["client"] = self.client.as_str().into();
        arguments["session"] = self.run.as_str().into();
        arguments["seq"] = number.into();
        arguments
    }

    fn send(&mut self, verb: &str, payload: &Value) -> Answer {
        let key = format!("trirrr/{}/command/{verb}", self.machine);
        let begin = Instant::now();
        loop {
            if let Some(answer) = ask(&self.session, &key, Some(payload)) {
                return Answer::of(&answer);
            }
            assert!(begin.elapsed() < PATIENCE, "no answer to {key} {payload}");
            self.repeated += 1;
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    pub(crate) fn accepted(&mut self, verb: &str, arguments: Value) {
        let answer = self.command(verb, arguments);
        assert!(answer.is_accepted(), "{} {verb}: {answer:?}", self.machine);
    }

    /// Jogs, once the machine is free for it. Takes control and resumes where an outage has ended both. Returns the number of commands that
    /// the machine has executed: the jog, and what led to it.
    pub(crate) fn jog(&mut self, step: Value, twice: bool) -> u64 {
        let begin = Instant::now();
        let mut executed = 0;
        loop {
            let answer = match twice {
                true => self.twice("jog", step.clone()),
                false => self.command("jog", step.clone()),
            };
            if answer.is_accepted() {
                return executed + 1;
            }
            assert_eq!(answer.outcome, "refused", "{answer:?}");
            assert!(begin.elapsed() < PATIENCE, "{}: {answer:?}", self.machine);
            if answer.text.contains("take it") {
                self.accepted("take", json!({ "lease_s": 60 }));
            } else if answer.text.contains("holding") {
                let resumed = self.command("resume", json!({}));
                executed += u64::from(resumed.is_accepted());
            } else {
                // On its way still.
                std::thread::sleep(Duration::from_millis(50));
            }
        }
    }

    /// State of the machine.
    pub(crate) fn state(&self) -> Value {
        let key = format!("trirrr/{}/state", self.machine);
        let begin = Instant::now();
        loop {
            if let Some(state) = ask(&self.session, &key, None) {
                return state;
            }
            assert!(begin.elapsed() < PATIENCE, "{key} does not answer");
        }
    }

    /// Waits for a state that fits. Returns it.
    pub(crate) fn until(&self, fits: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        loop {
            let state = self.state();
            if fits(&state) {
                return state;
            }
            if begin.elapsed() > PATIENCE {
                let events = ask(
                    &self.session,
                    &format!("trirrr/{}/events", self.machine),
                    None,
                );
                panic!("{}: {state} {events:?}", self.machine);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
