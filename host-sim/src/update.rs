//! `trirrr update`: replaces the program of a board over its line.

use crate::dialogue::carry;
use crate::failure::CliError;
use crate::stream::{PortArgs, conversation, patience};
use crate::terminal::{bar, print};
use clap::Args;
use indicatif::ProgressBar;
use object::Endianness;
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_client::{Dialogue, ProgramImage, Turn, UpdateClient, UpdateFailure, describe};
use trirrr_line::Retry;
use trirrr_protocol::message::{Identity, Message};
use trirrr_scene::read::files;

/// Time without the port, or without an answer, after which the command gives up.
pub(crate) const PATIENCE: Duration = Duration::from_secs(10);

/// Most bytes of an image: more is no file for a microcontroller.
const LARGEST: u32 = 16 << 20;

/// `trirrr update`.
///
/// Replaces the program of a board over its line: by one of another version, or of another scene. The board tries it once, and keeps it if
/// this command can talk to it. Otherwise the board goes back to its program of before.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The image is built by `SCENE=... BOARD=... cargo fw` from a scene with `update = true` in [service]. The drives have to be off. A line that is \
lost, or Ctrl-C, leaves the old program; the same command goes on where the line was lost. See docs/board.md, Update.")]
pub struct UpdateArgs {
    /// Image of the new program, the ELF file that `cargo fw` builds
    pub image: PathBuf,
    /// The line to the board.
    #[command(flatten)]
    pub line: PortArgs,
}

/// Replaces the program.
///
/// # Errors
/// Refused: the image, or by the board. Failed: the port, or a new program that does not run.
pub fn command(args: &UpdateArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let image = read(&args.image)?;
    let header = *image.header();
    print(&format!(
        "image       {}, {} bytes\n",
        describe::board::firmware(&header.firmware),
        header.length
    ))?;
    // Nothing of this conversation depends on the number type of the machine.
    let client = UpdateClient::<f64>::new(image, patience(PATIENCE), conversation());
    let words = UpdateWords {
        waiting: "the board installs it",
        ended: "the board keeps its program",
    };
    bring(client, &args.line, &words, &|_| Ok(()), stop)
}

/// Words of an update for a person.
pub(crate) struct UpdateWords {
    /// While the board starts anew.
    pub(crate) waiting: &'static str,
    /// After Ctrl-C.
    pub(crate) ended: &'static str,
}

/// Lets `client` talk to the board to the end, and tells what runs then. `check` may refuse the board that has answered, before anything is
/// sent to it.
///
/// # Errors
/// Failed: the port, the client, or Ctrl-C. What `check` says.
pub(crate) fn bring(
    client: UpdateClient<f64>,
    line: &PortArgs,
    words: &UpdateWords,
    check: &dyn Fn(&Identity) -> Result<(), CliError>,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let mut port = line.open(Retry::For(PATIENCE))?;
    let mut update = ShownUpdate {
        bar: bar(
            client.progress().1.into(),
            "{wide_bar} {bytes}/{total_bytes} {msg}",
        ),
        client,
        words,
        check,
        is_told: false,
    };
    carry(&mut update, &mut port, stop)??;
    let identity = update.client.identity();
    let runs = identity.map_or_else(String::new, |identity| {
        format!(
            "{}; scene {}",
            describe::board::firmware(&identity.firmware),
            describe::board::name(&identity.name)
        )
    });
    print(&format!("runs        {runs}\n"))
}

/// Update under a bar.
struct ShownUpdate<'a> {
    client: UpdateClient<f64>,
    bar: ProgressBar,
    words: &'a UpdateWords,
    check: &'a dyn Fn(&Identity) -> Result<(), CliError>,
    /// The user was told of the board's program.
    is_told: bool,
}

impl ShownUpdate<'_> {
    /// Tells the user of the board that has answered, once.
    ///
    /// # Errors
    /// What the check says.
    fn meet(&mut self) -> Result<(), CliError> {
        let Some(identity) = self.client.identity().filter(|_| !self.is_told) else {
            return Ok(());
        };
        self.is_told = true;
        let firmware = describe::board::firmware(&identity.firmware);
        self.bar
            .suspend(|| print(&format!("board       {firmware}\n")))?;
        (self.check)(identity).inspect_err(|_| self.bar.abandon())
    }

    fn end(&self, result: Result<(), UpdateFailure<f64>>) -> Result<(), CliError> {
        if result == Err(UpdateFailure::Stopped) {
            self.bar.abandon();
            let ended = self.words.ended;
            return Err(CliError::Failed(format!("ended by Ctrl-C: {ended}")));
        }
        self.bar.finish_and_clear();
        result.map_err(|failure| CliError::Failed(failure.describe()))
    }
}

