//! The scene's homing and its job, with everything that their samples say.

use crate::conversation::{Conversation, Moment};
use crate::expected::{Expected, HomingInputs, Stretch};
use crate::port::{self, Port};
use anyhow::{Context, Result, bail, ensure};
use std::ops::ControlFlow;
use trirrr_client::JobFailure;
use trirrr_client::local::HostNumber;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{Command, Reply, State, Telemetry};

/// Looks at a board until it has the state that it was asked for: drives take some ticks to go on and off.
const ATTEMPTS: u32 = 1000;

/// Numbers in a sample that are compared: state, acting, move, place (2), setpoint (9), motors
/// (12), tool.
const VALUES: usize = 27;

pub(crate) fn run<N: HostNumber>(
    mut expected: Expected<N>,
    mut port: Port,
    inputs: HomingInputs,
    mass_kg: Option<f64>,
) -> Result<()> {
    port.wait_for_board::<N>()?;
    if let Some(mass_kg) = mass_kg {
        expected = with_mass(&expected, &mut port, mass_kg)?;
    }
    let expected = &expected;
    let stretches = expected.stretches(inputs)?;
    let last = stretches.last().context("nothing is expected")?;
    let end = last.samples.last().context("a stretch has an end")?.state;
    let mut conversation = Conversation::undisturbed(port);
    let mut player = Player {
        stretches: &stretches,
        stretch: 0,
        next: 0,
        start: 0,
        compared: 0,
        idle: 0,
        timed: 0,
        longest: 0,
    };
    let (client, result) =
        conversation.converse(expected, expected.moves(), |sample, moment| {
            player.see(sample, moment)
        })?;
    match (result, end) {
        (Ok(()), State::Idle) => {}
        (Err(JobFailure::Fault(fault)), State::Fault) => {
            println!(
                "as on the host: {}",
                client.describe(&JobFailure::Fault(fault))
            );
        }
        (Err(failure), _) => bail!(client.describe(&failure)),
        (Ok(()), end) => bail!("the job is played, on the host it ends in {end:?}"),
    }
    let status = client.status().context("no status")?;
    ensure!(status.lost == 0, "{} samples were lost", status.lost);
    let ticks = match end {
        State::Idle => expected.scene.ticks(),
        _ => 0,
    };
    println!(
        "{ticks} ticks, {} samples identical in {VALUES} values, {} at rest before them, {} lost; of {} ticks \
         without an interrupt of the line the longest took {} counts, of all {}",
        player.compared,
        player.idle,
        status.lost,
        player.timed,
        player.longest,
        status.longest_tick
    );
    ensure!(
        player.timed > player.compared / 10,
        "the line was never quiet"
    );
    Ok(())
}

/// Gives the platform of the board another mass. Returns what the host computes for that scene; the board keeps its key.
fn with_mass<N: HostNumber>(
    expected: &Expected<N>,
    port: &mut Port,
    mass_kg: f64,
) -> Result<Expected<N>> {
    let mut scene = expected.scene.clone();
    scene.parameters.platform.mass_kg = mass_kg;
    let platform = Section::of(SectionName::Platform, &scene.parameters, &scene.limits);
    let platform = platform.context("a scene has a platform")?;
    let hello = Command::<N>::Hello(expected.hello);
    let Some(Reply::Hello(identity)) = port.ask(u32::MAX / 2, hello)? else {
        bail!("the board does not greet");
    };
    let mut sequence = identity.next_sequence;
    let mut ask = |command| {
        let reply = port.ask::<N>(sequence, command);
        sequence = sequence.wrapping_add(1);
        reply
    };
    // A scene is changed where the machine stands, and so with its drives on.
    for (command, state) in [
        (Command::Enable, State::Idle),
        (Command::Replace(platform), State::Idle),
        (Command::Disable, State::Disabled),
    ] {
        match ask(command)? {
            Some(Reply::Done) => {}
            other => bail!("the board answers {command:?} with {other:?}"),
        }
        let reached = (0..ATTEMPTS).any(|_| {
            matches!(ask(Command::Status), Ok(Some(Reply::Status(status))) if status.state == state)
        });
        ensure!(reached, "after {command:?} the board is not {state:?}");
    }
    match ask(Command::Read(SectionName::Platform))? {
        Some(Reply::Section(part)) if part == platform => {}
        other => bail!("the board says of its platform {other:?}, not {platform:?}"),
    }
    let mut changed = Expected::of(&scene)?;
    changed.hello = expected.hello;
    Ok(changed)
}

/// Compares sample by sample.
struct Player<'a, N: HostNumber> {
    stretches: &'a [Stretch<N>],
    /// Of these the one under way,
    stretch: usize,
    /// and its next sample.
    next: usize,
    /// The board's tick at the first sample of the stretch, less what the host counts there.
    start: u32,
    /// Samples of stretches.
    compared: u64,
    /// Samples before a stretch.
    idle: u64,
    /// Ticks without an interrupt of the line,
    timed: u64,
    /// and the longest of them.
    longest: u32,
}

impl<N: HostNumber> Player<'_, N> {
    fn see(&mut self, sample: &Telemetry<N>, moment: Moment) -> Result<ControlFlow<()>> {
        if moment.quiet {
            self.timed += 1;
            self.longest = self.longest.max(sample.duration);
        }
        if sample.state == State::Enabling {
            return Ok(ControlFlow::Continue(()));
        }
        let Some(stretch) = self.stretches.get(self.stretch) else {
            // At rest, until the client has heard that the job is over, too.
            let last = self.stretches.last().and_then(|last| last.samples.last());
            self.compare(sample, last.context("a stretch has an end")?)?;
            return Ok(match moment.over {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            });
        };
        if self.next == 0 && sample.state == stretch.standing.state {
            self.idle += 1;
            self.compare(sample, &stretch.standing)?;
            return Ok(ControlFlow::Continue(()));
        }
        let expected = &stretch.samples[self.next];
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
        self.compare(sample, expected)?;
        self.compared += 1;
        self.next += 1;
        if self.next == stretch.samples.len() {
            (self.stretch, self.next) = (self.stretch + 1, 0);
        }
        Ok(ControlFlow::Continue(()))
    }

    /// All but the board's own time: its ticks are counted from its start, and each takes as long as
    /// it takes there.
    fn compare(&self, found: &Telemetry<N>, expected: &Telemetry<N>) -> Result<()> {
        let found = Telemetry {
            tick: expected.tick,
            duration: expected.duration,
            ..*found
        };
        ensure!(
            port::frame(&found) == port::frame(expected),
            "sample {} of stretch {}: {found:?}\nthe host computes {expected:?}",
            self.next,
            self.stretch
        );
        Ok(())
    }
}
