//! Case `reboot`: a drive on the bus restarts while the board stays on, and counts whole turns of its rotor more or less from then on.

use super::can::{LOOK, NO_TORQUE, bus, go_into_move};
use super::{Row, Subject, fact};
use crate::bus::DriveFailure;
use crate::cpu::Board;
use crate::host::Host;
use crate::time::{MS, SECOND, Time};
use anyhow::{Context, Result, bail, ensure};
use std::f64::consts::TAU;
use std::fmt;
use trirrr_client::UserCommand;
use trirrr_protocol::message::State;
use trirrr_scene::Knows;

/// The drive that restarts.
const LEG: usize = 1;

/// Turns that a drive counts more behind a restart. One that knows its joint counts none.
const TURNS: [f64; 7] = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0];

/// Times without power: a moment in which no tick misses the drive, so that lost turns show in a jump alone, and longer than a drive may be
/// silent. The moment is five ticks of the scenes: moteus gets no command any more then.
const GAPS: [Time; 2] = [MOMENT, 300 * MS];
const MOMENT: Time = 10 * MS;

/// Time in which the machine has to come to rest, and in which a host has to hear why it is not enabled.
const SOON: Time = SECOND;

/// Duration of the way back to the start of the job, s.
const RECOVERY_S: f64 = 0.4;

/// The machine when a drive restarts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Before {
    /// In mid-move.
    Moves,
    /// On a hold: at rest, with its drives on.
    Holds,
    /// Its drives are off.
    Off,
}

/// A restart of the drive.
#[derive(Clone, Copy, Debug)]
struct Restart {
    before: Before,
    gap: Time,
    turns: f64,
    /// Whole turns may be missing behind it, as far as the board can know.
    is_told: bool,
}

impl fmt::Display for Restart {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            before, gap, turns, ..
        } = self;
        write!(formatter, "{before:?}, {} ms, {turns} turns", gap / MS)
    }
}

/// Board with a machine in mid-move, and the host that plays its job.
struct Machine<'a> {
    subject: &'a Subject,
    board: Board,
    host: Host,
    /// Joint angles at the start of the job.
    start: [f64; 3],
    conversation: u32,
}

/// What all restarts of a case have come to.
#[derive(Default)]
struct Tally {
    /// Restarts that a host was told before any drive had a torque.
    told: usize,
    /// Largest distance of a joint from where the board takes it to be while drives have a torque, rad.
    deviation: f64,
    /// Restarts that did not go as they have to, with the reason.
    failed: Vec<String>,
}

impl<'a> Machine<'a> {
    fn new(subject: &'a Subject) -> Result<Self> {
        let mut board = subject.switch_on()?;
        let mut host = subject.host(&mut board)?;
        let start = bus(&mut board)?.angles();
        go_into_move(&mut board, &mut host, start)?;
        Ok(Self {
            subject,
            board,
            host,
            start,
            conversation: 100,
        })
    }

    /// Lets the next host take the place of the one before.
    fn change_host(&mut self) -> Result<()> {
        self.conversation += 1;
        let scene = &self.subject.scene;
        self.host = Host::recovering(scene, &mut self.board, self.conversation, RECOVERY_S)?;
        Ok(())
    }

    /// Goes on for `time`, beyond the end of the host's job.
    fn pass(&mut self, time: Time) -> Result<()> {
        let end = self.board.now() + time;
        self.host.run(&mut self.board, end)?;
        self.board.run(end)
    }

    /// Brings the machine from its move to what it is when the drive restarts.
    fn prepare(&mut self, before: Before) -> Result<()> {
        let (command, wanted) = match before {
            Before::Moves => return Ok(()),
            Before::Holds => (UserCommand::Hold, State::Holding),
            Before::Off => (UserCommand::Disable, State::Disabled),
        };
        self.host.command(command);
        let end = self.board.now() + SOON;
        while self.host.client().status().map(|status| status.state) != Some(wanted) {
            ensure!(self.board.now() < end, "not {wanted:?} within a second");
            self.pass(LOOK)?;
        }
        // The drives tell the end of their torques.
        self.pass(50 * MS)
    }

    fn restart(&mut self, restart: &Restart) -> Result<()> {
        bus(&mut self.board)?.fail(LEG, DriveFailure::Unplugged);
        self.pass(restart.gap)?;
        bus(&mut self.board)?.restart(LEG, restart.turns);
        self.pass(100 * MS)
    }

    /// Returns true if a drive has a torque.
    fn has_torque(&mut self) -> Result<bool> {
        let torques = bus(&mut self.board)?.torques();
        Ok(torques.into_iter().any(|torque| torque.abs() > NO_TORQUE))
    }

