//! The summary of a stream.

use super::StreamEnd;
use crate::failure::CliError;
use crate::player::RecordedJob;
use crate::terminal::show;
use std::path::Path;
use trirrr_client::describe;
use trirrr_figures::document::{Document, Facts};
use trirrr_line::Address;
use trirrr_protocol::message::{Identity, Status, Transmit};
use trirrr_scene::NumberType;
use trirrr_scene::Scene;
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
    pub(super) recorded: &'a RecordedJob,
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
    show(&document(summary), false)
}

fn document(summary: &Summary) -> Document {
    let Summary { scene, scalar, .. } = summary;
    let board = match summary.board {
        Some(identity) => format!(
            "{}, {} ticks per second",
            describe::board::name(&identity.name),
            identity.tick_rate_hz
        ),
        None => "did not answer".into(),
    };
    let (done, moves, item) = (summary.done, summary.moves, summary.item);
    let job = match summary.end {
        Some(StreamEnd::Complete) => format!("{done} of {moves} {item}s done"),
        Some(StreamEnd::Stopped) if summary.is_begun => {
            format!("stopped in {item} {} of {moves}", (done + 1).min(moves))
        }
        Some(StreamEnd::Stopped) => format!("stopped before the first of {moves} {item}s"),
        None => format!("{done} of {moves} {item}s done, not complete"),
    };
    let (rows, missing) = (summary.recorded.job.rows, summary.missing);
    let every = match summary.every {
        1 => "one every tick".into(),
        every => format!("one every {every} ticks"),
    };
    let link = format!(
        "{} requests repeated, {} frames damaged, port opened anew {} times",
        summary.repeated, summary.damaged, summary.opened_anew
    );
    let differing = (summary.differing > 0).then(|| {
        format!(
            "in {} samples the motors are not where this scene puts them: the board computes with \
             another version, or its scene was overridden",
            summary.differing
        )
    });
    let drives = summary.recorded.drives.as_ref();
    let files = drives.into_iter().flat_map(|drives| &drives.files);
    let files = summary.recorded.job.files.iter().chain(files);
    let record = Facts::new()
        .text(
            "scene",
            format!("{} ({})", scene.name, summary.file.display()),
        )
        .text("numbers", scalar.to_string())
        .text("board", format!("{board} ({})", summary.address))
        .and(summary.board.map_or(Facts::new(), |identity| {
            told(identity, summary.status.as_ref())
        }))
        .text("job", job)
        .text("samples", format!("{rows}, {every}, {missing} missing"))
        .and(
            drives
                .map(|drives| drives.peaks.record())
                .unwrap_or_default(),
        )
        .text("link", link)
        .text("warning", differing)
        .text(
            "written",
            Vec::from_iter(files.map(|file| file.display().to_string())),
        );
    let mut document = Document::new();
    document.pairs(record);
    document
}

/// Account that a board gives of itself.
fn told(identity: &Identity, account: Option<&Account>) -> Facts {
    let board = &identity.board;
    let start = board.start.is_failure().then(|| {
        let why = describe::board::start(&board.start);
        format!("why the board started last: {why}")
    });
    let clock = describe::board::clock(board.clock).map(String::from);
    let reference = describe::board::reference(identity.reference).map(String::from);
    let ticks = account
        .filter(|account| account.longest_tick > 0)
        .map(|account| {
            let longest = f64::from(account.longest_tick) / f64::from(board.timer_hz.max(1));
            let (longest, period) = (short(1e6 * longest), short(1e6 / identity.tick_rate_hz));
            format!(
                "the longest took {longest} of {period} us, {} were late",
                account.late_ticks
            )
        });
    let stops = account
        .filter(|account| account.longest_stop > 0)
        .map(|account| {
            let longest = f64::from(account.longest_stop) / identity.tick_rate_hz;
            format!("the longest way to rest took {} s", short(longest))
        });
    Facts::new()
        .text("firmware", describe::board::firmware(&identity.firmware))
        .text(
            "warning",
            Vec::from_iter([clock, reference, start].into_iter().flatten()),
        )
        .text("ticks", ticks)
        .text("stops", stops)
}
