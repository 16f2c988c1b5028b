//! What a device does between two ticks: its client, and what the machine has to say.

use super::client::Client;
use super::event_log::EventLog;
use super::motors::{self, Motors};
use std::io;
use std::time::{Duration, Instant};
use trirrr_client::local::LocalService;
use trirrr_client::transport::Listener;
use trirrr_protocol::message::Message;
use trirrr_service::ServiceNumber;

/// Slices of background work between two looks at the link.
const SLICES: u32 = 64;

/// A machine that listens: one client at a time, the next one when that has gone.
pub(super) struct Server<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    /// The motors, where the machine has to find them.
    motors: Option<Motors>,
    listener: Listener,
    /// A client that is silent for this long gives way to another.
    silence: Duration,
    client: Option<Client>,
    log: EventLog,
}

impl<'a, N: ServiceNumber> Server<'a, N> {
    pub(super) fn new(
        machine: &'a mut dyn LocalService<N>,
        motors: Option<Motors>,
        listener: Listener,
        silence: Duration,
        log: EventLog,
    ) -> Self {
        Self {
            machine,
            motors,
            listener,
            silence,
            client: None,
            log,
        }
    }

    /// One tick, and what it gave is sent.
    ///
    /// # Errors
    /// As [`Server::serve`].
    pub(super) fn tick(&mut self) -> io::Result<()> {
        let start = Instant::now();
        if let Some(motors) = &self.motors {
            self.machine.inputs(motors.inputs());
        }
        self.machine.tick();
        if let Some(motors) = &mut self.motors {
            let shift = self.machine.shift();
            let shift = shift.map(|by| by.map(N::angle_to_f64));
            motors.follow(motors::angles(self.machine.motors()), shift);
            if shift.is_some() {
                self.log.referenced(motors.errors());
            }
        }
        let took = u32::try_from(start.elapsed().as_nanos());
        self.machine.report_timing(took.unwrap_or(u32::MAX));
        self.log.tick();
        self.serve().map(|_| ())
    }

    /// Takes what the client says, works a little, sends what there is; never waits. Whether there
    /// is more to do.
    ///
    /// # Errors
    /// Nobody can be listened to any more.
    pub(super) fn serve(&mut self) -> io::Result<bool> {
        let heard = self.listen();
        self.accept()?;
        let busy = (0..SLICES).all(|_| self.machine.work());
        while let Some(message) = self.machine.outgoing() {
            self.log.message(&message);
            if let Some(client) = &mut self.client {
                client.put(&message);
            }
        }
        self.with_client(Client::flush);
        Ok(heard || busy)
    }

    /// The log, when all is over.
    pub(super) fn end(self) -> EventLog {
        if let Some(motors) = &self.motors {
            self.log.left(motors.errors());
        }
        self.log
    }

    fn accept(&mut self) -> io::Result<()> {
        while let Some((link, from)) = self.listener.accept()? {
            // Who is on the line has the machine. But of a line that was cut without a word, its
            // silence is all that is heard.
            if let Some(client) = &self.client {
                if client.is_heard_within(self.silence) {
                    self.log.turned_away(from, client.from());
                    continue;
                }
                self.log.replaced(from);
            }
            self.log.connected(from);
            self.client = Some(Client::new(link, from));
        }
        Ok(())
    }

    /// Answers what the client has asked; whether it has asked anything.
    fn listen(&mut self) -> bool {
        let Some(requests) = self.with_client(Client::requests::<N>) else {
            return false;
        };
        let heard = !requests.is_empty();
        for request in requests {
            let reply = self.machine.receive(&request);
            self.log.answered(&request, &reply);
            let sequence = request.sequence;
            if let Some(client) = &mut self.client {
                client.put(&Message::Reply { sequence, reply });
            }
        }
        heard
    }

    /// Does `what` with the client, if there is one. If it is gone by that, there is none any more.
    fn with_client<T>(&mut self, what: impl FnOnce(&mut Client) -> io::Result<T>) -> Option<T> {
        let client = self.client.as_mut()?;
        match what(client) {
            Ok(done) => Some(done),
            Err(error) => {
                self.log.gone(client, &error);
                self.client = None;
                None
            }
        }
    }
}
