//! `cargo xtask senders`: programs that send G-code, as their users have them, against `trirrr grbl`.

use crate::programs::Programs;
use crate::repository::{root, target_directory};
use anyhow::{Context, Result, ensure};
use std::process::Command;

/// Version of bCNC that the driver was written for.
const BCNC: &str = "bCNC==0.9.16";

pub(crate) fn run() -> Result<()> {
    let trirrr = Programs::build()?.trirrr;
    let folder = target_directory().join("senders");
    let python = folder.join("bin/python");
    if !python.exists() {
        let mut venv = Command::new("python3");
        succeed(venv.args(["-m", "venv"]).arg(&folder), "a place for bCNC")?;
    }
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", BCNC]);
    succeed(&mut install, "the installation of bCNC")?;
    let mut driver = Command::new(&python);
    driver.arg(root().join("tests/senders/bcnc.py")).arg(trirrr);
    succeed(&mut driver, "bCNC")
}

fn succeed(command: &mut Command, what: &str) -> Result<()> {
    let status = command.status().with_context(|| format!("{command:?}"))?;
    ensure!(status.success(), "{what} failed: {status}");
    Ok(())
}
