//! One job between a client and a machine, with a bad line in between.

use std::time::Duration;
use trirrr_bench::device::{
    Device, DeviceChannels, MessageDecoder, RAMP_TICKS, TICK_RATE_HZ, hello, home, message_frame,
    request_frame,
};
use trirrr_bench::faulty_link::{FaultyLink, Random};
use trirrr_bench::job::random_job;
use trirrr_bench::sent::Sent;
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::{Dialogue, JobClient, Patience, Turn, UserCommand};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::Massless;
use trirrr_core::torque::payload::Centred;
use trirrr_protocol::message::Message;
use trirrr_protocol::wire::Counters;

/// Of 100 frames, how many are damaged.
const PERCENT: u64 = 20;

/// A job takes a few seconds; one that takes longer than this does not end.
const LONGEST_TICKS: u64 = 2_000_000;

/// Slices of background work between two ticks.
const STEPS_PER_TICK: usize = 200;

/// Counts of a session.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) jobs: u64,
    pub(crate) moves: u64,
    pub(crate) ticks: u64,
    /// Frames on the line, both ways.
    pub(crate) frames: u64,
    pub(crate) damaged: u64,
    /// Requests that the client sent again.
    pub(crate) repeated: u64,
    /// Requests that came a second time directly behind the first.
    pub(crate) heard_again: u64,
    /// Frames that an end dropped because they were damaged.
    pub(crate) dropped_frames: u64,
    pub(crate) reconnects: u64,
    pub(crate) holds: u64,
    pub(crate) overrides: u64,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.jobs += other.jobs;
        self.moves += other.moves;
        self.ticks += other.ticks;
        self.frames += other.frames;
        self.damaged += other.damaged;
        self.repeated += other.repeated;
        self.heard_again += other.heard_again;
        self.dropped_frames += other.dropped_frames;
        self.reconnects += other.reconnects;
        self.holds += other.holds;
        self.overrides += other.overrides;
    }

    fn add_counters(&mut self, counters: Counters) {
        self.dropped_frames += u64::from(counters.errors());
    }
}

/// Both ends of one job and the line between them.
pub(crate) struct Conversation<'q> {
    device: Device<'q>,
    client: JobClient<f64>,
    decoder: MessageDecoder,
    to_device: FaultyLink,
    to_client: FaultyLink,
    sent_to_device: Sent,
    sent_to_client: Sent,
    checker: TrajectoryChecker<f64>,
    /// The machine without a service.
    tick: Tick<Dynamic<f64, Centred<f64>, Massless>>,
    random: Random,
    /// Sequence number of the last request that the machine heard.
    heard: Option<u32>,
    held: bool,
    tally: Tally,
}

