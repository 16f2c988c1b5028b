//! Update over the line: another program takes the place of the one that runs, and goes again where it fails.

use super::{OSCILLATOR_HZ, Row, Subject, fact, time};
use crate::chip::{Kind, ResetCause, SYS_TICK};
use crate::cpu::{Board, Hang, load};
use crate::host::{HostLine, LOOK};
use crate::time::{MS, SECOND, Time, seconds};
use anyhow::{Context, Result, bail, ensure};
use std::cell::Cell;
use std::path::Path;
use std::time::Duration;
use trirrr_boot::Slot;
use trirrr_client::{
    Dialogue, Patience, ProgramImage, Turn, UpdateClient, UpdateFailure, describe,
};
use trirrr_protocol::message::{IMAGE_MARK, Refusal, UpdateRefusal};

const CASE: &str = "update";

/// Longest time of an update: four erasures of 2 s to install it, four to go back, with the words between.
const LONGEST: Time = 60 * SECOND;

pub(super) type Ended = Result<(), UpdateFailure<f32>>;

/// Host that replaces the program, or the scene.
pub(super) struct Updater {
    pub(super) client: UpdateClient<f32>,
    pub(super) line: HostLine,
    ended: Option<Ended>,
}

impl Updater {
    fn new(image: ProgramImage) -> Self {
        Self::of(UpdateClient::new(image, Patience::default(), 7))
    }

    pub(super) fn of(client: UpdateClient<f32>) -> Self {
        Self {
            client,
            line: HostLine::default(),
            ended: None,
        }
    }

