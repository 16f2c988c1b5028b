//! The program, as tests of its commands run it.

use std::process::Command;
use tempfile::TempDir;

/// `trirrr` with `arguments` in `folder`, not started yet.
pub(crate) fn command(folder: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"));
    command.args(arguments).current_dir(folder.path());
    command
}
