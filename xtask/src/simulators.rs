//! `cargo xtask simulators`: simulators of other authors load what `trirrr export` writes, and find the torques of `trirrr run`.

use crate::programs::{Programs, python_in, succeed};
use crate::repository::{root, target_directory};
use anyhow::Result;
use std::process::Command;

/// Versions that the comparison was written for.
const SIMULATORS: [&str; 2] = ["mujoco==4.0.0", "pin==4.1.0"];

pub(crate) fn run() -> Result<()> {
    let trirrr = Programs::build()?.trirrr;
    let python = python_in(&target_directory().join("simulators"))?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet"]);
    succeed(install.args(SIMULATORS), "their installation")?;
    let mut compare = Command::new(&python);
    compare
        .arg(root().join("tests/simulators/compare.py"))
        .args([&trirrr, &root().join("scenes")]);
    succeed(&mut compare, "the comparison")
}
