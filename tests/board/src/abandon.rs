//! A client that goes in the middle of the job, and the one after it.

use crate::conversation::Conversation;
use crate::expected::Expected;
use crate::port::{self, Port};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_protocol::message::{Acting, Message, State, Telemetry};
use trirrr_service::ServiceNumber;

/// The machine may take this long to stop, on a clock that an emulator may not keep.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn run<N: ServiceNumber>(expected: &Expected<N>, mut port: Port) -> Result<()> {
    port.wait_for_board::<N>()?;
    let moves = expected.moves();
    let mut checker = TrajectoryChecker::new(&moves, 0, expected.ramp(), expected.period());
    let see = |checker: &mut TrajectoryChecker<N>, sample: &Telemetry<N>| {
        let motors = |setpoint: &_| expected.motors(setpoint);
        checker.see(sample, motors).map_err(|why| anyhow!(why))
    };

    // Gone in the middle, as a client that is killed: the line closes without a word.
    let long = u64::from(expected.scene.ticks())
        > (expected.scene.tick_rate_hz * (2.0 * expected.scene.service.silence_timeout_s)) as u64;
    ensure!(long, "the job is too short to be left in the middle");
    let mut conversation = Conversation::undisturbed(port);
    let mut seen = 0_u32;
    conversation.play(expected, moves.clone(), |sample, _| {
        see(&mut checker, sample)?;
        seen += u32::from(sample.state == State::Running);
        Ok(match seen > expected.scene.ticks() / 8 {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    })?;
    let mut port = conversation.end()?.reopen()?;

    // Nobody says anything: it goes on, then comes to rest on its path, and waits.
    let (mut silent, mut slowing) = (0_u32, 0_u32);
    let start = Instant::now();
    let (mut first, mut rests) = (true, false);
    while !rests {
        ensure!(
            start.elapsed() < PATIENCE,
            "the machine does not come to rest"
        );
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
            see(&mut checker, &sample)?;
            match (sample.state, sample.acting) {
                (State::Running, _) => silent += 1,
                (State::Slowing, Acting::Silence) => slowing += 1,
                // Other samples may have come with this one: each is seen.
                (State::Holding, Acting::Silence) => rests = true,
                other => bail!("a machine that is left is {other:?}"),
            }
        }
    }

    // Another client goes on with the job, at the very place.
    let mut conversation = Conversation::undisturbed(port);
    conversation.attach();
    conversation.play(expected, moves, |sample, moment| {
        see(&mut checker, sample)?;
        Ok(match moment.over && sample.state == State::Idle {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    })?;
    checker.complete().map_err(|why| anyhow!(why))?;
    println!(
        "left at tick {seen}: at rest after {silent} ticks without a client and {slowing} on the way; a second client \
         resumed the job at the very place and played it to its end"
    );
    Ok(())
}
