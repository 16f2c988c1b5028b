//! The line: random jobs over one that damages every fifth frame in both directions, and a background that is late.

use super::{Row, Subject, fact};
use crate::chip::Kind;
use crate::cpu::{Board, Hang, address_of};
use crate::host::BAUD;
use crate::time::{MS, SECOND, Time, seconds};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::time::Duration;
use trirrr_bench::faulty_link::{Fault, FaultyLink, Random};
use trirrr_bench::job::random_job;
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::{Dialogue, JobClient, Patience, Turn};
use trirrr_core::units::Units;
use trirrr_line::Frames;
use trirrr_protocol::message::{
    AnyMove, Message, Reply, Request, State, Telemetry, TelemetryFields,
};
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::{JobMove, Scene, offer};

/// Frames in both directions until the last job begins, and how many of a hundred are damaged.
const FRAMES: u64 = 20_000;
const PERCENT: u64 = 20;

/// Standard deviations that the share of damaged frames may be from that.
const DEVIATIONS: f64 = 6.0;

const SEED: u64 = 1;

/// Times that a job is slowed down by. As it is drawn its moves need more torque than small motors have.
const SLOWER: u32 = 8;

/// A job that takes so much longer than three times its duration does not end.
const LONGEST: Time = 60 * SECOND;

/// The host looks at the line so often.
const LOOK: Time = MS / 4;

/// Bytes of a round of the receiver's ring in the image.
const ROUND: usize = 1024;

/// Variable of the image that counts bytes which were written over before the background took them: the end of its name.
const MISSED: &str = "4line6MISSED";

/// Time of a host behind that.
const AFTER: Time = 200 * MS;

/// Bytes that come while the background hangs: one less than a round, a round, more than two.
const LATE: [usize; 3] = [ROUND - 1, ROUND, 2400];

/// Host of random jobs, and the bad line to the board.
struct BadLine {
    units: Units,
    pipeline: Box<dyn Pipeline<f32>>,
    to_board: FaultyLink,
    to_client: FaultyLink,
    /// At the client, at the wire from the board, and at the wire to it.
    frames: Frames,
    sent: Frames,
    heard: Frames,
    /// Frame under way from the board.
    frame: Vec<u8>,
    /// Bytes from the board that were read.
    read: usize,
    /// Bytes to the board, and the end of the last one.
    bytes: usize,
    wire_free: Time,
    /// Requests that reach the board whole, replies, and replies that a request before is missing.
    requests: u64,
    replies: u64,
    kept: u64,
    repeated: u64,
    samples: u64,
    /// Samples that were dropped before the first job: until a client asks for less, each has more than the line takes in a tick.
    dropped: u32,
}

impl BadLine {
    fn new(subject: &Subject, random: &mut Random) -> Result<Self> {
        let scene = &subject.scene;
        let units = trirrr_scene::units::<f32>(scene).map_err(|error| anyhow!("{error}"))?;
        Ok(Self {
            units,
            pipeline: pipeline::of_scene(scene, units)?,
            to_board: FaultyLink::new(random.bits(), PERCENT),
            to_client: FaultyLink::new(random.bits(), PERCENT),
            frames: Frames::default(),
            sent: Frames::default(),
            heard: Frames::default(),
            frame: Vec::new(),
            read: 0,
            bytes: 0,
            wire_free: 0,
            requests: 0,
            replies: 0,
            kept: 0,
            repeated: 0,
            samples: 0,
            dropped: 0,
        })
    }

    /// Plays the job of `scene`, whose first move the board numbers `base`, and compares the sample of every tick.
    fn play(&mut self, board: &mut Board, scene: &Scene, base: u32) -> Result<JobClient<f32>> {
        let job = offer::moves::<f32>(scene, &self.units);
        let period = self.units.time(scene.period_s()) as f32;
        let mut checker = TrajectoryChecker::new(&job, base, scene.ramp().ticks, period);
        let ticks: u64 = job.iter().map(|each| u64::from(each.common().ticks)).sum();
        let duration = (ticks as f64 / scene.tick_rate_hz * SECOND as f64) as Time;
        let patience = Patience {
            answer: Duration::from_millis(20),
            attempts: 7,
        };
        let hello = trirrr_client::local::hello::<f32>(scene);
        let client = JobClient::new(job, hello, 1, patience, base.wrapping_add(1000));
        let mut client = client.with_fields(TelemetryFields::SETPOINT);
        let end = board.now() + 3 * duration + LONGEST;
        let mut is_over = false;
        loop {
            ensure!(
                board.now() < end,
                "the job does not end: {:?}",
                client.status()
            );
            board.run(board.now() + LOOK)?;
            let clock = Duration::from_secs_f64(seconds(board.now()));
            for message in self.listen(board) {
                if let Message::Telemetry(sample) = message
                    && self.see(&mut checker, sample)? == State::Idle
                    && is_over
                {
                    checker.complete().map_err(|why| anyhow!(why))?;
                    self.samples += checker.samples();
                    self.repeated += client.repeated();
                    return Ok(client);
                }
            }
            while let Some(bytes) = self.to_client.receive() {
                self.frames.receive(&bytes, |message: Message<f32>| {
                    client.receive(&message, clock)
                });
            }
            is_over |= self.talk(board, &mut client, clock)?;
        }
    }

