//! `cargo xtask boot`: builds the boot loaders of the STM32F405 and of the STM32G474, checks that they can boot, and prints their sizes.

use crate::boards::FIRMWARE_TARGET;
use crate::elf::{Footprint, Memory, check_boot, footprint, with_elf};
use crate::image::{Image, PROFILE};
use crate::packages::{DevicePackage, STM32F405, STM32G474};
use crate::repository::{cargo, target_directory};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;

/// Bytes that a boot loader has, in front of its layout's slots.
const ROOM: u64 = 16 * 1024;

/// Boot loader: chip, program, and the package of the images that it starts.
const LOADERS: [(&str, &str, DevicePackage); 2] = [
    ("STM32F405", "trirrr-boot", STM32F405),
    ("STM32G474", "trirrr-boot-g474", STM32G474),
];

pub(crate) fn run() -> Result<()> {
    build_loaders()?;
    for (chip, program, package) in LOADERS {
        let memory = package.memory();
        let memory = Memory {
            flash: (memory.flash.0, ROOM),
            ..memory
        };
        let Footprint { flash, ram } = with_elf(&built(program), |elf| {
            check_boot(elf, memory)?;
            Ok(footprint(elf))
        })?;
        println!("boot loader of the {chip}: {flash} of {ROOM} bytes of flash, {ram} of RAM");
    }
    Ok(())
}

/// Builds the boot loaders; the image of the one that starts this `image`.
pub(crate) fn build_for(image: &Image) -> Result<PathBuf> {
    build_loaders()?;
    let of = LOADERS
        .iter()
        .find(|(_, _, package)| *package == image.package);
    let (_, program, _) =
        of.with_context(|| format!("{}: no boot loader", image.package.title()))?;
    Ok(built(program))
}

/// Alone: beside a board's package they would have the vectors of that.
fn build_loaders() -> Result<()> {
    let status = cargo()
        .args(["build", "--quiet", "-p", "trirrr-boot"])
        .args(["--target", FIRMWARE_TARGET, "--profile", PROFILE])
        .status()
        .context("cargo cannot be run")?;
    ensure!(status.success(), "the boot loaders do not build");
    Ok(())
}

fn built(program: &str) -> PathBuf {
    let folder = target_directory().join(FIRMWARE_TARGET).join(PROFILE);
    folder.join(program)
}
