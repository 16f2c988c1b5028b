//! `cargo xtask senders`: programs that send G-code, as their users have them, against `trirrr grbl`.

use crate::parallel;
use crate::programs::{Programs, python_in, succeed};
use crate::repository::{root, target_directory};
use anyhow::{Context, Result};
use std::path::Path;
use std::process::Command;

/// Version of bCNC that the driver was written for.
const BCNC: &str = "bCNC==0.9.16";

/// Version of cncjs that the driver was written for.
const CNCJS: &str = "cncjs@1.11.5";

/// Installs a sender into a folder, and drives it against the program.
type SenderDriver = fn(&Path, &Path) -> Result<()>;

pub(crate) fn run() -> Result<()> {
    let trirrr = Programs::build()?.trirrr;
    let folder = target_directory().join("senders");
    // Both at a time: installing waits for a network, driving for motions.
    let senders: [(&str, SenderDriver); 2] = [("bcnc", bcnc), ("cncjs", cncjs)];
    parallel::map(senders.len(), &senders, |(name, drive)| {
        drive(&folder.join(name), &trirrr)
    })?;
    Ok(())
}

fn bcnc(folder: &Path, trirrr: &Path) -> Result<()> {
    let python = python_in(folder)?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", BCNC]);
    succeed(&mut install, "the installation of bCNC")?;
    let mut driver = Command::new(&python);
    driver.arg(root().join("tests/senders/bcnc.py")).arg(trirrr);
    succeed(&mut driver, "bCNC")
}

fn cncjs(folder: &Path, trirrr: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut install = Command::new("npm");
    install.args(["install", "--silent", "--no-audit", "--no-fund"]);
    install.arg("--prefix");
    install.arg(folder).arg(CNCJS);
    succeed(&mut install, "the installation of cncjs")?;
    let mut driver = Command::new("node");
    driver.arg(root().join("tests/senders/cncjs.js"));
    succeed(driver.arg(folder).arg(trirrr), "cncjs")
}
