//! A job that is cut off at random instants: the cable is pulled, the client is killed, another one goes on.

use crate::conversation::Conversation;
use crate::expected::Expected;
use crate::port::{self, Port};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use trirrr_bench::faulty_link::Random;
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::local::HostNumber;
use trirrr_protocol::message::{Acting, AnyMove, Message, State, Telemetry};
use trirrr_scene::{JobMove, Scene};

/// The board sends a sample of each tick; on a clock that an emulator may not keep, the next one comes within this time.
const PATIENCE: Duration = Duration::from_secs(60);

/// Duration of the way from the end of the scene's job to its start, s.
const BACK_S: f64 = 2.0;

/// Most silence between two clients, as a multiple of the silence after which the machine waits.
const LONGEST_SILENCE: f64 = 2.5;

/// Lets `seconds` of the job of `scene`, over and over, be cut off `cuts` times.
pub(crate) fn run<N: HostNumber>(
    scene: &Scene,
    mut port: Port,
    cuts: u32,
    seconds: f64,
    seed: u64,
) -> Result<()> {
    let expected = Expected::<N>::of(&there_and_back(scene, seconds))?;
    port.wait_for_board::<N>()?;
    let moves = expected.moves();
    let mut witness = Witness::new(&expected, &moves);
    let mut random = Random::new(seed);
    let silence = scene.service.silence_timeout_s * scene.tick_rate_hz * LONGEST_SILENCE;
    // As many stretches of the path as cuts, and one more.
    let stretch = witness.total / (u64::from(cuts) + 1);
    for cut in 1..=u64::from(cuts) {
        // Anywhere in its stretch.
        let at = (cut - 1) * stretch + 1 + random.below(stretch);
        let mut conversation = Conversation::undisturbed(port);
        if cut > 1 {
            conversation.attach();
        }
        conversation.play(&expected, moves.clone(), |sample, _| {
            witness.see(sample)?;
            Ok(match witness.place >= at && !witness.checker.is_slow() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        })?;
        // As by a client that is killed: the line closes without a word.
        port = conversation.end()?.reopen()?;
        witness.is_blind = true;
        // Every other time the next client is there at once: then it was the cable.
        let ticks = match random.below(2) {
            0 => 1,
            _ => 1 + random.below(silence as u64),
        };
        port = witness.silence(port, ticks)?;
    }
    let mut conversation = Conversation::undisturbed(port);
    if cuts > 0 {
        conversation.attach();
    }
    conversation.play(&expected, moves.clone(), |sample, moment| {
        witness.see(sample)?;
        Ok(match moment.over && sample.state == State::Idle {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    })?;
    witness.checker.complete().map_err(|why| anyhow!(why))?;
    let Witness {
        total,
        unseen,
        waits,
        dry,
        tool,
        ..
    } = witness;
    println!(
        "{cuts} cuts in {seconds} s: the path is complete, each of {total} ticks once, {unseen} of them while the line was closed; \
         {waits} waits for a client, {dry} for moves; the tool was on in {tool} samples, in none at rest (seed {seed})"
    );
    Ok(())
}

/// The scene with its job and the way back, over and over.
fn there_and_back(scene: &Scene, seconds: f64) -> Scene {
    let mut scene = scene.clone();
    if let [.., last] = scene.job.moves[..] {
        scene.job.moves.push(JobMove {
            from: last.to,
            to: scene.job.start,
            duration_ticks: (BACK_S * scene.tick_rate_hz) as u32,
            start_velocity: last.end_velocity,
            end_velocity: Default::default(),
            accelerations: None,
            tool: None,
        });
    }
    let once = f64::from(scene.ticks()) / scene.tick_rate_hz;
    scene.job.moves = scene.job.moves.repeat((seconds / once).ceil() as usize);
    scene
}

/// All samples of the path, whoever was connected.
struct Witness<'e, N: HostNumber> {
    expected: &'e Expected<N>,
    checker: TrajectoryChecker<N>,
    /// Ticks of the path before each move.
    begins: Vec<u64>,
    total: u64,
    /// Place on the path of the last sample, ticks, and the sample's tick.
    place: u64,
    tick: u32,
    /// Samples were lost with the line: the next one may be later.
    is_blind: bool,
    unseen: u64,
    waits: u32,
    dry: u32,
    tool: u64,
    last: State,
}

impl<'e, N: HostNumber> Witness<'e, N> {
    fn new(expected: &'e Expected<N>, moves: &[AnyMove<N>]) -> Self {
        let mut total = 0;
        let begins = moves.iter().map(|each| {
            let begin = total;
            total += u64::from(each.common().ticks);
            begin
        });
        Self {
            begins: begins.collect(),
            checker: TrajectoryChecker::new(moves, 0, expected.ramp(), expected.period()),
            expected,
            total,
            place: 0,
            tick: 0,
            is_blind: false,
            unseen: 0,
            waits: 0,
            dry: 0,
            tool: 0,
            last: State::Idle,
        }
    }

    fn see(&mut self, sample: &Telemetry<N>) -> Result<()> {
        if self.is_blind {
            self.checker.skip();
        }
        let motors = |setpoint: &_| self.expected.motors(setpoint);
        self.checker
            .see(sample, motors)
            .map_err(|why| anyhow!(why))?;
        let tool = sample.tool > N::ZERO;
        ensure!(
            !tool || sample.state.is_running(),
            "the tool is on although the machine stands: {sample:?}"
        );
        self.tool += u64::from(tool);
        if sample.state != self.last {
            match (sample.state, sample.acting) {
                (State::Holding, Acting::Silence) => self.waits += 1,
                (State::Holding, Acting::QueueDry) => self.dry += 1,
                _ => {}
            }
            self.last = sample.state;
        }
        if sample.state.is_running() || sample.state == State::Holding {
            let begin = self.begins.get(sample.number as usize);
            let place = begin.context("no move of the job")? + u64::from(sample.at);
            if self.is_blind {
                // At normal speed a tick of the path passes in each tick.
                let passed = u64::from(sample.tick.wrapping_sub(self.tick));
                ensure!(
                    place == self.place + passed,
                    "{passed} ticks after place {} the path is at {place}: {sample:?}",
                    self.place
                );
                self.unseen += passed - 1;
            }
            (self.place, self.tick) = (place, sample.tick);
            self.is_blind = false;
        }
        Ok(())
    }

    /// Nobody speaks for `ticks`: the machine goes on, then comes to rest on its path, and waits.
    fn silence(&mut self, mut port: Port, ticks: u64) -> Result<Port> {
        let (mut seen, mut heard) = (0, Instant::now());
        let mut first = true;
        while seen < ticks {
            ensure!(heard.elapsed() < PATIENCE, "the board sends no samples");
            for frame in port.frames(Duration::from_millis(20))? {
                let message = port::message::<N>(&frame);
                // The line is closed and opened in the middle of what is sent.
                if std::mem::take(&mut first) {
                    continue;
                }
                let message =
                    message.with_context(|| format!("the board sends no frame: {frame:02X?}"))?;
                let Message::Telemetry(sample) = message else {
                    continue;
                };
                heard = Instant::now();
                seen += 1;
                self.see(&sample)?;
                match (sample.state, sample.acting) {
                    (State::Running, _)
                    | (State::Slowing | State::Holding, Acting::Silence | Acting::QueueDry) => {}
                    other => bail!("a machine that is left is {other:?}"),
                }
            }
        }
        Ok(port)
    }
}
