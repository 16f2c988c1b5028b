//! The summary of a stream.

use super::StreamEnd;
use crate::failure::CliError;
use crate::recording::{DrivePeaks, Recorded};
use crate::terminal::printed;
use std::io::{self, Write};
use std::path::Path;
use trirrr_client::describe;
use trirrr_line::Address;
use trirrr_protocol::message::{Identity, Status, Transmit};
use trirrr_scene::NumberType;
use trirrr_scene::Scene;
use trirrr_scene::visible;
use trirrr_scene::words::short;

/// Contents of the summary.
pub(super) struct Summary<'a> {
    pub(super) file: &'a Path,
    pub(super) scene: &'a Scene,
    pub(super) scalar: NumberType,
    pub(super) address: &'a Address,
    pub(super) board: Option<&'a Identity>,
    /// Account of the machine, if it has told its status.
    pub(super) status: Option<Account>,
    pub(super) done: u32,
    /// The machine has left the job on its way.
    pub(super) is_begun: bool,
    pub(super) moves: u32,
    /// Word for one of them.
    pub(super) item: &'a str,
    pub(super) every: u16,
    pub(super) recorded: &'a Recorded,
    /// Records of the drives, if they tell something.
    pub(super) drives: Option<&'a DrivePeaks>,
    pub(super) missing: u64,
    pub(super) differing: u64,
    pub(super) repeated: u64,
    pub(super) opened_anew: u64,
    pub(super) damaged: u64,
    /// None where it failed.
    pub(super) end: Option<StreamEnd>,
}

/// Account of a machine since it was switched on.
pub(super) struct Account {
    /// The longest tick in counts of the board's timer.
    longest_tick: u32,
    late_ticks: u32,
    longest_stop: u32,
}

impl Account {
    /// Account in a status.
    pub(super) fn of<N: Transmit>(status: &Status<N>) -> Self {
        Self {
            longest_tick: status.longest_tick,
            late_ticks: status.late_ticks,
            longest_stop: status.longest_stop,
        }
    }
}

/// Prints the summary on standard output.
///
/// # Errors
/// Failed: standard output cannot be written.
pub(super) fn print(summary: &Summary) -> Result<(), CliError> {
    printed(write(&mut io::stdout().lock(), summary))
}

fn write(out: &mut dyn Write, summary: &Summary) -> io::Result<()> {
    let Summary { scene, scalar, .. } = summary;
    let mut line = |label: &str, text: &str| writeln!(out, "{label:<12}{}", visible(text));
    line(
        "scene",
        &format!("{} ({})", scene.name, summary.file.display()),
    )?;
    line("numbers", &scalar.to_string())?;
    let board = match summary.board {
        Some(identity) => format!(
            "{}, {} ticks per second",
            describe::board::name(&identity.name),
            identity.tick_rate_hz
        ),
        None => "did not answer".into(),
    };
    line("board", &format!("{board} ({})", summary.address))?;
    if let Some(identity) = summary.board {
        let board = &identity.board;
        let firmware = describe::board::firmware(&identity.firmware);
        line("firmware", &firmware)?;
        if let Some(text) = describe::board::clock(board.clock) {
            line("warning", text)?;
        }
        if let Some(text) = describe::board::reference(identity.reference) {
            line("warning", text)?;
        }
        if board.start.is_failure() {
            let why = describe::board::start(&board.start);
            line("warning", &format!("why the board started last: {why}"))?;
        }
        if let Some(account) = &summary.status {
            let longest = f64::from(account.longest_tick) / f64::from(board.timer_hz.max(1));
            let period = short(1e6 / identity.tick_rate_hz);
            if account.longest_tick > 0 {
                let (longest, late) = (short(1e6 * longest), account.late_ticks);
                let text = format!("the longest took {longest} of {period} us, {late} were late");
                line("ticks", &text)?;
            }
            let seconds = |ticks: u32| short(f64::from(ticks) / identity.tick_rate_hz);
            if account.longest_stop > 0 {
                let text = format!(
                    "the longest way to rest took {} s",
                    seconds(account.longest_stop)
                );
                line("stops", &text)?;
            }
        }
    }
    let (done, moves, item) = (summary.done, summary.moves, summary.item);
    let job = match summary.end {
        Some(StreamEnd::Complete) => format!("{done} of {moves} {item}s done"),
        Some(StreamEnd::Stopped) if summary.is_begun => {
            format!("stopped in {item} {} of {moves}", (done + 1).min(moves))
        }
        Some(StreamEnd::Stopped) => format!("stopped before the first of {moves} {item}s"),
        None => format!("{done} of {moves} {item}s done, not complete"),
    };
    line("job", &job)?;
    let (rows, missing) = (summary.recorded.rows, summary.missing);
    let every = match summary.every {
        1 => "one every tick".into(),
        every => format!("one every {every} ticks"),
    };
    line("samples", &format!("{rows}, {every}, {missing} missing"))?;
    if let Some(drives) = summary.drives {
        drives.print(&mut line)?;
    }
    line(
        "link",
        &format!(
            "{} requests repeated, {} frames damaged, port opened anew {} times",
            summary.repeated, summary.damaged, summary.opened_anew
        ),
    )?;
    if summary.differing > 0 {
        let text = format!(
            "in {} samples the motors are not where this scene puts them: the board computes with \
             another version, or its scene was overridden",
            summary.differing
        );
        line("warning", &text)?;
    }
    for (i, file) in summary.recorded.files.iter().enumerate() {
        let label = if i == 0 { "written" } else { "" };
        line(label, &file.display().to_string())?;
    }
    out.flush()
}
