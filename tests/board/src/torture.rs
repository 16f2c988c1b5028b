//! Random jobs over a bad line: each has to be complete, each of its ticks exact.

use crate::conversation::Conversation;
use crate::expected::Expected;
use crate::port::Port;
use anyhow::{Context, Result, anyhow, ensure};
use std::ops::ControlFlow;
use trirrr_bench::faulty_link::{Fault, Random};
use trirrr_bench::job::random_job;
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::local::HostNumber;
use trirrr_protocol::message::State;
use trirrr_scene::{JobMove, Scene, offer};

/// Standard deviations that the share of damaged frames may be from what was asked for.
const DEVIATIONS: f64 = 6.0;

pub(crate) fn run<N: HostNumber>(
    expected: &Expected<N>,
    mut port: Port,
    frames: u64,
    percent: u64,
    seed: u64,
) -> Result<()> {
    let mut random = Random::new(seed);
    port.wait_for_board::<N>()?;
    let mut line = Conversation::disturbed(port, percent, &mut random);
    let (mut jobs, mut moves, mut samples) = (0, 0_u32, 0);
    while line.to_board.frames() + line.to_client.frames() < frames {
        let scene = with_random_job(&expected.scene, &mut random);
        let job = offer::moves(&scene, &expected.units);
        let mut checker = TrajectoryChecker::new(&job, moves, expected.ramp(), expected.period());
        moves = moves.wrapping_add(job.len() as u32);
        let client = line
            .play(expected, job, |sample, moment| {
                checker
                    .see(sample, |setpoint| expected.motors(setpoint))
                    .map_err(|why| anyhow!(why))?;
                Ok(match moment.over && sample.state == State::Idle {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                })
            })
            .and_then(|client| {
                checker.complete().map_err(|why| anyhow!(why))?;
                Ok(client)
            })
            .with_context(|| format!("job {jobs} of seed {seed}"))?;
        let status = client.status().context("no status")?;
        ensure!(
            status.done == moves && status.lost == 0 && status.fault.is_none(),
            "job {jobs} of seed {seed}: {status:?}"
        );
        jobs += 1;
        samples += checker.samples();
    }
    let [to_board, to_client] = [line.to_board.frames(), line.to_client.frames()];
    let damaged = line.to_board.damaged() + line.to_client.damaged();
    let tally = line.tally;
    println!(
        "{jobs} jobs of {moves} moves complete, {samples} ticks exact; {to_board} frames to the board and \
         {to_client} from it, {damaged} damaged, {} requests repeated, {} reconnects, {} holds (seed {seed})",
        tally.repeated, tally.reconnects, tally.holds
    );
    for fault in Fault::ALL {
        let made = line.to_board.count(fault) * line.to_client.count(fault);
        ensure!(
            percent == 0 || made > 0,
            "{fault:?} was never tried in a direction"
        );
    }
    let all = (to_board + to_client) as f64;
    let rate = percent as f64 / 100.0;
    // The rate is a whole number of 256ths, the next lower.
    let least = rate - 1.0 / 256.0;
    let deviation = (all * rate * (1.0 - rate)).sqrt();
    ensure!(
        (all * least - DEVIATIONS * deviation..=all * rate + DEVIATIONS * deviation)
            .contains(&(damaged as f64)),
        "{damaged} of {all} frames were damaged, {percent} % were asked for"
    );
    ensure!(
        percent == 0 || (tally.repeated > 0 && tally.holds > 0),
        "the client never had to ask again, or never held"
    );
    Ok(())
}

/// Times that a job is slowed down by. As it is drawn its moves need more torque than small motors have.
const SLOWER: u32 = 8;

/// The scene with a random job where its own starts, slow enough for its limits.
fn with_random_job(scene: &Scene, random: &mut Random) -> Scene {
    let mut scene = scene.clone();
    let slower = f64::from(SLOWER);
    // Only an image whose scene has quintics plays any.
    let moves = random_job(random, scene.job.start, scene.job.has_quintics());
    let slowed = moves.iter().map(|each| {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_jobs_are_admitted() {
        let chained = include_str!("../../../scenes/chained.toml");
        let scene = Scene::parse(chained, "chained.toml").expect("a shipped scene");
        let mut random = Random::new(1);
        for job in 0..300 {
            let scene = with_random_job(&scene, &mut random);
            assert!(scene.longest_stop().is_some(), "job {job}: {:?}", scene.job);
        }
    }
}
