//! Cases of the bench: each runs the image on a board of its own and gives rows of figures with their bounds.

mod alone;
mod amplifiers;
mod can;
mod failures;
mod install;
mod job;
mod line;
mod outputs;
mod power_up;
mod reboot;
mod slots;
mod update;
mod usb;

use crate::chip::{Crystal, Kind, ResetCause};
use crate::cpu::Board;
use crate::host::Host;
use crate::time::{MS, SECOND, Time};
use crate::usb::UsbHost;
use crate::wiring::{self, Output};
use anyhow::{Result, ensure};
use std::path::{Path, PathBuf};
use trirrr_scene::{DriveKind, Scene};

/// Outputs that are on in the middle of a job. Of the spare ones the second: scenes of the bench have it so.
const ON_IN_MID_JOB: [&str; 4] = ["drives", "tool", "tool enable", wiring::SPARE[1]];

/// Clock of the watchdog's oscillator, Hz: typical, and the ends of the data sheet.
pub(crate) const OSCILLATOR_HZ: [u64; 3] = [32_000, 47_000, 17_000];

/// A figure of a case, and the bound that it has to keep.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) case: &'static str,
    pub(crate) subject: String,
    pub(crate) measured: String,
    pub(crate) bound: String,
    pub(crate) holds: bool,
}

/// Scene with its images.
pub(crate) struct Subject {
    pub(crate) scene: Scene,
    /// Chip that the images are for.
    pub(crate) kind: Kind,
    /// The line is USB.
    pub(crate) has_usb: bool,
    /// The image that is flashed.
    pub(crate) image: PathBuf,
    /// The same with a panic in its 50th tick.
    pub(crate) panicking: Option<PathBuf>,
    /// Boot loader, and an image of another scene for the same board, where images are replaced over the line.
    pub(crate) update: Option<[PathBuf; 2]>,
    /// File for the edges of the case `job`.
    pub(crate) dump: Option<PathBuf>,
}

/// Drives that a case looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    Any,
    Steppers,
    /// Steppers on a chip whose firmware sees its supply sag.
    Supply,
    Amplifiers,
    Bus,
    /// None: the image is replaced over the line.
    Update,
    /// No drives at all, and an image that stays.
    NoDrives,
    /// None: the image takes scenes over the line.
    SceneOverLine,
    /// Steppers, and the line over USB.
    Usb,
    /// Spare outputs, on a machine of steppers.
    SpareOutputs,
    /// Steppers, and no host.
    NoHost,
}

/// Case of the bench.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) needs: Needs,
    pub(crate) run: fn(&Subject) -> Result<Vec<Row>>,
}

impl Case {
    const fn of(name: &'static str, needs: Needs, run: fn(&Subject) -> Result<Vec<Row>>) -> Self {
        Self { name, needs, run }
    }
}

/// All cases.
pub(crate) const CASES: [Case; 37] = [
    Case::of("power-up", Needs::Any, power_up::rest),
    Case::of("crystal", Needs::Any, power_up::crystal),
    Case::of("job", Needs::Steppers, job::run),
    Case::of("resets", Needs::Steppers, failures::resets),
    Case::of("panic", Needs::Steppers, failures::panic),
    Case::of("hard-fault", Needs::Steppers, failures::hard_fault),
    Case::of("watchdog", Needs::Steppers, failures::watchdog),
    Case::of("clock", Needs::Steppers, failures::clock),
    Case::of("free-run", Needs::Steppers, failures::free_run),
    Case::of("supply", Needs::Supply, failures::supply),
    Case::of("late-sag", Needs::Supply, failures::late_sag),
    Case::of("halt", Needs::Steppers, failures::halt),
    Case::of("cable", Needs::Steppers, failures::cable),
    Case::of("amplifiers", Needs::Amplifiers, amplifiers::moving),
    Case::of("blocked", Needs::Amplifiers, amplifiers::blocked),
    Case::of("encoder", Needs::Amplifiers, amplifiers::broken_wire),
    Case::of("can", Needs::Bus, can::job),
    Case::of("bus-clock", Needs::Bus, can::without_crystal),
    Case::of("bus-off", Needs::Bus, can::wire),
    Case::of("drive", Needs::Bus, can::drive),
    Case::of("reboot", Needs::Bus, reboot::run),
    Case::of("stop", Needs::Steppers, failures::stop),
    Case::of("update", Needs::Update, update::run),
    Case::of("line", Needs::NoDrives, line::damaged),
    Case::of("late", Needs::NoDrives, line::late),
    Case::of("install", Needs::SceneOverLine, install::run),
    Case::of("enumeration", Needs::Usb, usb::enumeration),
    Case::of("bus-reset", Needs::Usb, usb::bus_reset),
    Case::of("suspend", Needs::Usb, usb::suspend),
    Case::of("reader", Needs::Usb, usb::reader),
    Case::of("transfer", Needs::Usb, usb::transfer),
    Case::of("outputs", Needs::SpareOutputs, outputs::run),
    Case::of("alone", Needs::NoHost, alone::job),
    Case::of("alone-button", Needs::NoHost, alone::button),
    Case::of("alone-stop", Needs::NoHost, alone::stop),
    Case::of("alone-door", Needs::NoHost, alone::door),
    Case::of("alone-panic", Needs::NoHost, alone::panic),
];