    /// Lets both run until the end, or until `until` says so.
    pub(super) fn run(&mut self, board: &mut Board, until: impl Fn(&Self) -> bool) -> Result<()> {
        let end = board.now() + LONGEST;
        while self.ended.is_none() && !until(self) {
            ensure!(board.now() < end, "no end within {} s", seconds(LONGEST));
            // Nothing is said while the image is installed.
            let look = if self.client.is_restarting() {
                10 * MS
            } else {
                LOOK
            };
            board.run(board.now() + look)?;
            let now = Duration::from_secs_f64(seconds(board.now()));
            for message in self.line.hear(board) {
                self.client.receive(&message, now);
            }
            loop {
                match self.client.poll(now) {
                    Turn::Send(request) => self.line.say(board, &request),
                    Turn::Wait(_) => break,
                    Turn::Reconnect => self.client.reconnected(),
                    Turn::Done(result) => {
                        self.ended = Some(result);
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    pub(super) fn run_to_end(&mut self, board: &mut Board) -> Result<Ended> {
        self.run(board, |_| false)?;
        self.ended.context("the update has no end")
    }

    /// Name of the scene that answered last.
    pub(super) fn scene(&self) -> String {
        let identity = self.client.identity();
        identity.map_or("none".into(), |identity| {
            describe::board::name(&identity.name)
        })
    }
}

/// Content of the slot of the program with the image of `file` in it, without the erased bytes at its end.
fn content(file: &Path, program: &Slot) -> Result<Vec<u8>> {
    let flash = load(&[file])?;
    let start = (program.start - 0x0800_0000) as usize;
    let slot = &flash[start..start + program.bytes() as usize];
    let length = slot
        .iter()
        .rposition(|byte| *byte != 0xFF)
        .map_or(0, |last| last + 1);
    Ok(slot[..length].to_vec())
}

fn image(subject: &Subject, content: &[u8]) -> Result<ProgramImage> {
    let start = subject.kind.layout().program.start;
    ProgramImage::new(start, content.to_vec()).context("the image has no label")
}

pub(super) fn described(ended: Ended) -> String {
    format!("{ended:?}")
}

/// All of it: a program that stays, one that fails in two ways, one that is damaged, one for another board or chip, power that is cut.
pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let Some([_, other]) = &subject.update else {
        return Ok(Vec::new());
    };
    let other = content(other, &subject.kind.layout().program)?;
    let (mut rows, operations) = stays(subject, &other)?;
    type Failure = fn(&mut Board) -> Result<()>;
    let failures: [(&str, Failure); 2] = [
        ("hard fault", |board| board.jump(0x6000_0000)),
        ("tick hung", |board| {
            board.hung = Some(Hang::Tick);
            Ok(())
        }),
    ];
    for (what, fail) in failures {
        rows.extend(goes_back(subject, &other, what, fail)?);
    }
    rows.push(is_damaged(subject, &other)?);
    rows.extend(is_for_another_board(subject, &other)?);
    rows.push(is_for_another_chip(subject, &other)?);
    rows.extend(loses_power(subject, &other, operations)?);
    rows.extend(is_mended(subject, &other)?);
    match subject.kind {
        Kind::Stm32f405 => rows.extend(has_low_supply(subject, &other)?),
        Kind::Stm32g474 => rows.push(has_hole(subject, &other)?),
    }
    Ok(rows)
}

/// A confirmed program loses content: the boot loader puts its copy in its place.
fn is_mended(subject: &Subject, other: &[u8]) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    let ended = host.run_to_end(&mut board)?;
    ensure!(ended.is_ok(), "{}", described(ended));
    let program = subject.kind.layout().program;
    board.damage(program.start + 0x1234)?;
    board.reset(ResetCause::Pin)?;
    let mut again = Updater::new(image(subject, other)?);
    again.run(&mut board, |host| host.client.progress().0 > 0)?;
    let is_whole = board.flash(program.start, other.len()) == other;
    Ok(vec![
        fact(
            CASE,
            "program damaged in the flash: scene after a reset",
            again.scene(),
            "other",
        ),
        fact(
            CASE,
            "program damaged in the flash: whole afterwards",
            is_whole.to_string(),
            "true",
        ),
    ])
}

/// The supply is too low for the flash as the boot loader starts: it writes nothing until the supply is there.
fn has_low_supply(subject: &Subject, other: &[u8]) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    host.run(&mut board, |host| host.client.is_restarting())?;
    let before = board.chip().flash.operations();
    board.chip().set_supply(2600);
    board.run(board.now() + 500 * MS)?;
    let meanwhile = board.chip().flash.operations() - before;
    board.chip().set_supply(3300);
    let ended = host.run_to_end(&mut board)?;
    Ok(vec![
        fact(
            CASE,
            "supply of 2.6 V at the start: operations of the flash",
            meanwhile.to_string(),
            "0",
        ),
        fact(
            CASE,
            "supply of 2.6 V at the start, then there: result",
            described(ended),
            "Ok(())",
        ),
    ])
}

/// Returns the operations of the flash, too, that the boot loader takes.
fn stays(subject: &Subject, other: &[u8]) -> Result<(Vec<Row>, u32)> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    host.run(&mut board, |host| host.client.progress().0 > 0)?;
    let before = host.scene();
    host.run(&mut board, |host| host.client.is_restarting())?;
    let received = board.now();
    let operations_before = board.chip().flash.operations();
    let ended = host.run_to_end(&mut board)?;
    let installed = board.now() - received;
    let operations = board.chip().flash.operations() - operations_before;
    let program = subject.kind.layout().program;
    let resets: Vec<ResetCause> = board.resets.iter().map(|(_, cause)| *cause).collect();
    let mut rows = vec![
        fact(CASE, "result", described(ended), "Ok(())"),
        fact(CASE, "scene before", before, &subject.scene.name),
        fact(CASE, "scene afterwards", host.scene(), "other"),
        fact(
            CASE,
            "flash of the program is the image",
            (board.flash(program.start, other.len()) == other).to_string(),
            "true",
        ),
        fact(
            CASE,
            "resets: power-on and restart, none by the watchdog",
            format!("{resets:?}"),
            "[Power, Software]",
        ),
        within(
            "image of {} KiB over the line",
            other,
            received,
            30 * SECOND,
        ),
        within(
            "installed and answered, {} KiB",
            other,
            installed,
            30 * SECOND,
        ),
    ];
    let layout = subject.kind.layout();
    let needed = other.len().div_ceil(layout.new.sector_bytes as usize);
    let expected = needed + usize::from(layout.old.sectors + layout.program.sectors);
    let flash = &board.chip().flash;
    rows.push(fact(
        CASE,
        "sectors erased",
        flash.erasures.to_string(),
        // Those of the new slot that the image needs, and all of the old slot and of the program.
        &expected.to_string(),
    ));
    board.reset(ResetCause::Pin)?;
    board.run(board.now() + 100 * MS)?;
    let mut again = Updater::new(image(subject, other)?);
    again.run(&mut board, |host| host.client.progress().0 > 0)?;
    rows.push(fact(
        CASE,
        "scene after another reset",
        again.scene(),
        "other",
    ));
    Ok((rows, operations))
}

fn within(subject: &str, other: &[u8], measured: Time, bound: Time) -> Row {
    Row {
        case: CASE,
        subject: subject.replace("{}", &(other.len() / 1024).to_string()),
        measured: time(measured),
        bound: format!("≤ {}", time(bound)),
        holds: measured <= bound,
    }
}

/// The new program fails before a host has talked to it.
fn goes_back(
    subject: &Subject,
    other: &[u8],
    what: &str,
    fail: impl Fn(&mut Board) -> Result<()>,
) -> Result<[Row; 2]> {
    let mut board =
        subject.switch_on_with(&subject.image, subject.kind.crystal(), OSCILLATOR_HZ[0])?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    host.run(&mut board, |host| host.client.is_restarting())?;
    // The cable is pulled while the new program starts.
    let end = board.now() + LONGEST;
    while board.resets.len() < 2
        || board.last_begin(SYS_TICK) < board.resets.last().map(|(time, _)| *time)
    {
        ensure!(board.now() < end, "the new program does not start");
        board.run(board.now() + MS)?;
    }
    fail(&mut board)?;
    while board.resets.len() < 3 {
        if board.now() > end {
            bail!("{what}: no reset");
        }
        board.run(board.now() + MS)?;
    }
    board.hung = None;
    host.line.drop_all(&mut board);
    let ended = host.run_to_end(&mut board)?;
    Ok([
        fact(
            CASE,
            &format!("new program, {what}: result"),
            described(ended),
            "Err(Reverted)",
        ),
        fact(
            CASE,
            &format!("new program, {what}: scene afterwards"),
            host.scene(),
            &subject.scene.name,
        ),
    ])
}

/// A cell of the new image changes after its checksum was compared.
fn is_damaged(subject: &Subject, other: &[u8]) -> Result<Row> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    host.run(&mut board, |host| host.client.is_restarting())?;
    board.damage(subject.kind.layout().new.start + 4096)?;
    let ended = host.run_to_end(&mut board)?;
    let text = format!("{}, {}", described(ended), host.scene());
    let bound = format!("Err(Reverted), {}", subject.scene.name);
    Ok(fact(
        CASE,
        "image that is damaged in the flash",
        text,
        &bound,
    ))
}