impl Conversation<'_> {
    /// Runs the job of `seed` to its end.
    pub(crate) fn run(seed: u64) -> Tally {
        let mut random = Random::new(seed);
        let moves = random_job(&mut random, home(), true);
        let mut channels = DeviceChannels::new();
        let patience = Patience {
            answer: Duration::from_millis(10),
            attempts: 7,
        };
        let conversation = Conversation {
            device: Device::new(&mut channels, LimitParameters::default(), 0),
            client: JobClient::new(moves.clone(), hello(), 1, patience, seed as u32),
            decoder: MessageDecoder::new(),
            to_device: FaultyLink::new(random.bits(), PERCENT),
            to_client: FaultyLink::new(random.bits(), PERCENT),
            sent_to_device: Sent::default(),
            sent_to_client: Sent::default(),
            tick: Tick::build(&example()).expect("the thesis machine"),
            checker: TrajectoryChecker::new(&moves, 0, RAMP_TICKS, 1.0 / TICK_RATE_HZ),
            random,
            heard: None,
            held: false,
            tally: Tally {
                jobs: 1,
                moves: moves.len() as u64,
                ..Tally::default()
            },
        };
        conversation.play(seed)
    }

    fn play(mut self, seed: u64) -> Tally {
        for tick in 0..LONGEST_TICKS {
            let now = Duration::from_secs_f64(tick as f64 / TICK_RATE_HZ);
            self.tally.ticks += 1;
            self.work_at_device();
            self.listen_at_client(now);
            self.ask_for_holds();
            if self.talk_at_client(now, seed) {
                return self.over(seed);
            }
        }
        panic!("job {seed} does not end: {:?}", self.client.status());
    }

    fn work_at_device(&mut self) {
        self.device.tick();
        for _ in 0..STEPS_PER_TICK {
            if !self.device.service.step() {
                break;
            }
        }
        let tick = &self.tick;
        let motors = |setpoint: &Setpoint<f64>| Some(tick.evaluate(setpoint).ok()?.motors);
        let Self {
            device,
            to_client,
            sent_to_client,
            sent_to_device,
            checker,
            tally,
            heard,
            ..
        } = self;
        while let Some(bytes) = self.to_device.receive() {
            device.receive(
                &bytes,
                |request| {
                    sent_to_device
                        .check(&request_frame(request))
                        .expect("the machine hears what was said");
                    tally.heard_again += u64::from(*heard == Some(request.sequence));
                    *heard = Some(request.sequence);
                },
                |message| {
                    let frame = message_frame(message);
                    sent_to_client.record(&frame);
                    to_client.send(&frame);
                },
            );
        }
        while let Some(message) = device.service.outgoing() {
            if let Message::Telemetry(sample) = &message {
                checker.see(sample, motors).expect("a tick of the job");
            }
            let frame = message_frame(&message);
            sent_to_client.record(&frame);
            to_client.send(&frame);
        }
    }

    fn listen_at_client(&mut self, now: Duration) {
        while let Some(bytes) = self.to_client.receive() {
            let mut line = bytes.as_slice();
            while let Some(frame) = self.decoder.take::<Message<f64>>(&mut line) {
                let Ok(message) = frame else {
                    continue;
                };
                self.sent_to_client
                    .check(&message_frame(&message))
                    .expect("the client hears what was said");
                self.client.receive(&message, now);
            }
        }
    }

    /// Now and then the user holds the job, and resumes it, or changes its pace.
    fn ask_for_holds(&mut self) {
        if self.random.below(400) == 0 {
            self.tally.overrides += 1;
            let percent = 1 + self.random.below(100) as u8;
            let percent = if percent > 50 { 100 } else { percent.max(10) };
            self.client.command(UserCommand::FeedOverride(percent));
        }
        if self.random.below(400) == 0 {
            self.tally.holds += u64::from(!self.held);
            self.client.command(if self.held {
                UserCommand::Resume
            } else {
                UserCommand::Hold
            });
            self.held = !self.held;
        }
    }

    /// Whether the job is over.
    fn talk_at_client(&mut self, now: Duration, seed: u64) -> bool {
        loop {
            match self.client.poll(now) {
                Turn::Send(request) => {
                    let frame = request_frame(&request);
                    self.sent_to_device.record(&frame);
                    self.to_device.send(&frame);
                }
                Turn::Wait(until) => {
                    assert!(until > now, "job {seed}: nothing to wait for at {now:?}");
                    return false;
                }
                Turn::Reconnect => {
                    self.tally.reconnects += 1;
                    self.to_device.clear();
                    self.to_client.clear();
                    self.decoder.reset();
                    self.client.reconnected();
                }
                Turn::Done(result) => {
                    if let Err(failure) = result {
                        let status = self.client.status();
                        panic!("job {seed}: {}: {status:?}", self.client.describe(&failure));
                    }
                    return true;
                }
            }
        }
    }

    fn over(mut self, seed: u64) -> Tally {
        self.checker.complete().expect("the whole job");
        assert_eq!(self.client.done(), self.client.moves(), "job {seed}");
        let status = self.device.service.status();
        assert_eq!(status.done, self.client.moves(), "job {seed}");
        self.tally.repeated = self.client.repeated();
        for link in [&self.to_device, &self.to_client] {
            self.tally.frames += link.frames();
            self.tally.damaged += link.damaged();
        }
        self.tally.add_counters(self.device.counters());
        self.tally.add_counters(self.decoder.counters());
        self.tally
    }
}