impl Dialogue<f64> for ShownUpdate<'_> {
    type End = Result<(), CliError>;

    fn poll(&mut self, now: Duration) -> Turn<f64, Self::End> {
        let turn = self.client.poll(now);
        turn.map(|result| self.end(result))
    }

    fn receive(&mut self, message: &Message<f64>, now: Duration) {
        self.client.receive(message, now);
    }

    fn attend(&mut self, _: Duration) -> Option<Self::End> {
        self.bar.set_position(self.client.progress().0.into());
        if self.client.is_restarting() {
            self.bar.set_message(self.words.waiting);
        }
        self.meet().err().map(Err)
    }

    fn stop(&mut self) {
        self.client.stop();
    }

    fn reconnected(&mut self) {
        self.client.reconnected();
    }
}

/// Reads the ELF file of an image.
///
/// # Errors
/// Refused: no such file, or no image that is replaced over the line.
fn read(file: &Path) -> Result<ProgramImage, CliError> {
    let refused = |why: &str| CliError::Refused(format!("{}: {why}", file.display()));
    let data = files::bytes_of(file, 2 * u64::from(LARGEST))
        .map_err(|error| refused(&error.to_string()))?;
    let (start, bytes) = content(&data).map_err(|why| refused(&why))?;
    ProgramImage::new(start, bytes).ok_or_else(|| {
        refused(
            "no image that is replaced over the line: build it by `cargo fw` from a scene with update = true in [service]",
        )
    })
}

/// First address of an image, and what lies in the flash from there on.
fn content(data: &[u8]) -> Result<(u32, Vec<u8>), String> {
    let elf = ElfFile32::<Endianness>::parse(data).map_err(|error| {
        format!("no ELF file of a 32-bit processor ({error}): give the one that `cargo fw` builds")
    })?;
    let endian = Endianness::Little;
    let mut parts = Vec::new();
    for header in elf.elf_program_headers() {
        if header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0 {
            let bytes = header
                .data(endian, data)
                .map_err(|()| "a segment is cut off".to_owned())?;
            parts.push((header.p_paddr(endian), bytes));
        }
    }
    parts.sort_unstable_by_key(|(at, _)| *at);
    let start = parts.first().map_or(0, |(at, _)| *at);
    let mut content = Vec::new();
    for (at, bytes) in parts {
        let gap = (at - start).checked_sub(content.len() as u32);
        let Some(gap) = gap.filter(|gap| *gap < LARGEST) else {
            return Err("its segments overlap, or lie too far apart for one flash".into());
        };
        // Between segments the flash stays erased.
        content.resize(content.len() + gap as usize, 0xFF);
        content.extend_from_slice(bytes);
    }
    Ok((start, content))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods)]

    use super::*;

    /// An ELF file of segments without sections.
    fn elf(segments: &[(u32, &[u8])]) -> Vec<u8> {
        let mut header = vec![0x7F, b'E', b'L', b'F', 1, 1, 1];
        header.resize(16, 0);
        let half = |value: u16| value.to_le_bytes();
        header.extend([half(2), half(40)].concat());
        header.extend(
            [1, 0x0802_0001_u32, 52, 0, 0]
                .map(u32::to_le_bytes)
                .concat(),
        );
        header.extend([52, 32, segments.len() as u16, 40, 0, 0].map(half).concat());
        let mut at = (52 + 32 * segments.len()) as u32;
        for (address, bytes) in segments {
            let length = bytes.len() as u32;
            let words = [PT_LOAD.0, at, *address, *address, length, length, 4, 4];
            header.extend(words.map(u32::to_le_bytes).concat());
            at += length;
        }
        segments.iter().for_each(|(_, bytes)| header.extend(*bytes));
        header
    }

    #[test]
    fn an_image_is_what_lies_in_the_flash() {
        // In any order, with a gap.
        let file = elf(&[(0x0802_0006, b"def"), (0x0802_0000, b"abcd")]);
        let expected = b"abcd\xFF\xFFdef".to_vec();
        assert_eq!(content(&file), Ok((0x0802_0000, expected)));
    }

    #[test]
    fn what_is_no_image_is_refused_with_what_to_do() {
        assert!(content(b"text").is_err_and(|why| why.contains("cargo fw")));
        let overlap = elf(&[(0x0802_0000, b"abcd"), (0x0802_0002, b"def")]);
        assert!(content(&overlap).is_err_and(|why| why.contains("overlap")));
        let folder = tempfile::tempdir().expect("a folder for a test");
        let file = folder.path().join("image.elf");
        std::fs::write(&file, elf(&[(0x0800_0000, b"abcd")])).expect("a file of a test");
        let refused = read(&file).expect_err("no label");
        assert_eq!(refused.exit_code(), 2);
        let text = refused.to_string();
        assert!(
            text.contains("image.elf") && text.contains("update = true"),
            "{text}"
        );
    }
}
