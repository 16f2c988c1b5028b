//! `cargo xtask rp2040`: builds the firmware for the RP2040, checks that it can boot, that no interrupt
//! panics and that it holds what its scene uses and no binary64, prints its size and how deep its stack gets.

use crate::callgraph::{self, Stack};
use crate::elf::{Footprint, Memory, check_boot, check_second_stage, footprint};
use crate::image::Image;
use crate::repository::{SceneFile, scenes_named};
use crate::symbols;
use anyhow::{Context, Result};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// The scene that is made for a core like this.
pub(crate) const SCENE: &str = "scenes/pick-stepper.toml";

/// The target of the firmware for the RP2040.
pub(crate) const TARGET: &str = "thumbv6m-none-eabi";

/// As in its linker script, `rp2040.x`; the boot ROM goes to the vector table behind the second stage.
const MEMORY: Memory = Memory {
    vectors: 0x1000_0100,
    flash: (0x1000_0000, 2 * 1024 * 1024),
    ram: (0x2000_0000, 256 * 1024),
};

pub(crate) fn run() -> Result<()> {
    let scenes = scenes_named(&[])?;
    let scene = scenes.iter().find(|scene| is_for(scene));
    let (Footprint { flash, ram }, stack) = measure(scene.context(SCENE)?)?;
    println!(
        "{SCENE} for the RP2040: {flash} bytes of flash, {ram} of RAM, {stack} of stack at most"
    );
    Ok(())
}

/// Whether `scene` is the one that this board's image is measured with.
pub(crate) fn is_for(scene: &SceneFile) -> bool {
    scene.path.ends_with(SCENE)
}

/// Builds and checks the image of `scene`: its footprint, and the most that its stack takes.
pub(crate) fn measure(scene: &SceneFile) -> Result<(Footprint, u32)> {
    let read = Scene::read(&scene.path)?;
    let file = Image::rp2040(scene, of_scene(read.number)).build()?;
    check_second_stage(&file, MEMORY.flash.0)?;
    check_boot(&file, MEMORY)?;
    symbols::check(&file, &read)?;
    symbols::check_arithmetic(&file, false)?;
    let Stack { most, .. } = callgraph::check(&file)?;
    Ok((footprint(&file)?, most))
}