/// Place of the label in an image.
fn label(image: &[u8]) -> Result<usize> {
    let mut windows = image.windows(IMAGE_MARK.len());
    let label = windows.position(|window| window == IMAGE_MARK);
    label.context("the image has no label")
}

/// An image of the other chip, at the start that the board has.
fn is_for_another_chip(subject: &Subject, other: &[u8]) -> Result<Row> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut foreign = other.to_vec();
    let label = label(&foreign)?;
    let chip: &[u8] = match subject.kind {
        Kind::Stm32f405 => b"stm32g474re",
        Kind::Stm32g474 => b"stm32f405rg",
    };
    // Behind mark, version, commit and board.
    foreign[label + 80..][..chip.len()].copy_from_slice(chip);
    let mut host = Updater::new(image(subject, &foreign)?);
    let ended = host.run_to_end(&mut board)?;
    let refused: Ended = Err(UpdateFailure::Refused(Refusal::Update(UpdateRefusal::Chip)));
    let text = described(ended);
    Ok(fact(
        CASE,
        "image for another chip",
        text,
        &described(refused),
    ))
}

/// A double word of the running program is lost: its version, which a hello reads. Boot loader and start do not.
fn has_hole(subject: &Subject, other: &[u8]) -> Result<Row> {
    let mut board = subject.switch_on()?;
    let program = subject.kind.layout().program;
    let own = content(&subject.image, &program)?;
    let version = label(&own)? + IMAGE_MARK.len();
    // Before anything runs: reads of code that Unicorn has translated already are not looked at.
    board.damage(program.start + version as u32)?;
    board.run(100 * MS)?;
    ensure!(board.resets.len() == 1, "the start reads the hole");
    let mut host = Updater::new(image(subject, other)?);
    let looks = Cell::new(0);
    host.run(&mut board, |_| looks.replace(looks.get() + 1) > 1000)?;
    let resets: Vec<ResetCause> = board.resets.iter().map(|(_, cause)| *cause).collect();
    let first = resets.get(..2).unwrap_or(&resets);
    Ok(fact(
        CASE,
        "a hole in the running program: resets",
        format!("{first:?}"),
        "[Power, Software]",
    ))
}

