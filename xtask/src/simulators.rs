//! `cargo xtask simulators`: simulators of other authors load what `trirrr export` writes, and find the torques of `trirrr run`.

use crate::programs::Programs;
use crate::repository::{root, target_directory};
use anyhow::{Context, Result, ensure};
use std::process::Command;

/// Versions that the comparison was written for.
const SIMULATORS: [&str; 2] = ["mujoco==4.0.0", "pin==4.1.0"];

pub(crate) fn run() -> Result<()> {
    let trirrr = Programs::build()?.trirrr;
    let folder = target_directory().join("simulators");
    let python = folder.join("bin/python");
    if !python.exists() {
        let mut venv = Command::new("python3");
        succeed(venv.args(["-m", "venv"]).arg(&folder), "a place for them")?;
    }
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet"]);
    succeed(install.args(SIMULATORS), "their installation")?;
    let mut compare = Command::new(&python);
    compare
        .arg(root().join("tests/simulators/compare.py"))
        .args([&trirrr, &root().join("scenes")]);
    succeed(&mut compare, "the comparison")
}

fn succeed(command: &mut Command, what: &str) -> Result<()> {
    let status = command.status().with_context(|| format!("{command:?}"))?;
    ensure!(status.success(), "{what} failed: {status}");
    Ok(())
}
