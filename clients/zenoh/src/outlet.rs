//! Keys that a machine publishes.

use crate::error::ZenohError;
use crate::keys::{self, MachineKeys};
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::{Session, Wait};

/// Publishers of one machine. None of them makes the machine wait: what finds no way is dropped, and fetched from the history.
pub(crate) struct Outlet {
    session: Session,
    keys: MachineKeys,
    identity: Publisher<'static>,
    state: Publisher<'static>,
    telemetry: Publisher<'static>,
    events: Publisher<'static>,
    joints: Option<Publisher<'static>>,
    alive: Option<LivelinessToken>,
    /// An error was told since the last success.
    is_told: bool,
}

impl Outlet {
    /// Declares the publishers.
    ///
    /// # Errors
    /// Failed: the session.
    pub(crate) fn declare(
        session: &Session,
        keys: &MachineKeys,
        ros: bool,
    ) -> Result<Self, ZenohError> {
        let publisher = |part: &str, encoding: Encoding, priority| {
            let key = keys.of(part);
            let declared = session
                .declare_publisher(key.clone())
                .encoding(encoding)
                .congestion_control(CongestionControl::Drop)
                .priority(priority)
                .wait();
            declared.map_err(|error| ZenohError::zenoh(&key, &error))
        };
        Ok(Self {
            identity: publisher(keys::IDENTITY, Encoding::APPLICATION_JSON, Priority::Data)?,
            state: publisher(
                keys::STATE,
                Encoding::APPLICATION_JSON,
                Priority::InteractiveHigh,
            )?,
            telemetry: publisher(
                keys::TELEMETRY,
                Encoding::APPLICATION_OCTET_STREAM,
                Priority::DataLow,
            )?,
            events: publisher(keys::EVENTS, Encoding::APPLICATION_JSON, Priority::DataHigh)?,
            joints: match ros {
                true => {
                    let cdr = Encoding::APPLICATION_CDR;
                    Some(publisher(keys::JOINT_STATES, cdr, Priority::DataLow)?)
                }
                false => None,
            },
            session: session.clone(),
            keys: keys.clone(),
            alive: None,
            is_told: false,
        })
    }

    pub(crate) fn identity(&mut self, text: &str) {
        let done = self.identity.put(text).wait();
        self.tell(done);
    }

    pub(crate) fn state(&mut self, text: &str) {
        let done = self.state.put(text).wait();
        self.tell(done);
    }

    pub(crate) fn telemetry(&mut self, batch: Vec<u8>) {
        let done = self.telemetry.put(batch).wait();
        self.tell(done);
    }

    /// Publishes the message of `joints`, if any is asked for.
    pub(crate) fn joints(&mut self, message: impl FnOnce() -> Vec<u8>) {
        if let Some(joints) = &self.joints {
            let done = joints.put(message()).wait();
            self.tell(done);
        }
    }

    pub(crate) fn event(&mut self, text: &str) {
        let done = self.events.put(text).wait();
        self.tell(done);
    }

    /// Declares the token of the machine, or takes it back.
    pub(crate) fn alive(&mut self, is_alive: bool) {
        match is_alive {
            true if self.alive.is_none() => {
                let key = self.keys.of(keys::ALIVE);
                match self.session.liveliness().declare_token(key).wait() {
                    Ok(token) => self.alive = Some(token),
                    Err(error) => self.tell(Err(error)),
                }
            }
            true => {}
            // A token that is dropped is taken back.
            false => self.alive = None,
        }
    }

    /// Answers a query for `part` of the machine.
    pub(crate) fn answer(
        &mut self,
        query: &Query,
        part: &str,
        payload: Vec<u8>,
        encoding: Encoding,
    ) {
        let key = self.keys.of(part);
        let done = query.reply(key, payload).encoding(encoding).wait();
        self.tell(done);
    }

    /// Answers a query with an error.
    pub(crate) fn refuse(&mut self, query: &Query, payload: String) {
        let done = query
            .reply_err(payload)
            .encoding(Encoding::APPLICATION_JSON)
            .wait();
        self.tell(done);
    }

    /// Tells the first of several errors: what was not published is in the history.
    fn tell(&mut self, done: zenoh::Result<()>) {
        if let Err(error) = &done
            && !self.is_told
        {
            eprintln!("Zenoh: {}: {error}", self.keys.of("**"));
        }
        self.is_told = done.is_err();
    }
}
