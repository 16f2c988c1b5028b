//! Clients of a machine over TCP: one that commands it, and any number that watch. `trirrr device` and `trirrr bridge` share it.

mod args;
mod client;
mod door;
mod notes;
mod watchers;

pub use args::ListenArgs;
pub(crate) use args::{Doors, read_key};

use client::Client;
use door::Door;
use serde::de::DeserializeOwned;
use std::io;
use std::time::Duration;
use trirrr_protocol::message::{Event, Message, Refusal, Reply, Transmit};
use watchers::Watchers;

/// Connections that are looked at between two ticks: a flood of them costs no tick.
const ACCEPTED: usize = 4;

/// Meaning of a frame for those who get it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameKind {
    /// The answer to a hello: a watcher that comes later needs it.
    Identity,
    /// The state has changed: so does a watcher that comes later.
    State,
    /// A sample, which may be lost.
    Sample,
    /// Everything else.
    Other,
}

impl FrameKind {
    pub(crate) fn of<N: Transmit>(message: &Message<N>) -> Self {
        match message {
            Message::Reply {
                reply: Reply::Hello(_),
                ..
            } => Self::Identity,
            Message::Event(Event::State { .. }) => Self::State,
            Message::Telemetry(_) | Message::Drives(_) => Self::Sample,
            Message::Reply { .. } | Message::Event(_) => Self::Other,
        }
    }
}

/// Meaning of an answer for what is known of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    /// A hello was accepted. Everybody can say one.
    Greeted,
    /// The request was taken: its number was the right one.
    Known,
    /// The request waits for another one.
    Open,
    /// The request was refused because of what it asks, or was a hello for another machine.
    Refused,
    /// The request was refused because of its number, or because nobody has said hello.
    Guessed,
}

impl Standing {
    pub(crate) fn of<N: Transmit>(reply: &Reply<N>) -> Self {
        match reply {
            Reply::Hello(_) => Self::Greeted,
            Reply::Kept { .. } => Self::Open,
            Reply::Done | Reply::Section(_) | Reply::Status(_) | Reply::Update(_) => Self::Known,
            Reply::Refused(refusal) => match refusal {
                Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused => {
                    Self::Guessed
                }
                _ => Self::Refused,
            },
        }
    }
}

/// Clients of a machine: one master, and watchers.
pub(crate) struct Hub {
    door: Door,
    watchers: Option<Watchers>,
    /// Silence after which a client gives way to another.
    silence: Duration,
    client: Option<Client>,
    clients: u64,
    notes: Vec<String>,
}

impl Hub {
    pub(crate) fn new(doors: Doors, silence: Duration) -> Self {
        Self {
            door: Door::new(doors.listen, "client"),
            watchers: doors.watch.map(Watchers::new),
            silence,
            client: None,
            clients: 0,
            notes: Vec::new(),
        }
    }

    /// Returns the number of clients so far.
    pub(crate) fn clients(&self) -> u64 {
        self.clients
    }

    /// Returns true if a client is connected.
    pub(crate) fn has_client(&self) -> bool {
        self.client.is_some()
    }

    /// Returns true if the machine has executed a request of the client.
    pub(crate) fn knows_client(&self) -> bool {
        self.client.as_ref().is_some_and(Client::is_known)
    }

    /// Returns the samples that the client has lost because it does not read.
    pub(crate) fn dropped(&self) -> u32 {
        self.client.as_ref().map_or(0, Client::dropped)
    }

    /// Returns what has happened since the last call, in words.
    pub(crate) fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Lets clients and watchers in. Never waits.
    ///
    /// # Errors
    /// A port is lost.
    pub(crate) fn accept(&mut self) -> io::Result<()> {
        for _ in 0..ACCEPTED {
            let Some((link, from)) = self.door.next(&mut self.notes)? else {
                break;
            };
            // A client keeps the machine. A line that was cut shows by its silence only.
            if let Some(client) = &self.client {
                if client.keeps_its_place(self.silence) {
                    let by = client.from();
                    let note = format!("client {from} is turned away: {by} is connected");
                    self.notes.push(note);
                    link.turn_away();
                    continue;
                }
                let note = format!("the client is silent, {from} takes its place");
                self.notes.push(note);
            }
            self.clients += 1;
            self.notes.push(format!("client {from} is connected"));
            self.client = Some(Client::new(link, from));
        }
        match &mut self.watchers {
            Some(watchers) => watchers.accept(&mut self.notes),
            None => Ok(()),
        }
    }

    /// Takes the requests of the client that have come.
    pub(crate) fn requests<R: DeserializeOwned>(&mut self) -> Vec<R> {
        self.with_client(Client::requests).unwrap_or_default()
    }

    /// Returns true if the next request of the client is to be executed: it is still there, and has not said more hellos than anybody needs.
    pub(crate) fn takes(&mut self, is_hello: bool) -> bool {
        let Some(client) = &mut self.client else {
            return false;
        };
        if is_hello && !client.may_greet() {
            self.cut("it says hello again and again, and nothing else");
            return false;
        }
        true
    }

    /// Takes note of an answer to the client, before it is put. A client whose first request beside hellos does not know its number gets the answer, and is cut off:
    /// numbers are not to be tried.
    pub(crate) fn judge(&mut self, standing: Standing, frame: &[u8]) {
        let kind = match standing {
            Standing::Greeted => FrameKind::Identity,
            _ => FrameKind::Other,
        };
        self.put(frame, kind);
        let Some(client) = &mut self.client else {
            return;
        };
        match standing {
            Standing::Known => {
                client.is_heard();
                client.is_executed();
            }
            Standing::Greeted | Standing::Open => client.is_heard(),
            Standing::Guessed if !client.is_known() => {
                self.cut("its requests do not follow a hello, or have other numbers");
            }
            Standing::Refused | Standing::Guessed => {}
        }
    }

    /// Puts a frame of the machine behind what waits for the client and the watchers.
    pub(crate) fn put(&mut self, frame: &[u8], kind: FrameKind) {
        if let Some(client) = &mut self.client {
            client.put(frame, kind == FrameKind::Sample);
        }
        if let Some(watchers) = &mut self.watchers {
            watchers.put(frame, kind);
        }
    }

    /// Sends what goes without waiting.
    pub(crate) fn flush(&mut self) {
        self.with_client(Client::flush);
        if let Some(watchers) = &mut self.watchers {
            watchers.flush(&mut self.notes);
        }
    }

    /// Closes the link of the client, if there is one, and says why.
    pub(crate) fn cut(&mut self, why: &str) {
        // What waits may tell the client more.
        self.with_client(Client::flush);
        let error = io::Error::new(io::ErrorKind::InvalidData, why);
        self.with_client(|_| Err::<(), _>(error));
    }

    /// Does `what` with the client, if there is one. An error removes the client.
    fn with_client<T>(&mut self, what: impl FnOnce(&mut Client) -> io::Result<T>) -> Option<T> {
        let client = self.client.as_mut()?;
        match what(client) {
            Ok(done) => Some(done),
            Err(error) => {
                let [dropped, damaged] = [client.dropped(), client.damaged()].map(u64::from);
                self.notes.push(format!(
                    "client {} is gone: {error}{}{}",
                    client.from(),
                    notes::counted(dropped, "samples dropped, for it did not read"),
                    notes::counted(damaged, "damaged frames")
                ));
                self.client = None;
                None
            }
        }
    }
}
