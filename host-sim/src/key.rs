//! `trirrr key`: a new key in a file.

use crate::failure::CliError;
use crate::terminal::print;
use clap::Args;
use std::path::PathBuf;
use trirrr_line::{KeyError, SharedKey};

/// `trirrr key`.
///
/// Draws a key at random and writes it into a new file that only its owner can read: 64 hexadecimal digits. Both ends of a line
/// need a copy: `trirrr device` and `trirrr bridge` with --key, and whoever connects to them, too.
#[derive(Args, Clone, Debug)]
pub struct KeyArgs {
    /// The file; one that exists is not overwritten
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Writes the key.
///
/// # Errors
/// Refused: the file exists. Failed: it cannot be written, or the system has no random numbers.
pub fn command(args: &KeyArgs) -> Result<(), CliError> {
    let key = SharedKey::random()
        .map_err(|error| CliError::Failed(format!("no key can be drawn: {error}")))?;
    key.write_new(&args.file).map_err(|error| match error {
        KeyError::Exists(_) => CliError::Refused(error.to_string()),
        _ => CliError::Failed(error.to_string()),
    })?;
    let file = args.file.display();
    print(&format!(
        "{file}: a new key; copy it to the other end by a way that nobody reads\n"
    ))
}
