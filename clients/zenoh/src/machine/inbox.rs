//! Queries and tokens of clients.

use super::Worker;
use crate::answer::CommandOutcome;
use crate::command::{self, CommandText};
use crate::error::ZenohError;
use crate::keys::{self, MachineKeys};
use std::ops::Range;
use trirrr_service::ServiceNumber;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::SampleKind;
use zenoh::{Session, Wait};

/// Most samples in an answer: less than a megabyte.
const MOST_SAMPLES: usize = 4096;

/// Most events in an answer.
const MOST_EVENTS: usize = 1024;

/// Events in the answer to a query that names no range.
const LAST_EVENTS: u64 = 100;

/// QueriedPart of a machine that a query asks for.
#[derive(Clone, Copy, Debug)]
pub(super) enum QueriedPart {
    Identity,
    State,
    Telemetry,
    Events,
    Command,
}

/// Word of a client.
pub(super) enum Incoming {
    Query(QueriedPart, Query),
    /// The liveliness token of a client stands, or has gone.
    Token(String, bool),
}

/// Everything that a machine listens to, as long as it is kept.
pub(crate) struct Declared {
    _queryables: Vec<Queryable<()>>,
    _tokens: Subscriber<()>,
}

impl<N: ServiceNumber> Worker<'_, N> {
    /// Declares the queryables of the machine.
    ///
    /// # Errors
    /// Failed: the session.
    pub(crate) fn declare(
        &self,
        session: &Session,
        keys: &MachineKeys,
    ) -> Result<Declared, ZenohError> {
        let parts = [
            (QueriedPart::Identity, keys.of(keys::IDENTITY)),
            (QueriedPart::State, keys.of(keys::STATE)),
            (QueriedPart::Telemetry, keys.of(keys::TELEMETRY)),
            (QueriedPart::Events, keys.of(keys::EVENTS)),
            (QueriedPart::Command, keys.command("*")),
        ];
        let queryables = parts.map(|(part, key)| {
            let sender = self.sender.clone();
            let declared = session
                .declare_queryable(key.clone())
                // A worker that has ended answers nothing.
                .callback(move |query| {
                    let _ = sender.send(Incoming::Query(part, query));
                })
                .wait();
            declared.map_err(|error| ZenohError::zenoh(&key, &error))
        });
        let (sender, key) = (self.sender.clone(), keys.control("*"));
        let tokens = session
            .liveliness()
            .declare_subscriber(key.clone())
            .history(true)
            .callback(move |sample| {
                let name = sample.key_expr().as_str().rsplit('/').next();
                let client = name.unwrap_or_default().to_owned();
                let stands = sample.kind() == SampleKind::Put;
                let _ = sender.send(Incoming::Token(client, stands));
            })
            .wait();
        Ok(Declared {
            _queryables: queryables.into_iter().collect::<Result<_, _>>()?,
            _tokens: tokens.map_err(|error| ZenohError::zenoh(&key, &error))?,
        })
    }

    /// Takes what clients have said since the last call.
    pub(super) fn take_incoming(&mut self) {
        while let Ok(incoming) = self.inbox.try_recv() {
            match incoming {
                Incoming::Token(client, stands) => self.control.token(&client, stands),
                Incoming::Query(part, query) => self.answer_query(part, query),
            }
        }
    }

    fn answer_query(&mut self, part: QueriedPart, query: Query) {
        let json = Encoding::APPLICATION_JSON;
        match part {
            QueriedPart::Identity => {
                let text = self.identity_text();
                self.outlet
                    .answer(&query, keys::IDENTITY, text.into(), json);
            }
            QueriedPart::State => {
                let text = self.state_now();
                self.outlet.answer(&query, keys::STATE, text.into(), json);
            }
            QueriedPart::Telemetry => {
                let next = self.samples.next();
                match self.range(&query, next.saturating_sub(1), next) {
                    Ok(range) => {
                        let batch = self.batch(self.samples.kept(range, MOST_SAMPLES));
                        let bytes = Encoding::APPLICATION_OCTET_STREAM;
                        self.outlet.answer(&query, keys::TELEMETRY, batch, bytes);
                    }
                    Err(why) => self
                        .outlet
                        .refuse(&query, CommandOutcome::Refused(why).plain()),
                }
            }
            QueriedPart::Events => {
                let next = self.events.next();
                match self.range(&query, next.saturating_sub(LAST_EVENTS), next) {
                    Ok(range) => {
                        let text = self.events_text(self.events.kept(range, MOST_EVENTS));
                        self.outlet.answer(&query, keys::EVENTS, text.into(), json);
                    }
                    Err(why) => self
                        .outlet
                        .refuse(&query, CommandOutcome::Refused(why).plain()),
                }
            }
            QueriedPart::Command => self.take_command(query),
        }
    }

    /// Range of numbers that a query asks for; `from` to `to` where it names none.
    fn range(&self, query: &Query, from: u64, to: u64) -> Result<Range<u64>, String> {
        let parameters = query.parameters();
        if let Some(text) = parameters.get("session") {
            self.check_session(text)?;
        }
        let (first, end) = command::range(parameters.get("from"), parameters.get("to"))?;
        Ok(first.unwrap_or(from)..end.unwrap_or(to))
    }

    /// # Errors
    /// The session is none of this run: numbers of it mean nothing here.
    pub(super) fn check_session(&self, text: &str) -> Result<(), String> {
        match command::read_session(text) {
            Some(session) if session == self.setup.session => Ok(()),
            Some(_) => Err(format!(
                "session {text} is over: the program was started anew; say hello, and look at the state"
            )),
            None => Err(format!("session {text:?} is not 16 hexadecimal digits")),
        }
    }

    fn take_command(&mut self, query: Query) {
        let verb = query.key_expr().as_str().rsplit('/').next();
        let verb = verb.unwrap_or_default().to_owned();
        if verb == "status" {
            let text = self.state_now();
            return self.reply(&query, &verb, text);
        }
        let payload = query
            .payload()
            .map(|payload| payload.to_bytes().into_owned());
        let text = match CommandText::read(payload.as_deref()) {
            Ok(text) => text,
            Err(why) => return self.reply(&query, &verb, CommandOutcome::Refused(why).plain()),
        };
        if let Some(answer) = self.command(&verb, &text, &payload.unwrap_or_default(), &query) {
            self.reply(&query, &verb, answer);
        }
    }

    pub(super) fn reply(&mut self, query: &Query, verb: &str, text: String) {
        let part = format!("{}/{verb}", keys::COMMAND);
        self.outlet
            .answer(query, &part, text.into(), Encoding::APPLICATION_JSON);
    }
}