impl Subject {
    fn switch_on(&self) -> Result<Board> {
        self.switch_on_with(&self.image, self.kind.crystal(), OSCILLATOR_HZ[0])
    }

    fn switch_on_with(&self, image: &Path, crystal: Crystal, oscillator_hz: u64) -> Result<Board> {
        let boot = self.update.as_ref().map(|[boot, _]| boot.as_path());
        let images: Vec<&Path> = boot.into_iter().chain([image]).collect();
        let mut board = Board::switch_on(self.kind, &images, crystal, oscillator_hz)?;
        if self.has(Needs::Bus) {
            board.chip().bus = Some(crate::bus::of_scene(&self.scene)?);
        }
        board.chip().plug = self.has_usb.then(UsbHost::new);
        // Contacts to ground: released, and closed.
        for pin in [wiring::STOP, wiring::DOOR] {
            board.chip().drive(pin, Some(false));
        }
        Ok(board)
    }

    /// Returns a host of a board that has started.
    fn host(&self, board: &mut Board) -> Result<Host> {
        self.host_of(board, &self.scene)
    }

    /// Returns a host of a board that has started, with the job of `scene`.
    fn host_of(&self, board: &mut Board, scene: &Scene) -> Result<Host> {
        let ticks = board.handled.len();
        let end = board.now() + SECOND;
        while board.handled.len() == ticks && board.now() < end {
            board.run(board.now() + MS)?;
        }
        // A program finds the port once the board is enumerated.
        while board
            .chip()
            .plug
            .as_ref()
            .is_some_and(|plug| !plug.is_open())
            && board.now() < end
        {
            board.run(board.now() + MS)?;
        }
        Host::new(scene)
    }

    /// Returns true if the scene has the drives that a case looks at.
    pub(crate) fn has(&self, needs: Needs) -> bool {
        let kind = self.scene.drives.as_ref().map(|[first, ..]| &first.kind);
        let has_host = self.scene.service.autonomous.is_none();
        match needs {
            // The other cases talk to the machine.
            Needs::NoHost => !has_host && matches!(kind, Some(DriveKind::Stepper(_))),
            _ if !has_host => false,
            Needs::Any => true,
            Needs::Update => self.update.is_some(),
            Needs::SpareOutputs => {
                self.has(Needs::Steppers) && !self.scene.spare_pins.outputs.is_empty()
            }
            Needs::SceneOverLine => self.update.is_some() && self.scene.service.scene_over_line,
            Needs::Steppers => matches!(kind, Some(DriveKind::Stepper(_))),
            Needs::Usb => self.has_usb && self.has(Needs::Steppers),
            Needs::Supply => self.has(Needs::Steppers) && self.kind == Kind::Stm32f405,
            Needs::Amplifiers => matches!(kind, Some(DriveKind::Bldc(_))),
            // The scene of an image that is replaced has small motors, which the random jobs ask too much of.
            Needs::NoDrives => kind.is_none() && self.update.is_none(),
            // The loops of simulated drives take the gains of the scene.
            Needs::Bus => {
                matches!(kind, Some(DriveKind::Can(_))) && self.scene.controller.is_some()
            }
        }
    }