    /// Takes the frames that have left the board, and returns their messages.
    fn listen(&mut self, board: &mut Board) -> Vec<Message<f32>> {
        let now = board.now();
        let mut messages = Vec::new();
        let line = board.chip().line();
        while let Some((time, byte)) = line.sent.get(self.read).copied()
            && time <= now
        {
            self.read += 1;
            self.frame.push(byte);
            self.sent.receive(&[byte], |message| messages.push(message));
            if byte == 0 {
                self.to_client.send(&std::mem::take(&mut self.frame));
            }
        }
        for message in &messages {
            if let Message::Reply { reply, .. } = message {
                self.replies += 1;
                self.kept += u64::from(matches!(reply, Reply::Kept { .. }));
            }
        }
        messages
    }

    /// Hands a sample to the checker, with what the motors do at its setpoint. Returns the state.
    fn see(
        &mut self,
        checker: &mut TrajectoryChecker<f32>,
        mut sample: Telemetry<f32>,
    ) -> Result<State> {
        if self.samples + checker.samples() == 0 {
            self.dropped = sample.lost;
        }
        sample.lost = sample.lost.wrapping_sub(self.dropped);
        let motors = |setpoint: &_| self.pipeline.motors(setpoint).ok();
        if let Some(computed) = motors(&sample.setpoint) {
            sample.angles = computed.map(|motor| motor.angle);
            sample.rates = computed.map(|motor| motor.rate);
            sample.accelerations = computed.map(|motor| motor.acceleration);
            sample.torques = computed.map(|motor| motor.torque);
        }
        checker.see(&sample, motors).map_err(|why| anyhow!(why))?;
        Ok(sample.state)
    }

    /// Lets the client send. Returns true if its job is over.
    fn talk(
        &mut self,
        board: &mut Board,
        client: &mut JobClient<f32>,
        clock: Duration,
    ) -> Result<bool> {
        loop {
            match client.poll(clock) {
                Turn::Send(request) => {
                    let mut frame = Vec::new();
                    Frames::append(&request, &mut frame);
                    self.to_board.send(&frame);
                    while let Some(bytes) = self.to_board.receive() {
                        self.put(board, &bytes);
                    }
                }
                Turn::Wait(_) => return Ok(false),
                Turn::Reconnect => client.reconnected(),
                Turn::Done(Ok(())) => return Ok(true),
                Turn::Done(Err(failure)) => bail!(client.describe(&failure)),
            }
        }
    }

    /// Puts bytes on the wire to the board.
    fn put(&mut self, board: &mut Board, bytes: &[u8]) {
        let mut requests = 0;
        self.heard.receive(bytes, |_: Request<f32>| requests += 1);
        self.requests += requests;
        self.bytes += bytes.len();
        self.wire_free = put(board, bytes, self.wire_free);
    }
}

/// Puts bytes on the wire to the board, once it is free. Returns the end of the last one.
fn put(board: &mut Board, bytes: &[u8], free: Time) -> Time {
    let mut end = free.max(board.now());
    for byte in bytes {
        end += (10.0 * SECOND as f64 / BAUD) as Time;
        board.chip().line().coming.push_back((end, *byte));
    }
    end
}

/// The scene with a random job where its own starts, slow enough for its limits.
fn with_random_job(scene: &Scene, random: &mut Random) -> Scene {
    let mut scene = scene.clone();
    let slower = f64::from(SLOWER);
    let moves = random_job(random, scene.job.start, scene.job.has_quintics());
    let slowed = moves.iter().map(|each: &AnyMove<f64>| {
        let common = each.common();
        let accelerations = each.accelerations();
        JobMove {
            from: common.from,
            to: common.to,
            start_velocity: common.start_velocity.map(|each| each / slower).into(),
            end_velocity: common.end_velocity.map(|each| each / slower).into(),
            accelerations: accelerations
                .map(|ends| ends.map(|end| end.map(|each| each / slower.powi(2)).into())),
            duration_ticks: common.ticks * SLOWER,
            tool: None,
        }
    });
    scene.job.moves = slowed.collect();
    scene
}

