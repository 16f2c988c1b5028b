//! The programs of this repository that chores run.

use crate::repository::{cargo, target_directory};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;

/// Host programs, built.
pub(crate) struct Programs {
    pub(crate) host_sim: PathBuf,
    pub(crate) board_test: PathBuf,
}

impl Programs {
    /// Builds them in one go: one by one, they ask for different features of what they share, which
    /// would be compiled twice.
    pub(crate) fn build() -> Result<Self> {
        let status = cargo()
            .args(["build", "--quiet", "--release"])
            .args(["-p", "trirrr-host-sim", "-p", "trirrr-board-tests"])
            .status()
            .context("cargo cannot be run")?;
        ensure!(status.success(), "the host programs do not build");
        let release = target_directory().join("release");
        Ok(Self {
            host_sim: release.join("host-sim"),
            board_test: release.join("board-test"),
        })
    }
}