    fn outputs(&self) -> Vec<Output> {
        wiring::outputs(&self.scene, self.kind)
    }

    /// Longest time that the job may take, with what comes before.
    fn longest(&self) -> Time {
        let seconds = self.scene.ticks() as f64 / self.scene.tick_rate_hz;
        crate::time::of_seconds(3.0 + 1.5 * seconds)
    }

    /// Returns a board in the middle of its job, with drives on and steps, and its host.
    fn in_mid_job(&self, oscillator_hz: u64) -> Result<(Board, Host)> {
        let mut board = self.switch_on_with(&self.image, self.kind.crystal(), oscillator_hz)?;
        let mut host = self.host(&mut board)?;
        while step_edges(&board) < 20 {
            let now = board.now();
            ensure!(now < 3 * SECOND, "no motor has moved within 3 s");
            host.run(&mut board, now + 10 * MS)?;
        }
        // Into the move, away from its begin.
        let middle = board.now() + 250 * MS;
        host.run(&mut board, middle)?;
        ensure!(host.ended.is_none(), "the job is over before its middle");
        let outputs = self.outputs();
        let off: Vec<&str> = outputs
            .iter()
            .filter(|output| !output.was_on(board.trace(), middle - 2 * MS))
            .map(|output| output.name)
            .filter(|name| ON_IN_MID_JOB.contains(name))
            .collect();
        ensure!(
            off.is_empty(),
            "in the middle of the job these are off: {}",
            off.join(", ")
        );
        Ok((board, host))
    }
}

/// Returns the number of edges of all step lines.
fn step_edges(board: &Board) -> usize {
    let count = |pin| board.trace().edges(pin).len();
    wiring::STEPS.map(count).iter().sum()
}

/// Formats a time in µs, or in ms from one on.
fn time(time: Time) -> String {
    match time < MS {
        true => format!("{:.1} µs", crate::time::micros(time)),
        false => format!("{:.2} ms", crate::time::micros(time) / 1000.0),
    }
}

/// Row of the time until all `outputs` were off for good.
fn off_within(
    board: &Board,
    outputs: &[Output],
    case: &'static str,
    subject: &str,
    since: Time,
    bound: Time,
) -> Row {
    let off: Vec<Option<Time>> = outputs
        .iter()
        .map(|output| output.off_since(board.trace(), since))
        .collect();
    let all = off.iter().copied().collect::<Option<Vec<Time>>>();
    let last = all.and_then(|times| times.into_iter().max());
    let measured = match last {
        Some(last) => time(last - since),
        None => {
            let on = outputs.iter().zip(&off).filter(|(_, off)| off.is_none());
            let on: Vec<&str> = on.map(|(output, _)| output.name).collect();
            format!("on: {}", on.join(", "))
        }
    };
    Row {
        case,
        subject: format!("{subject}: all off after"),
        measured,
        bound: format!("≤ {}", time(bound)),
        holds: last.is_some_and(|last| last - since <= bound),
    }
}

/// Row of the outputs that were on between `since` and now.
fn never_on(
    board: &Board,
    outputs: &[Output],
    case: &'static str,
    subject: String,
    since: Time,
) -> Row {
    let on: Vec<&str> = outputs
        .iter()
        .filter(|output| output.was_on(board.trace(), since))
        .map(|output| output.name)
        .collect();
    Row {
        case,
        subject: format!("{subject}: outputs that were on"),
        measured: if on.is_empty() {
            "none".into()
        } else {
            on.join(", ")
        },
        bound: "none".into(),
        holds: on.is_empty(),
    }
}

/// Row of a fact.
fn fact(case: &'static str, subject: &str, measured: String, bound: &str) -> Row {
    Row {
        case,
        subject: subject.into(),
        holds: measured == bound,
        measured,
        bound: bound.into(),
    }
}

/// Name of a cause of a reset.
fn name(cause: ResetCause) -> &'static str {
    match cause {
        ResetCause::Power => "power-on",
        ResetCause::Pin => "reset pin",
        ResetCause::BrownOut => "brown-out",
        ResetCause::Watchdog => "watchdog",
        ResetCause::Software => "software",
    }
}
