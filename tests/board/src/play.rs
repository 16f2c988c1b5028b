//! The scene's job, with everything that its samples say.

use crate::conversation::{Conversation, Moment};
use crate::expected::Expected;
use crate::port::{self, Port};
use anyhow::{Context, Result, ensure};
use std::ops::ControlFlow;
use trirrr_core::message::{Telemetry, Transmit};
use trirrr_host_sim::telemetry::is_of_a_job;

/// Numbers in a sample that are compared: state, acting, move, place (2), setpoint (9), motors
/// (12), tool.
const VALUES: usize = 27;

pub(crate) fn run<N: Transmit>(expected: &Expected<N>, mut port: Port) -> Result<()> {
    let samples = expected.samples()?;
    let (standing, job) = samples.split_first().context("no samples")?;
    port.wait_for_board::<N>()?;
    let mut conversation = Conversation::undisturbed(port);
    let mut player = Player {
        standing,
        job,
        next: 0,
        start: 0,
        idle: 0,
        timed: 0,
        longest: 0,
    };
    let client = conversation.play(expected, expected.moves(), |sample, moment| {
        player.see(sample, moment)
    })?;
    let status = client.status().context("no status")?;
    ensure!(status.lost == 0, "{} samples were lost", status.lost);
    println!(
        "{} ticks, {} samples identical in {VALUES} values, {} at rest before them, {} lost; of {} ticks \
         without an interrupt of the line the longest took {} counts, of all {}",
        expected.scene.ticks(),
        player.next,
        player.idle,
        status.lost,
        player.timed,
        player.longest,
        status.longest_tick
    );
    ensure!(
        player.timed > u64::from(expected.scene.ticks() / 10),
        "the line was never quiet"
    );
    Ok(())
}

/// Compares sample by sample.
struct Player<'a, N: Transmit> {
    /// Before the job.
    standing: &'a Telemetry<N>,
    /// The job, and the first tick after it.
    job: &'a [Telemetry<N>],
    next: usize,
    /// The board's tick at the first sample of the job.
    start: u32,
    /// Samples before the job.
    idle: u64,
    /// Ticks without an interrupt of the line,
    timed: u64,
    /// and the longest of them.
    longest: u32,
}

impl<N: Transmit> Player<'_, N> {
    fn see(&mut self, sample: &Telemetry<N>, moment: Moment) -> Result<ControlFlow<()>> {
        if moment.quiet {
            self.timed += 1;
            self.longest = self.longest.max(sample.duration);
        }
        if self.next == self.job.len() {
            // At rest, until the client has heard that the job is over, too.
            self.compare(sample, &self.job[self.next - 1], self.next)?;
            return Ok(match moment.over {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            });
        }
        if self.next == 0 && !is_of_a_job(sample.state) {
            self.idle += 1;
            self.compare(sample, self.standing, 0)?;
            return Ok(ControlFlow::Continue(()));
        }
        let expected = &self.job[self.next];
        if self.next == 0 {
            self.start = sample.tick.wrapping_sub(expected.tick);
        }
        let ticks = sample.tick.wrapping_sub(self.start);
        ensure!(
            ticks == expected.tick,
            "sample {} is of tick {ticks}, not {}",
            self.next,
            expected.tick
        );
        self.compare(sample, expected, self.next)?;
        self.next += 1;
        Ok(ControlFlow::Continue(()))
    }

    /// All but the board's own time: its ticks are counted from its start, and each takes as long as
    /// it takes there.
    fn compare(&self, found: &Telemetry<N>, expected: &Telemetry<N>, index: usize) -> Result<()> {
        let found = Telemetry {
            tick: expected.tick,
            duration: expected.duration,
            ..*found
        };
        ensure!(
            port::frame(&found) == port::frame(expected),
            "sample {index} of the job: {found:?}\nthe host computes {expected:?}"
        );
        Ok(())
    }
}
