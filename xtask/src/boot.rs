//! `cargo xtask boot`: builds the boot loader of the STM32F405, checks that it can boot, and prints its size.

use crate::boards::{FIRMWARE_MEMORY, FIRMWARE_TARGET};
use crate::elf::{Footprint, check_boot, footprint, with_elf};
use crate::image::PROFILE;
use crate::repository::{cargo, target_directory};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;

pub(crate) fn run() -> Result<()> {
    let file = build()?;
    let Footprint { flash, ram } = with_elf(&file, |elf| {
        check_boot(elf, FIRMWARE_MEMORY)?;
        Ok(footprint(elf))
    })?;
    println!("boot loader of the STM32F405: {flash} of 16384 bytes of flash, {ram} of RAM");
    Ok(())
}

/// Builds the boot loader; its image. Alone: beside a board's package it would have the vectors of that.
pub(crate) fn build() -> Result<PathBuf> {
    let status = cargo()
        .args(["build", "--quiet", "-p", "trirrr-boot"])
        .args(["--target", FIRMWARE_TARGET, "--profile", PROFILE])
        .status()
        .context("cargo cannot be run")?;
    ensure!(status.success(), "the boot loader does not build");
    let folder = target_directory().join(FIRMWARE_TARGET).join(PROFILE);
    Ok(folder.join("trirrr-boot"))
}