/// Random jobs over a bad line, each complete and each of its ticks exact.
pub(super) fn damaged(subject: &Subject) -> Result<Vec<Row>> {
    let mut random = Random::new(SEED);
    let mut board = started(subject)?;
    let mut line = BadLine::new(subject, &mut random)?;
    let (mut jobs, mut moves) = (0, 0_u32);
    let mut done = 0;
    while line.to_board.frames() + line.to_client.frames() < FRAMES {
        let scene = with_random_job(&subject.scene, &mut random);
        let client = line
            .play(&mut board, &scene, moves)
            .with_context(|| format!("job {jobs} of seed {SEED}"))?;
        let status = client.status().context("no status")?;
        ensure!(
            status.lost == line.dropped && status.fault.is_none(),
            "job {jobs} of seed {SEED}: {status:?}"
        );
        moves = moves.wrapping_add(scene.job.moves.len() as u32);
        done = status.done;
        jobs += 1;
    }
    for fault in Fault::ALL {
        ensure!(
            line.to_board.count(fault) * line.to_client.count(fault) > 0,
            "{fault:?} was never tried in a direction"
        );
    }
    let frames = line.to_board.frames() + line.to_client.frames();
    let damaged = line.to_board.damaged() + line.to_client.damaged();
    let rate = PERCENT as f64 / 100.0;
    let deviation = DEVIATIONS * (rate * (1.0 - rate) / frames as f64).sqrt();
    let share = damaged as f64 / frames as f64;
    let row = |subject: String, measured: String, bound: String, holds| Row {
        case: "line",
        subject,
        measured,
        bound,
        holds,
    };
    let interrupts = round_interrupts(subject, &board);
    let rounds = (line.bytes / ROUND) as u64;
    Ok(vec![
        row(
            format!(
                "{} frames to the board, {} from it",
                line.to_board.frames(),
                line.to_client.frames()
            ),
            format!("{:.1} % damaged", 100.0 * share),
            format!("{PERCENT} %"),
            // The rate is a whole number of 256ths, the next lower.
            (share - rate).abs() <= deviation + 1.0 / 256.0,
        ),
        fact(
            "line",
            &format!(
                "{jobs} jobs, {} ticks exact: moves that were executed",
                line.samples
            ),
            done.to_string(),
            &moves.to_string(),
        ),
        row(
            format!(
                "replies to requests that came whole, {} of them repeated",
                line.repeated
            ),
            line.replies.to_string(),
            format!("{} to {}", line.requests, line.requests + line.kept),
            (line.requests..=line.requests + line.kept).contains(&line.replies),
        ),
        fact(
            "line",
            "bytes that the receiver has lost",
            board.chip().line().lost.to_string(),
            "0",
        ),
        row(
            format!("interrupts for {} bytes to the board", line.bytes),
            interrupts.to_string(),
            rounds.to_string(),
            interrupts == rounds,
        ),
        fact(
            "line",
            "bytes that the background has missed",
            missed(subject, &mut board)?.to_string(),
            "0",
        ),
    ])
}

/// A background that is late: by less than a round of the ring nothing is lost, by more the board knows how much, and the line goes on.
pub(super) fn late(subject: &Subject) -> Result<Vec<Row>> {
    let mut random = Random::new(SEED);
    let mut rows = Vec::new();
    for bytes in LATE {
        let mut board = started(subject)?;
        board.run(board.now() + 5 * MS)?;
        board.hung = Some(Hang::Background);
        // Noise, whose last byte ends whatever it has begun.
        let mut noise: Vec<u8> = (1..bytes).map(|_| random.bits() as u8).collect();
        noise.push(0);
        let now = board.now();
        let end = put(&mut board, &noise, now);
        board.run(end)?;
        board.hung = None;
        board.run(end + 20 * MS)?;
        let expected = if bytes < ROUND { 0 } else { bytes };
        let told = missed(subject, &mut board)?.to_string();
        let what = format!("{bytes} bytes while the background hangs: missed");
        rows.push(fact("late", &what, told, &expected.to_string()));
        let mut host = subject.host(&mut board)?;
        let end = board.now() + AFTER;
        host.run(&mut board, end)?;
        let client = host.client();
        let answered = (client.identity().is_some(), client.repeated());
        let what = "a host behind it: answered, requests repeated";
        rows.push(fact("late", what, format!("{answered:?}"), "(true, 0)"));
    }
    Ok(rows)
}

/// Returns a board that ticks.
fn started(subject: &Subject) -> Result<Board> {
    let mut board = subject.switch_on()?;
    subject.host(&mut board)?;
    Ok(board)
}

/// Returns how often a round of the receiver's ring has ended in an interrupt.
fn round_interrupts(subject: &Subject, board: &Board) -> u64 {
    // DMA1: stream 5, or channel 1.
    let interrupt = match subject.kind {
        Kind::Stm32f405 => 16,
        Kind::Stm32g474 => 11,
    };
    let of_dma = |handled: &&crate::cpu::Handled| handled.exception == 16 + interrupt;
    board.handled.iter().filter(of_dma).count() as u64
}

/// Returns the image's count of bytes that its background has missed.
fn missed(subject: &Subject, board: &mut Board) -> Result<u32> {
    let address = address_of(&subject.image, MISSED)?;
    let memory = &board.chip().dma.memory;
    let bytes = [0, 1, 2, 3].map(|at| memory.read(address + at));
    let [Some(a), Some(b), Some(c), Some(d)] = bytes else {
        bail!("{MISSED} is not in the RAM, but at {address:#010x}");
    };
    Ok(u32::from_le_bytes([a, b, c, d]))
}
