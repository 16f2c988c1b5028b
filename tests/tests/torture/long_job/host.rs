//! A host that plays the job as `trirrr stream` does: with a journal, by which another one goes on where it was killed.

use std::rc::Rc;
use std::time::Duration;
use trirrr_bench::device::{MessageDecoder, TICK_RATE_HZ, hello_in, request_frame};
use trirrr_bench::slow_link::SlowLink;
use trirrr_client::{Dialogue, JobClient, JobFailure, JobMark, JobPlace, JobRest, Patience};
use trirrr_protocol::message::Message;

/// Ticks from one entry of the journal to the next.
pub(super) const JOURNAL_EVERY: u64 = 100;

/// Duration of the way to the start of what is left, s.
const BACK_S: f64 = 2.0;

/// End of a turn of the host.
pub(super) enum Turn {
    /// It listens.
    Listens,
    /// It has opened the port anew, for nothing answers.
    OpensAnew,
    /// The job has ended: complete, or as the failure says.
    Ended(Result<(), JobFailure<f32>>),
}

/// The host.
pub(super) struct Host {
    /// Moves that are played: the job, or the rest of it. A killed host has it from the scene and the journal.
    rest: Rc<JobRest<f32>>,
    journal: Option<JobMark>,
    written: u64,
    /// Number of the last conversation.
    conversation: u32,
    /// Requests that processes before have repeated.
    repeated: u64,
    process: Process,
}

/// Part of the host that is lost when it is killed.
struct Process {
    client: JobClient<f32>,
    decoder: MessageDecoder,
    mark: JobMark,
    /// It goes on with what another one has begun.
    is_attached: bool,
}

impl Host {
    pub(super) fn new(rest: JobRest<f32>) -> Self {
        let rest = Rc::new(rest);
        let process = Process::new(&rest, 0);
        Self {
            rest,
            journal: None,
            written: 0,
            conversation: 0,
            repeated: 0,
            process,
        }
    }

    /// Returns the moves that are played.
    pub(super) fn rest(&self) -> &Rc<JobRest<f32>> {
        &self.rest
    }

    /// Requests that were repeated.
    pub(super) fn repeated(&self) -> u64 {
        self.repeated + self.process.client.repeated()
    }

    fn begin_process(&mut self) {
        self.repeated = self.repeated();
        self.conversation += 1;
        self.process = Process::new(&self.rest, self.conversation);
    }

    /// Another host begins with nothing but the journal.
    pub(super) fn restart(&mut self) {
        self.begin_process();
        let Some(mark) = self.journal else {
            return;
        };
        let process = &mut self.process;
        process.mark = mark;
        if let Some(begun) = mark.begun() {
            process.client = process.client.clone().attached(begun);
            process.is_attached = true;
        }
    }

    /// Goes on after a job that the machine has lost: first by the journal, then back to the place.
    pub(super) fn go_back(&mut self, rest: impl Fn(JobPlace) -> JobRest<f32>) {
        self.reach();
        if !self.process.is_attached {
            self.note();
            // A machine that never had a part of it has nothing to go on with.
            if self.journal.is_some_and(|mark| mark.begun().is_some()) {
                return self.restart();
            }
        }
        self.rest = Rc::new(rest(self.process.mark.reached));
        self.journal = None;
        self.begin_process();
        let client = self.process.client.clone();
        self.process.client = client.with_recovery(BACK_S);
    }

    /// The port is opened anew.
    pub(super) fn reopen(&mut self) {
        self.process.decoder.reset();
        self.process.client.reconnected();
    }

    /// Hears what has arrived, says what is to be said, and writes the journal.
    pub(super) fn turn(&mut self, tick: u64, there: &mut SlowLink, back: &mut SlowLink) -> Turn {
        let now = Duration::from_secs_f64(tick as f64 / TICK_RATE_HZ);
        while let Some(bytes) = back.receive(tick) {
            self.hear(&bytes, now);
        }
        let turn = loop {
            match self.process.client.poll(now) {
                trirrr_client::Turn::Send(request) => there.send(&request_frame(&request)),
                trirrr_client::Turn::Wait(until) => {
                    assert!(until > now, "nothing to wait for at {now:?}");
                    break Turn::Listens;
                }
                trirrr_client::Turn::Reconnect => {
                    self.reopen();
                    break Turn::OpensAnew;
                }
                trirrr_client::Turn::Done(result) => break Turn::Ended(result),
            }
        };
        let is_named = self.process.client.first_move() != self.process.mark.first_move;
        if is_named || tick >= self.written + JOURNAL_EVERY {
            self.written = tick;
            self.note();
        }
        turn
    }

    fn hear(&mut self, mut bytes: &[u8], now: Duration) {
        while let Some(frame) = self.process.decoder.take::<Message<f32>>(&mut bytes) {
            // One that was cut off is asked for again.
            let Ok(message) = frame else {
                continue;
            };
            self.process.client.receive(&message, now);
        }
    }

    /// Takes in what the client knows.
    fn reach(&mut self) {
        let Process { mark, client, .. } = &mut self.process;
        mark.note(client, |place| self.rest.place(place));
    }

    /// Writes the journal, as far as anything is known.
    fn note(&mut self) {
        if self.process.client.status().is_some() {
            self.reach();
            self.journal = Some(self.process.mark);
        }
    }

    pub(super) fn describe(&self, failure: &JobFailure<f32>) -> String {
        self.process.client.describe(failure)
    }
}

impl Process {
    fn new(rest: &JobRest<f32>, conversation: u32) -> Self {
        let moves = rest.moves().to_vec();
        // Numbers of hellos of one client do not meet those of the next.
        let conversation = conversation << 16;
        Self {
            client: JobClient::new(
                moves,
                hello_in::<f32>(),
                1,
                Patience::default(),
                conversation,
            ),
            decoder: MessageDecoder::new(),
            mark: JobMark::at(rest.from()),
            is_attached: false,
        }
    }
}
