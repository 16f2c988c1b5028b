//! A client and a board, and a line between them that may damage what it carries.

use crate::expected::Expected;
use crate::port::{self, Port};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use trirrr_bench::faulty_link::{FaultyLink, Random};
use trirrr_bench::sent::Sent;
use trirrr_client::local::HostNumber;
use trirrr_client::{Dialogue, JobClient, JobFailure, JobWork, Patience, Turn, UserCommand};
use trirrr_line::Frames;
use trirrr_protocol::message::{Message, Reply, Telemetry, TelemetryFields};

/// Longest look at the line while there is something else to do.
const LOOK: Duration = Duration::from_millis(2);

/// How long the samples behind the end of a job may take.
const LAST_SAMPLES: Duration = Duration::from_secs(5);

/// A job that takes so much longer than three times its duration does not end.
const LONGEST: Duration = Duration::from_secs(300);

/// Of so many ticks, in one the user holds the job or resumes it.
const HOLD_EVERY: u64 = 400;

/// Samples that may wait on a board and be sent after an answer although they are older, one that comes
/// about with the answer, and one more, for a sample tells how long the tick before it took.
const WAITING: u32 = 9;

/// Whether bytes to the board may be in what the next sample tells of.
#[derive(Clone, Copy, Debug)]
enum Noise {
    /// A request is not answered yet.
    Asked,
    /// It was answered in this tick.
    Until(u32),
    /// It was answered so many samples ago, at least.
    Samples(u32),
}

impl Noise {
    /// Whether it is over by the sample of `tick`, which is the next one.
    fn is_over(&mut self, tick: u32) -> bool {
        match self {
            Self::Asked => false,
            // Ticks only go forwards, and wrap.
            Self::Until(answered) => (2..1 << 31).contains(&tick.wrapping_sub(*answered)),
            Self::Samples(left) => {
                *left = left.saturating_sub(1);
                *left == 0
            }
        }
    }
}

/// How a client says that its job has ended.
pub(crate) type End<N> = Result<(), JobFailure<N>>;

/// What happened on the line.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) requests: u64,
    pub(crate) messages: u64,
    pub(crate) repeated: u64,
    pub(crate) dropped_frames: u64,
    pub(crate) reconnects: u64,
    pub(crate) holds: u64,
    /// Bytes to the board.
    pub(crate) bytes: u64,
}

/// When a sample comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// The client has heard that the job is over.
    pub(crate) over: bool,
    /// No byte to the board was under way in the tick whose duration the sample tells. In an emulator
    /// a request comes as fast as it is read, and the interrupts of a hundred bytes may fall into
    /// one tick; on a line at 921,600 baud it is one in 1,800 cycles.
    pub(crate) quiet: bool,
}

/// The line, over many jobs.
pub(crate) struct Conversation {
    port: Option<Port>,
    pub(crate) to_board: FaultyLink,
    pub(crate) to_client: FaultyLink,
    sent_by_board: Sent,
    frames: Frames,
    /// For holds, and for where frames are split on their way; none leaves the job alone.
    random: Option<Random>,
    held: bool,
    /// Job that the next client goes on with.
    attached: Option<u32>,
    number: u32,
    /// Content of samples.
    fields: TelemetryFields,
    pub(crate) tally: Tally,
}

impl Conversation {
    /// Over a line that damages nothing.
    pub(crate) fn undisturbed(port: Port) -> Self {
        Self::new(port, 0, 0, None)
    }

    /// Over a line that damages `percent` of all frames, with a user who holds the job now and then.
    pub(crate) fn disturbed(port: Port, percent: u64, random: &mut Random) -> Self {
        let seeds = [random.bits(), random.bits()];
        let own = Random::new(random.bits());
        let mut new = Self::new(port, 0, 0, Some(own));
        new.to_board = FaultyLink::new(seeds[0], percent);
        new.to_client = FaultyLink::new(seeds[1], percent);
        new
    }

    fn new(port: Port, seed: u64, percent: u64, random: Option<Random>) -> Self {
        Self {
            port: Some(port),
            to_board: FaultyLink::new(seed, percent),
            to_client: FaultyLink::new(seed, percent),
            sent_by_board: Sent::default(),
            frames: Frames::default(),
            random,
            held: false,
            attached: None,
            number: std::process::id(),
            fields: TelemetryFields::ALL,
            tally: Tally::default(),
        }
    }

    /// Asks for samples with `fields` only.
    pub(crate) fn with_fields(mut self, fields: TelemetryFields) -> Self {
        self.fields = fields;
        self
    }

    /// Lets the next client go on with the job that the machine has.
    pub(crate) fn attach(&mut self) {
        self.attached = Some(0);
    }

    /// The line itself, when the conversation is over.
    pub(crate) fn end(self) -> Result<Port> {
        self.port.context("the line is lost")
    }

    /// Plays `work` to its end. `see` gets each sample as the board sends it, and may break the
    /// conversation off; after the end it is called for what follows until it does.
    ///
    /// # Errors
    /// The job does not end as it should, or `see` complains.
    pub(crate) fn play<N: HostNumber>(
        &mut self,
        expected: &Expected<N>,
        work: impl Into<JobWork<N>>,
        see: impl FnMut(&Telemetry<N>, Moment) -> Result<ControlFlow<()>>,
    ) -> Result<JobClient<N>> {
        let (client, result) = self.converse(expected, work, see)?;
        result.map_err(|failure| anyhow!(client.describe(&failure)))?;
        Ok(client)
    }

