//! The programs of this repository that chores run.

use crate::packages::choose_host;
use crate::repository::{cargo, target_directory};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;
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
