//! The programs of this repository that chores run.

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
    /// Builds them in one go: one by one, they ask for different features of what they share, which
    /// would be compiled twice.
    pub(crate) fn build() -> Result<Self> {
        let status = Self::builder().status().context("cargo cannot be run")?;
        ensure!(status.success(), "the host programs do not build");
        Ok(Self::built())
    }

    /// Cargo, to build them.
    pub(crate) fn builder() -> Command {
        let mut cargo = cargo();
        cargo.args(["build", "--quiet", "--release"]).args([
            "-p",
            "trirrr-host-sim",
            "-p",
            "trirrr-board-tests",
        ]);
        cargo
    }

    /// Where they are once they are built.
    pub(crate) fn built() -> Self {
        let release = target_directory().join("release");
        Self {
            trirrr: release.join("trirrr"),
            board_test: release.join("board-test"),
        }
    }
}
