//! The program, as tests of its commands run it.

use std::path::Path;
use std::process::Command;

/// `trirrr` with `arguments` in `folder`, not started yet.
pub(crate) fn command(folder: impl AsRef<Path>, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"));
    command.args(arguments).current_dir(folder);
    command
}
