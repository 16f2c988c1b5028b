//! The log of a board in words.

use anyhow::{Context, Result, bail, ensure};
use defmt_decoder::{DecodeError, Table};
use std::fs;
use std::path::Path;

/// Prints every message in `log`, what came out of the log's serial port, in the words of the image
/// `elf`.
///
/// # Errors
/// The image has no words, `log` has none of them, or something that is no message.
pub(crate) fn print(elf: &Path, log: &Path) -> Result<()> {
    let image = fs::read(elf).with_context(|| elf.display().to_string())?;
    let table = Table::parse(&image)
        .with_context(|| elf.display().to_string())?
        .with_context(|| format!("{}: an image without a log", elf.display()))?;
    let bytes = fs::read(log).with_context(|| log.display().to_string())?;
    let mut decoder = table.new_stream_decoder();
    decoder.received(&bytes);
    let mut messages = 0;
    loop {
        match decoder.decode() {
            Ok(frame) => {
                messages += 1;
                println!("{}", frame.display(false));
            }
            Err(DecodeError::UnexpectedEof) => break,
            Err(DecodeError::Malformed) => {
                bail!("{}: after {messages} messages, none", log.display())
            }
        }
    }
    ensure!(messages > 0, "{}: no message", log.display());
    Ok(())
}
