//! Update over the line: another program takes the place of the one that runs, and goes again where it fails.

use super::{OSCILLATOR_HZ, Row, Subject, fact, time};
use crate::chip::{ResetCause, SYS_TICK};
use crate::cpu::{Board, Hang, load};
use crate::host::{HostLine, LOOK};
use crate::time::{MS, SECOND, Time, seconds};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use std::time::Duration;
use trirrr_client::{Patience, ProgramImage, UpdateAction, UpdateClient, UpdateFailure, describe};
use trirrr_protocol::message::{IMAGE_MARK, Refusal, UpdateRefusal};

const CASE: &str = "update";

/// Places of a program and of a new one, as in the boot loader's layout.
const PROGRAM: u32 = 0x0802_0000;
const NEW: u32 = 0x0806_0000;
const SLOT: usize = 256 * 1024;

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
                    UpdateAction::Send(request) => self.line.say(board, &request),
                    UpdateAction::Wait(_) => break,
                    UpdateAction::Lost => self.client.reconnected(),
                    UpdateAction::Finished(result) => {
                        self.ended = Some(result);
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    pub(super) fn to_end(&mut self, board: &mut Board) -> Result<Ended> {
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
fn content(file: &Path) -> Result<Vec<u8>> {
    let flash = load(&[file])?;
    let start = (PROGRAM - 0x0800_0000) as usize;
    let slot = &flash[start..start + SLOT];
    let length = slot
        .iter()
        .rposition(|byte| *byte != 0xFF)
        .map_or(0, |last| last + 1);
    Ok(slot[..length].to_vec())
}

fn image(content: &[u8]) -> Result<ProgramImage> {
    ProgramImage::new(PROGRAM, content.to_vec()).context("the image has no label")
}

pub(super) fn described(ended: Ended) -> String {
    format!("{ended:?}")
}

/// All of it: a program that stays, one that fails in two ways, one that is damaged, one for another board.
pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let Some([_, other]) = &subject.update else {
        return Ok(Vec::new());
    };
    let other = content(other)?;
    let mut rows = stays(subject, &other)?;
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
    Ok(rows)
}

fn stays(subject: &Subject, other: &[u8]) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut host = Updater::new(image(other)?);
    host.run(&mut board, |host| host.client.progress().0 > 0)?;
    let before = host.scene();
    host.run(&mut board, |host| host.client.is_restarting())?;
    let received = board.now();
    let ended = host.to_end(&mut board)?;
    let installed = board.now() - received;
    let resets: Vec<ResetCause> = board.resets.iter().map(|(_, cause)| *cause).collect();
    let mut rows = vec![
        fact(CASE, "result", described(ended), "Ok(())"),
        fact(CASE, "scene before", before, &subject.scene.name),
        fact(CASE, "scene afterwards", host.scene(), "other"),
        fact(
            CASE,
            "flash of the program is the image",
            (board.flash(PROGRAM, other.len()) == other).to_string(),
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
    let flash = &board.chip().flash;
    rows.push(fact(
        CASE,
        "sectors erased",
        flash.erasures.to_string(),
        // One of the new slot for each 128 KiB, two of the old slot, two of the program.
        &(other.len().div_ceil(128 * 1024) + 4).to_string(),
    ));
    board.reset(ResetCause::Pin)?;
    board.run(board.now() + 100 * MS)?;
    let mut again = Updater::new(image(other)?);
    again.run(&mut board, |host| host.client.progress().0 > 0)?;
    rows.push(fact(
        CASE,
        "scene after another reset",
        again.scene(),
        "other",
    ));
    Ok(rows)
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
    let mut host = Updater::new(image(other)?);
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
    let ended = host.to_end(&mut board)?;
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
    let mut host = Updater::new(image(other)?);
    host.run(&mut board, |host| host.client.is_restarting())?;
    board.damage(NEW + 4096)?;
    let ended = host.to_end(&mut board)?;
    let text = format!("{}, {}", described(ended), host.scene());
    let bound = format!("Err(Reverted), {}", subject.scene.name);
    Ok(fact(
        CASE,
        "image that is damaged in the flash",
        text,
        &bound,
    ))
}

fn is_for_another_board(subject: &Subject, other: &[u8]) -> Result<[Row; 2]> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut foreign = other.to_vec();
    let label = foreign
        .windows(IMAGE_MARK.len())
        .position(|window| window == IMAGE_MARK)
        .context("the image has no label")?;
    // Behind mark, version and commit.
    foreign[label + 48] ^= 0x20;
    let mut host = Updater::new(image(&foreign)?);
    let ended = host.to_end(&mut board)?;
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
            "erasures and words by then",
            format!("{}, {}", flash.erasures, flash.words),
            "0, 0",
        ),
    ])
}