    /// As [`Conversation::play`], with how the client says that the job has ended: well too where `see`
    /// breaks off before.
    ///
    /// # Errors
    /// The job does not end, or `see` complains.
    pub(crate) fn converse<N: HostNumber>(
        &mut self,
        expected: &Expected<N>,
        work: impl Into<JobWork<N>>,
        mut see: impl FnMut(&Telemetry<N>, Moment) -> Result<ControlFlow<()>>,
    ) -> Result<(JobClient<N>, End<N>)> {
        let patience = Patience {
            answer: Duration::from_millis(if self.random.is_some() { 20 } else { 500 }),
            attempts: 7,
        };
        self.number = self.number.wrapping_add(1000);
        let work = work.into();
        let moves = work.moves().unwrap_or_default();
        let ticks: u64 = moves
            .iter()
            .map(|each| u64::from(each.common().ticks))
            .sum();
        let seconds = ticks as f64 / expected.scene.tick_rate_hz;
        let longest = LONGEST + Duration::from_secs_f64(3.0 * seconds);
        let mut client =
            JobClient::new(work, expected.hello, 1, patience, self.number).with_fields(self.fields);
        if let Some(taken) = self.attached.take() {
            client = client.attached((taken, None));
        }
        let start = Instant::now();
        let mut over: Option<(Instant, End<N>)> = None;
        let mut ticks = 0;
        let mut noise = Noise::Asked;
        loop {
            ensure!(
                start.elapsed() < longest,
                "the job does not end: {:?}",
                client.status()
            );
            let mut wait = LOOK;
            if over.is_none() {
                wait = match client.poll(start.elapsed()) {
                    Turn::Send(request) => {
                        self.tally.requests += 1;
                        noise = Noise::Asked;
                        self.to_board.send(&port::frame(&request));
                        self.send()?;
                        continue;
                    }
                    Turn::Wait(until) => until.saturating_sub(start.elapsed()).min(LOOK),
                    Turn::Reconnect => {
                        self.reconnect()?;
                        client.reconnected();
                        continue;
                    }
                    Turn::Done(result) => {
                        over = Some((Instant::now(), result));
                        continue;
                    }
                };
            }
            let port = self.port.as_mut().context("the line is lost")?;
            for frame in port.frames(wait.max(Duration::from_millis(1)))? {
                let message = port::message::<N>(&frame)
                    .with_context(|| format!("the board sends no frame: {frame:02X?}"))?;
                self.tally.messages += 1;
                self.sent_by_board.record(&frame);
                self.to_client.send(&frame);
                let sample = match &message {
                    Message::Telemetry(sample) => sample,
                    Message::Reply { reply, .. } => {
                        noise = match reply {
                            Reply::Status(status) => Noise::Until(status.tick),
                            _ => Noise::Samples(WAITING),
                        };
                        continue;
                    }
                    Message::Event(_) | Message::Drives(_) => continue,
                };
                ticks += 1;
                let moment = Moment {
                    over: over.is_some(),
                    quiet: noise.is_over(sample.tick),
                };
                if see(sample, moment)?.is_break() {
                    self.tally.repeated += client.repeated();
                    return Ok((client, over.map_or(Ok(()), |(_, result)| result)));
                }
            }
            for _ in 0..std::mem::take(&mut ticks) {
                self.ask_for_holds(&mut client);
            }
            self.hear(&mut client, start.elapsed())?;
            if let Some((end, result)) = over
                && end.elapsed() > LAST_SAMPLES
            {
                result.map_err(|failure| anyhow!(client.describe(&failure)))?;
                bail!("the samples of the job's end do not come");
            }
        }
    }

    /// Hands on what reaches the client.
    fn hear<N: HostNumber>(&mut self, client: &mut JobClient<N>, now: Duration) -> Result<()> {
        while let Some(bytes) = self.to_client.receive() {
            let mut messages: Vec<Message<N>> = Vec::new();
            self.frames
                .receive(&bytes, |message| messages.push(message));
            for message in messages {
                self.sent_by_board
                    .check(&port::frame(&message))
                    .map_err(|why| anyhow!("the client: {why}"))?;
                client.receive(&message, now);
            }
        }
        Ok(())
    }

    /// Hands on what reaches the board, in pieces where the line is a bad one.
    fn send(&mut self) -> Result<()> {
        let port = self.port.as_mut().context("the line is lost")?;
        while let Some(bytes) = self.to_board.receive() {
            let at = match &mut self.random {
                Some(random) => random.below(bytes.len() as u64 + 1) as usize,
                None => 0,
            };
            let (first, rest) = bytes.split_at(at);
            self.tally.bytes += bytes.len() as u64;
            port.send(first)?;
            if let (Some(random), false) = (&mut self.random, first.is_empty() || rest.is_empty()) {
                std::thread::sleep(Duration::from_micros(random.below(5000)));
            }
            port.send(rest)?;
        }
        Ok(())
    }

    /// Now and then the user holds the job, and resumes it.
    fn ask_for_holds<N: HostNumber>(&mut self, client: &mut JobClient<N>) {
        if let Some(random) = &mut self.random
            && random.below(HOLD_EVERY) == 0
        {
            self.tally.holds += u64::from(!self.held);
            client.command(match self.held {
                true => UserCommand::Resume,
                false => UserCommand::Hold,
            });
            self.held = !self.held;
        }
    }

    /// The line is torn and joined again; what was on it is lost, but for what the board sent: a
    /// checker of every tick has to see that.
    fn reconnect(&mut self) -> Result<()> {
        self.tally.reconnects += 1;
        self.to_board.clear();
        self.to_client.clear();
        self.tally.dropped_frames += u64::from(self.frames.counters().errors());
        self.frames = Frames::default();
        Ok(())
    }
}
