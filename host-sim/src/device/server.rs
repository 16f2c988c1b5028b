//! Work of a device between two ticks: its client, and the messages of the machine.

use super::client::Client;
use super::event_log::EventLog;
use super::motors::{self, Motors};
use std::io;
use std::time::{Duration, Instant};
use trirrr_client::local::LocalService;
use trirrr_client::transport::Listener;
use trirrr_drives::ObeyingDrives;
use trirrr_protocol::message::{Message, Reply};
use trirrr_service::ServiceNumber;

/// Slices of background work between two looks at the link.
const SLICES: u32 = 64;

/// Machine that serves one client at a time.
pub(super) struct Server<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    /// Simulated motors, if the machine has to be homed.
    motors: Option<Motors>,
    /// Simulated drives, if they tell where they are.
    drives: Option<ObeyingDrives<N>>,
    listener: Listener,
    /// Silence after which a client gives way to another.
    silence: Duration,
    client: Option<Client>,
    log: EventLog,
}

impl<'a, N: ServiceNumber> Server<'a, N> {
    pub(super) fn new(
        machine: &'a mut dyn LocalService<N>,
        motors: Option<Motors>,
        drives: Option<ObeyingDrives<N>>,
        listener: Listener,
        silence: Duration,
        log: EventLog,
    ) -> Self {
        Self {
            machine,
            motors,
            drives,
            listener,
            silence,
            client: None,
            log,
        }
    }

    /// Computes one tick and sends its messages.
    ///
    /// # Errors
    /// As [`Server::serve`].
    pub(super) fn tick(&mut self) -> io::Result<()> {
        let start = Instant::now();
        if let Some(motors) = &self.motors {
            self.machine.inputs(motors.inputs());
        }
        if let Some(drives) = &self.drives {
            let mut readings = drives.measure();
            if let Some(motors) = &self.motors {
                motors.press(&mut readings);
            }
            self.machine.hear(readings);
        }
        self.machine.tick();
        let shift = self.machine.shift();
        if let Some(drives) = &mut self.drives {
            if let Some(by) = shift {
                drives.shift(by);
            }
            drives.apply(self.machine.output());
        }
        if let Some(motors) = &mut self.motors {
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

    /// Executes requests of the client, works a little, and sends messages. Never waits. Returns true if
    /// there is more to do.
    ///
    /// # Errors
    /// The listener is lost.
    pub(super) fn serve(&mut self) -> io::Result<bool> {
        let heard = self.listen();
        self.accept()?;
        let busy = (0..SLICES).all(|_| self.machine.work());
        while let Some(message) = self.machine.outgoing() {
            self.log.message(&message);
            if let Some(client) = &mut self.client {
                client.put(message);
            }
        }
        self.with_client(Client::flush);
        Ok(heard || busy)
    }

    /// Counts a tick that came too late.
    pub(super) fn count_late(&mut self) {
        self.machine.count_late();
    }

    /// Ends the service. Returns the event log.
    pub(super) fn end(self) -> EventLog {
        if let Some(motors) = &self.motors {
            self.log.left(motors.errors());
        }
        self.log
    }

    fn accept(&mut self) -> io::Result<()> {
        while let Some((link, from)) = self.listener.accept()? {
            // A client keeps the machine. A line that was cut shows by its silence only.
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

    /// Answers the requests of the client. Returns true if there were any.
    fn listen(&mut self) -> bool {
        let Some(requests) = self.with_client(Client::requests::<N>) else {
            return false;
        };
        let heard = !requests.is_empty();
        for request in requests {
            let reply = self.machine.receive(&request);
            self.log.answered(&request, &reply);
            self.reply(request.sequence, reply);
            while let Some((sequence, reply)) = self.machine.receive_kept() {
                self.log.answered_kept(&reply);
                self.reply(sequence, reply);
            }
        }
        heard
    }

    fn reply(&mut self, sequence: u32, reply: Reply<N>) {
        if let Some(client) = &mut self.client {
            if !matches!(reply, Reply::Refused(_)) {
                client.is_heard();
            }
            client.put(Message::Reply { sequence, reply });
        }
    }

    /// Does `what` with the client, if there is one. An error removes the client.
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
