//! A client that goes in the middle of the job, and the one after it.

use crate::conversation::Conversation;
use crate::expected::Expected;
use crate::port::{self, Port};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_protocol::message::{Acting, AnyMove, Message, Move, State, Telemetry};
use trirrr_service::ServiceNumber;

/// Ticks of the way back to the start of the job, in seconds of the machine.
const BACK_S: f64 = 2.0;

/// The machine may take this long to stop, on a clock that an emulator may not keep.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn run<N: ServiceNumber>(expected: &Expected<N>, mut port: Port) -> Result<()> {
    port.wait_for_board::<N>()?;
    let moves = expected.moves();
    let mut checker = TrajectoryChecker::new(&moves, 0, expected.ramp(), expected.period());
    let mut see = |sample: &Telemetry<N>| {
        checker
            .see(sample, |setpoint| expected.motors(setpoint))
            .map_err(|why| anyhow!(why))
    };

    // Gone in the middle, as a client that is killed: the line closes without a word.
    let long = u64::from(expected.scene.ticks())
        > (expected.scene.tick_rate_hz * (2.0 * expected.scene.service.silence_timeout_s)) as u64;
    ensure!(long, "the job is too short to be left in the middle");
    let mut conversation = Conversation::undisturbed(port);
    let mut seen = 0_u32;
    conversation.play(expected, moves.clone(), |sample, _| {
        see(sample)?;
        seen += u32::from(sample.state == State::Running);
        Ok(match seen > expected.scene.ticks() / 8 {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    })?;
    let mut port = conversation.end()?.reopen()?;

    // Nobody says anything: it goes on, then stops on its path.
    let (mut silent, mut stopping) = (0_u32, 0_u32);
    let start = Instant::now();
    let mut first = true;
    let rest = 'seen: loop {
        ensure!(start.elapsed() < PATIENCE, "the machine does not stop");
        for frame in port.frames(Duration::from_millis(20))? {
            let message = port::message::<N>(&frame);
            // The line is closed and opened in the middle of what is sent.
            if std::mem::take(&mut first) {
                checker.skip();
                continue;
            }
            let message =
                message.with_context(|| format!("the board sends no frame: {frame:02X?}"))?;
            let Message::Telemetry(sample) = message else {
                continue;
            };
            checker
                .see(&sample, |setpoint| expected.motors(setpoint))
                .map_err(|why| anyhow!(why))?;
            match (sample.state, sample.acting) {
                (State::Running, _) => silent += 1,
                (State::Stopping, Acting::Silence) => stopping += 1,
                (State::Idle, Acting::Silence) => break 'seen sample,
                other => bail!("a machine that is left is {other:?}"),
            }
        }
    };

    // Another client: back to the start, then the whole job.
    let mut conversation = Conversation::undisturbed(port);
    let from = rest.setpoint.pose;
    let ticks = (BACK_S * expected.scene.tick_rate_hz) as u32;
    let back = Move {
        number: 0,
        from,
        to: moves.first().context("a job without moves")?.common().from,
        start_velocity: [N::ZERO; 3],
        end_velocity: [N::ZERO; 3],
        ticks,
        tool_power: N::ZERO,
        tool_speed: N::ZERO,
    };
    let mut base = None;
    for job in [vec![AnyMove::Cubic(back)], moves] {
        let mut checker: Option<TrajectoryChecker<N>> = None;
        let client = conversation.play(expected, job.clone(), |sample, moment| {
            if sample.state == State::Running && checker.is_none() {
                let first = *base.get_or_insert(sample.number);
                checker = Some(TrajectoryChecker::new(
                    &job,
                    first,
                    expected.ramp(),
                    expected.period(),
                ));
            }
            if let Some(checker) = &mut checker {
                checker
                    .see(sample, |setpoint| expected.motors(setpoint))
                    .map_err(|why| anyhow!(why))?;
            }
            Ok(match moment.over && sample.state == State::Idle {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        })?;
        let checker = checker.context("the second client's job has no samples")?;
        checker.complete().map_err(|why| anyhow!(why))?;
        base = Some(client.status().context("no status")?.next);
    }
    println!(
        "left at tick {seen}: stopped after {silent} ticks without a client in {stopping} ticks on its \
         path; a second client played the whole job"
    );
    Ok(())
}
