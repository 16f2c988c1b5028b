//! A job on a machine in the same program: client and service talk in one thread, without a line.

use crate::dialogue::{Dialogue, Turn};
use crate::job_client::{JobClient, JobWork};
use crate::local::LocalService;
use crate::{JobFailure, Patience};
use std::time::Duration;
use trirrr_core::tick::Motion;
use trirrr_protocol::message::{
    AnyMove, Command, Hello, Message, Reply, Request, State, Telemetry, Transmit,
};
use trirrr_scene::JobOutputs;
use trirrr_service::board::Readings;
use trirrr_service::{Output, ServiceNumber};

/// One tick of a machine that plays a job.
#[derive(Clone, Debug)]
pub struct PlayedTick<N: Transmit> {
    /// Telemetry sample of the tick.
    pub sample: Telemetry<N>,
    /// Motion that the machine computed for the sample's setpoint. `None` if the machine stood.
    pub motion: Option<Motion<N>>,
}

/// Part of a job that a runner is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobPart {
    /// The path has not begun.
    Before,
    /// The next tick is one of the path.
    Path,
    /// The path is over: the machine comes to its state of rest.
    After,
}

/// Plays one job on a [`LocalService`] by the [`JobClient`] that plays jobs over a line.
///
/// Time is the machine's: it goes on by one period with each tick. The owner decides when a tick is
/// due, and calls [`talk`](Self::talk) between ticks.
pub struct JobRunner<'a, N: ServiceNumber> {
    service: &'a mut dyn LocalService<N>,
    client: JobClient<N>,
    part: JobPart,
    period: Duration,
    now: Duration,
}

impl<'a, N: ServiceNumber> JobRunner<'a, N> {
    /// Creates the runner of `work` on `service`, a machine that is what `hello` says and ticks at
    /// `tick_rate_hz`. [Supplied](JobWork::Supplied) moves are to be supplied before each [`talk`](Self::talk).
    pub fn new(
        service: &'a mut dyn LocalService<N>,
        work: impl Into<JobWork<N>>,
        hello: Hello,
        tick_rate_hz: f64,
    ) -> Self {
        let period = Duration::from_secs_f64(1.0 / tick_rate_hz);
        // A status between any two ticks, as there is no line to spare: a machine whose moves are
        // short is fed in time.
        let client = JobClient::new(work, hello, 1, Patience::default(), 0);
        Self {
            service,
            client: client.with_status_every(period),
            part: JobPart::Before,
            period,
            now: Duration::ZERO,
        }
    }

    /// Lets spare outputs change with the moves of the job, as [`JobClient::with_outputs`].
    #[must_use]
    pub fn with_outputs(mut self, outputs: &JobOutputs) -> Self {
        self.client = self.client.with_outputs(outputs);
        self
    }

    /// Returns the part of the job that the next tick belongs to.
    pub fn part(&self) -> JobPart {
        self.part
    }

    /// Returns the index of the move that is to be supplied next, as [`JobClient::wants`].
    pub fn wants(&self) -> Option<u32> {
        self.client.wants()
    }

    /// Takes moves from the move `index` on, as [`JobClient::supply`].
    pub fn supply(&mut self, index: u32, moves: impl IntoIterator<Item = AnyMove<N>>) {
        self.client.supply(index, moves);
    }

    /// Describes `failure` in words and SI units.
    pub fn describe(&self, failure: &JobFailure<N>) -> String {
        self.client.describe(failure)
    }

    /// Lets client and machine talk until they wait for a tick. Returns the end of the job once the
    /// client knows it.
    pub fn talk(&mut self) -> Option<Result<(), JobFailure<N>>> {
        loop {
            match self.client.poll(self.now) {
                Turn::Send(request) => {
                    let reply = self.service.answer(&request);
                    // Moves are judged before the client asks what became of them.
                    while self.service.step() {}
                    let is_done = reply == Reply::Done;
                    let Request { sequence, command } = request;
                    let message = Message::Reply { sequence, reply };
                    self.client.receive(&message, self.now);
                    if is_done && !command.brings_moves() {
                        // The tick takes one order at a time: the one after a start is the first of
                        // the path.
                        if matches!(command, Command::Start) {
                            self.part = JobPart::Path;
                        }
                        return None;
                    }
                }
                Turn::Wait(_) => return None,
                Turn::Reconnect => self.client.reconnected(),
                Turn::Done(result) => return Some(result),
            }
        }
    }

    /// Sets what the drives tell in the next tick, of a machine that [senses](crate::local::Sensed::drives) its drives.
    pub fn hear(&mut self, readings: Readings<N>) {
        self.service.hear(readings);
    }

    /// Returns the output of the last tick.
    pub fn output(&self) -> &Output<N> {
        self.service.output()
    }

    /// Returns the state of the machine.
    pub fn state(&self) -> State {
        self.service.state()
    }

    /// Computes one tick of the machine. Returns its duration.
    pub fn tick(&mut self) -> Duration {
        self.now += self.period;
        self.service.timed_tick()
    }

    /// Hands the events of the last tick to the client. Returns what the tick played, from the first
    /// tick of the path on.
    pub fn collect(&mut self) -> Option<PlayedTick<N>> {
        let mut played = None;
        while let Some(message) = self.service.outgoing() {
            match message {
                Message::Telemetry(sample) if self.part != JobPart::Before => {
                    played = Some(PlayedTick {
                        sample,
                        motion: self.service.motion().map(|(_, motion)| *motion),
                    });
                }
                message => self.client.receive(&message, self.now),
            }
        }
        if let Some(PlayedTick { sample, .. }) = &played
            && self.client.is_last(sample)
        {
            self.part = JobPart::After;
        }
        played
    }
}