/// Places of cuts, as parts of the operations of an installation: in the copy of the old program, with which each of the first three begins
/// anew, from there into the copy of the new one, and in that.
const CUTS: [f64; 7] = [0.0, 0.02, 0.4, 0.6, 0.0, 0.05, 0.45];

/// The power goes seven times in the middle of an erasure or of a unit while the boot loader installs one image.
fn loses_power(subject: &Subject, other: &[u8], operations: u32) -> Result<[Row; 4]> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(subject, other)?);
    host.run(&mut board, |host| host.client.is_restarting())?;
    let mut lost = 0;
    for cut in CUTS {
        let resets = board.resets.len();
        let cut = (f64::from(operations) * cut) as u32;
        board.chip().flash.cut_power_in(cut);
        let end = board.now() + LONGEST;
        let is_cut = |board: &Board| {
            let mut since = board.resets.iter().skip(resets);
            since.any(|(_, cause)| *cause == ResetCause::Power)
        };
        while !is_cut(&board) {
            ensure!(board.now() < end, "no operation number {cut}");
            board.run(board.now() + 10 * MS)?;
        }
        lost = lost.max(board.chip().flash.lost().len());
    }
    host.line.drop_all(&mut board);
    let ended = host.run_to_end(&mut board)?;
    let row = |what: &str, measured: String, bound: &str| {
        fact(
            CASE,
            &format!("power cut seven times: {what}"),
            measured,
            bound,
        )
    };
    let start = subject.kind.layout().program.start;
    let is_whole = board.flash(start, other.len()) == other;
    let left = board.chip().flash.lost().len();
    let has_check_bits = subject.kind == Kind::Stm32g474;
    Ok([
        row("result", described(ended), "Ok(())"),
        row("scene afterwards", host.scene(), "other"),
        row(
            "flash of the program is the image",
            is_whole.to_string(),
            "true",
        ),
        // Check bits tell of them, where the chip has some. What they are left in is erased before it is used again.
        Row {
            case: CASE,
            subject: "power cut seven times: double words that were lost at a time, and at the end"
                .into(),
            measured: format!("{lost}, {left}"),
            bound: match has_check_bits {
                true => "some, fewer".into(),
                false => "0, 0".into(),
            },
            holds: (lost > 0) == has_check_bits && (left < lost || left == 0),
        },
    ])
}

fn is_for_another_board(subject: &Subject, other: &[u8]) -> Result<[Row; 2]> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut foreign = other.to_vec();
    let label = label(&foreign)?;
    // Behind mark, version and commit.
    foreign[label + 48] ^= 0x20;
    let mut host = Updater::new(image(subject, &foreign)?);
    let ended = host.run_to_end(&mut board)?;
    let refused: Ended = Err(UpdateFailure::Refused(Refusal::Update(
        UpdateRefusal::Board,
    )));
    let flash = &board.chip().flash;
    Ok([
        fact(
            CASE,
            "image for another board",
            described(ended),
            &described(refused),
        ),
        fact(
            CASE,
            "erasures and programmed units by then",
            format!("{}, {}", flash.erasures, flash.units),
            "0, 0",
        ),
    ])
}
