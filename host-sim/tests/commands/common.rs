//! The program, as tests of its commands run it.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// `trirrr` with `arguments` in `folder`, not started yet.
pub(crate) fn command(folder: impl AsRef<Path>, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"));
    command.args(arguments).current_dir(folder);
    command
}

/// Runs `trirrr` with `arguments` in `folder` to its end.
pub(crate) fn trirrr(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Value that a run which succeeded has printed.
pub(crate) fn json(output: &Output) -> Value {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    serde_json::from_slice(&output.stdout).unwrap()
}
