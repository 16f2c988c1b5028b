//! The programs of this repository that chores run.

use crate::packages::choose_host;
use crate::repository::{cargo, target_directory};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Host programs, built.
pub(crate) struct Programs {
    pub(crate) trirrr: PathBuf,
    pub(crate) board_test: PathBuf,
}

impl Programs {
    /// Builds them.
    pub(crate) fn build() -> Result<Self> {
        let status = Self::builder().status().context("cargo cannot be run")?;
        ensure!(status.success(), "the host programs do not build");
        Ok(Self::built())
    }

    /// Cargo, to build them: in the profile and with the features of the tests, which compile the same libraries.
    pub(crate) fn builder() -> Command {
        let mut cargo = cargo();
        cargo.args(["build", "--quiet"]);
        choose_host(&mut cargo);
        cargo.args(["--bins", "--examples"]);
        cargo
    }

    /// Returns the paths of the programs once they are built.
    pub(crate) fn built() -> Self {
        let built = target_directory().join("debug");
        Self {
            trirrr: built.join("trirrr"),
            board_test: built.join("board-test"),
        }
    }
}

/// Runs `command`, a part of a chore that people know as `what`.
///
/// # Errors
/// It cannot be started, or says that it has failed.
pub(crate) fn succeed(command: &mut Command, what: &str) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("{what} cannot be started: {command:?}"))?;
    ensure!(status.success(), "{what} failed: {status}");
    Ok(())
}

/// Python of the virtual environment in `folder`, which is made if it is missing.
///
/// # Errors
/// It cannot be made.
pub(crate) fn python_in(folder: &Path) -> Result<PathBuf> {
    let python = folder.join("bin/python");
    if !python.exists() {
        let mut venv = Command::new("python3");
        venv.args(["-m", "venv"]).arg(folder);
        succeed(
            &mut venv,
            &format!("a virtual environment in {}", folder.display()),
        )?;
    }
    Ok(python)
}