    /// Returns the largest distance of a joint from where the board takes it to be, rad.
    fn deviation(&mut self) -> Result<f64> {
        let known = self.host.samples.last().context("a sample")?.angles;
        let joints = bus(&mut self.board)?.angles();
        let off = joints.into_iter().zip(known).map(|(joint, known)| {
            let off = joint - f64::from(known);
            (off - TAU * (off / TAU).round()).abs()
        });
        Ok(off.fold(0.0, f64::max))
    }

    /// A host acknowledges whatever fault there is, and asks for the drives. Returns what it was told, before any drive has a torque.
    fn told(&mut self) -> Result<String> {
        self.change_host()?;
        let end = self.board.now() + SOON;
        while self.board.now() < end {
            self.pass(LOOK)?;
            if self.has_torque()? {
                bail!("a drive has a torque before the host was told");
            }
            if let Some(Err(told)) = &self.host.ended {
                return Ok(told.clone());
            }
        }
        bail!("the host is told nothing")
    }

    /// The next host, which acknowledges what it may have been told, gets the machine into its move again.
    fn plays_again(&mut self, tally: &mut Tally) -> Result<()> {
        self.change_host()?;
        let end = self.board.now() + 3 * SOON;
        while self.host.samples.is_empty() || !self.has_torque()? {
            ensure!(self.board.now() < end, "no drive gets a torque");
            if let Some(Err(told)) = &self.host.ended {
                bail!("{told}");
            }
            self.pass(LOOK)?;
        }
        tally.deviation = tally.deviation.max(self.deviation()?);
        go_into_move(&mut self.board, &mut self.host, self.start)?;
        tally.deviation = tally.deviation.max(self.deviation()?);
        if let Some(broken) = bus(&mut self.board)?.broken() {
            bail!("{broken}");
        }
        Ok(())
    }

    /// The drive restarts, and hosts go on from there.
    fn survives(&mut self, restart: &Restart, tally: &mut Tally) -> Result<()> {
        self.prepare(restart.before)?;
        self.restart(restart)?;
        if restart.is_told {
            let told = self.told()?;
            let names = told.contains("restarted") && told.contains(&format!("drive {}", LEG + 1));
            ensure!(names, "{told}");
            tally.told += 1;
        } else if self.host.ended.is_none() {
            // A drive that goes on by its next command, and has lost nothing, is nobody's concern.
            self.host.command(UserCommand::Disable);
            self.pass(SOON)?;
        }
        self.plays_again(tally)
    }
}

/// Restarts of a drive that knows so much.
fn restarts(knows: Knows) -> Vec<Restart> {
    let turns = match knows {
        Knows::Joint => &TURNS[..1],
        Knows::Rotor | Knows::Nothing => &TURNS[..],
    };
    let mut all = Vec::new();
    for before in [Before::Moves, Before::Holds, Before::Off] {
        for gap in GAPS {
            all.extend(turns.iter().map(|&turns| Restart {
                before,
                gap,
                turns,
                is_told: knows != Knows::Joint && (gap > MOMENT || turns != 0.0),
            }));
        }
    }
    all
}

/// A drive restarts in mid-move, on a hold and while it is off. No host gets a torque before one was told; the next one, which acknowledges,
/// finds the joints where they are, and plays the job.
pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let drives = subject.scene.drives.as_ref().context("drives")?;
    let knows = drives[LEG].can().context("a drive on the bus")?.knows;
    let all = restarts(knows);
    let mut tally = Tally::default();
    let mut machine = Machine::new(subject)?;
    for restart in &all {
        if let Err(why) = machine.survives(restart, &mut tally) {
            tally.failed.push(format!("{restart}: {why:#}"));
            machine = Machine::new(subject)?;
        }
    }
    let told = all.iter().filter(|restart| restart.is_told).count();
    let bound = subject.scene.feedback.unwrap_or_default();
    let bound = bound.following_moving_rad;
    Ok(vec![
        fact(
            "reboot",
            &format!(
                "{} restarts of drive {} in mid-move, on a hold and off, without power for 10 and 300 ms, {} turns: not as they have to be",
                all.len(),
                LEG + 1,
                match knows {
                    Knows::Joint => "no",
                    Knows::Rotor | Knows::Nothing => "-3 to 3",
                },
            ),
            match tally.failed.is_empty() {
                true => "none".into(),
                false => tally.failed.join("; "),
            },
            "none",
        ),
        fact(
            "reboot",
            "told to a host before a drive has a torque",
            tally.told.to_string(),
            &told.to_string(),
        ),
        Row {
            case: "reboot",
            subject:
                "drives with a torque behind them: joints off the angles of the board by at most"
                    .into(),
            measured: format!("{:.4} rad", tally.deviation),
            bound: format!("≤ {bound} rad"),
            holds: tally.deviation <= bound,
        },
    ])
}
