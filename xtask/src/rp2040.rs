//! `cargo xtask rp2040`: builds the firmware for the RP2040, checks that it can boot, that no interrupt
//! panics and that it holds what its scene uses and no binary64, prints its size and how deep its stack gets.
//!
//! It is a workspace of its own, with a folder of its own for what is built.

use crate::callgraph::{self, Stack};
use crate::elf::{Footprint, Memory, check_boot, check_second_stage, footprint};
use crate::repository::{SceneFile, cargo, root, target_directory};
use crate::symbols;
use anyhow::{Context, Result, ensure};
use std::process::Command;
use trirrr_scene::Scene;

/// The scene that is made for a core like this.
const SCENE: &str = "scenes/pick-stepper.toml";

/// The target of the firmware for the RP2040.
pub(crate) const TARGET: &str = "thumbv6m-none-eabi";

/// As in its `memory.x`; the boot ROM goes to the vector table behind the second stage.
const MEMORY: Memory = Memory {
    vectors: 0x1000_0100,
    flash: (0x1000_0000, 2 * 1024 * 1024),
    ram: (0x2000_0000, 256 * 1024),
};

pub(crate) fn run() -> Result<()> {
    let (Footprint { flash, ram }, stack) = measure()?;
    println!(
        "{SCENE} for the RP2040: {flash} bytes of flash, {ram} of RAM, {stack} of stack at most"
    );
    Ok(())
}

/// Whether `scene` is the one that this board's image is measured with.
pub(crate) fn is_for(scene: &SceneFile) -> bool {
    scene.path.ends_with(SCENE)
}

/// Builds and checks the image: its footprint, and the most that its stack takes.
pub(crate) fn measure() -> Result<(Footprint, u32)> {
    eprintln!("building the firmware for the RP2040 with {SCENE}");
    let mut build = on_package("build");
    build.args(["--profile", "device"]);
    let status = build.status().context("cargo cannot be run")?;
    ensure!(status.success(), "{SCENE} for the RP2040 does not build");
    let file = target_directory()
        .join("rp2040")
        .join(TARGET)
        .join("device/trirrr-firmware");
    check_second_stage(&file, MEMORY.flash.0)?;
    check_boot(&file, MEMORY)?;
    symbols::check(&file, &Scene::read(root().join(SCENE))?)?;
    symbols::check_arithmetic(&file, false)?;
    let Stack { most, .. } = callgraph::check(&file)?;
    Ok((footprint(&file)?, most))
}

/// Cargo's `command` about the firmware of the RP2040, in quiet.
pub(crate) fn on_package(command: &str) -> Command {
    let mut cargo = cargo();
    cargo
        .args([command, "--quiet", "--target", TARGET])
        .args(["--manifest-path", "firmware/rp2040/Cargo.toml"])
        .arg("--target-dir")
        .arg(target_directory().join("rp2040"))
        .env("SCENE", SCENE)
        // The scene's own number type, and the repository's own flags.
        .env_remove("TRIRRR_SCALAR")
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    cargo
}
