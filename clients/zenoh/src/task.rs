//! Motions that take several requests: a goal, and the job of the scene. Their clients are those of the other host tools.

use crate::answer::CommandOutcome;
use std::time::Duration;
use trirrr_client::describe::{self, Units};
use trirrr_client::{Dialogue, GoalClient, JobClient, Turn};
use trirrr_protocol::message::{Message, Status, Transmit};

/// A motion under way, and the client that moves the machine.
pub(crate) struct Task<N: Transmit> {
    client: TaskClient<N>,
    /// Name of the client of this program that has asked for it.
    pub(crate) owner: String,
    /// Number of the command, until it is answered.
    pub(crate) asked: Option<u64>,
    /// The host was silent for too long meanwhile: the machine holds, and waits for a resume.
    pub(crate) is_held: bool,
    /// Tick of the status in which the machine had taken the goal: a later one says what became of it.
    taken: Option<u32>,
}

enum TaskClient<N: Transmit> {
    Goal(Box<GoalClient<N>>),
    Job(Box<JobClient<N>>),
}

impl<N: Transmit> Task<N> {
    pub(crate) fn goal(client: GoalClient<N>, owner: &str, number: u64) -> Self {
        Self::new(TaskClient::Goal(Box::new(client)), owner, number)
    }

    pub(crate) fn job(client: JobClient<N>, owner: &str, number: u64) -> Self {
        Self::new(TaskClient::Job(Box::new(client)), owner, number)
    }

    fn new(client: TaskClient<N>, owner: &str, number: u64) -> Self {
        Self {
            client,
            owner: owner.into(),
            asked: Some(number),
            is_held: false,
            taken: None,
        }
    }

    /// Word for the motion.
    pub(crate) fn word(&self) -> &'static str {
        match self.client {
            TaskClient::Goal(_) => "goal",
            TaskClient::Job(_) => "job",
        }
    }

    /// Last status that the client has.
    pub(crate) fn status(&self) -> Option<&Status<N>> {
        match &self.client {
            TaskClient::Goal(client) => client.status(),
            TaskClient::Job(client) => client.status(),
        }
    }

    /// Begins the conversation again: on another port, or behind another one.
    pub(crate) fn reconnected(&mut self) {
        match &mut self.client {
            TaskClient::Goal(client) => client.reconnected(),
            TaskClient::Job(client) => client.reconnected(),
        }
    }

    pub(crate) fn receive(&mut self, message: &Message<N>, now: Duration) {
        match &mut self.client {
            TaskClient::Goal(client) => client.receive(message, now),
            TaskClient::Job(client) => client.receive(message, now),
        }
    }

    /// Next act of the client. At the end: done, or the reason why not.
    pub(crate) fn poll(&mut self, now: Duration, units: &Units) -> Turn<N, Result<(), String>> {
        match &mut self.client {
            TaskClient::Goal(client) => {
                let turn = client.poll(now);
                turn.map(|end| end.map_err(|failure| failure.describe(units)))
            }
            TaskClient::Job(client) => {
                let turn = client.poll(now);
                turn.map(|end| end.map_err(|failure| client.describe(&failure)))
            }
        }
    }

    /// CommandOutcome of the command, as soon as the machine has decided.
    pub(crate) fn decided(&mut self, units: &Units) -> Option<CommandOutcome> {
        match &mut self.client {
            TaskClient::Job(client) => (client.offered() > 0).then_some(CommandOutcome::Accepted),
            TaskClient::Goal(client) => {
                if let Some(violation) = client.take_refused() {
                    let why = describe::violation(&violation, 0, units);
                    return Some(CommandOutcome::Refused(why));
                }
                let status = client.status()?;
                if client.is_wanting() {
                    return None;
                }
                let taken = *self.taken.get_or_insert(status.tick);
                (status.tick != taken && !status.planning).then_some(CommandOutcome::Accepted)
            }
        }
    }
}
