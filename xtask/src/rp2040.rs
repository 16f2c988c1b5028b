//! `cargo xtask rp2040`: builds the firmware for the RP2040, checks that it can boot, that no interrupt
//! panics and that it holds what its scene uses and no binary64, prints its size and how deep its stack gets.

use crate::boards::RP2040_SCENE;
use crate::elf::Footprint;
use crate::image::Image;
use crate::repository::{SceneFile, scenes_named};
use crate::size::measure_firmware;
use anyhow::{Context, Result};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

pub(crate) fn run() -> Result<()> {
    let scenes = scenes_named(&[])?;
    let scene = scenes.iter().find(|scene| is_for(scene));
    let scene = scene.context(RP2040_SCENE)?;
    let read = Scene::read(&scene.path)?;
    let image = Image::rp2040(scene, of_scene(read.number));
    let (Footprint { flash, ram }, stack) = measure_firmware(&image, &read)?;
    println!(
        "{RP2040_SCENE} for the RP2040: {flash} bytes of flash, {ram} of RAM, {stack} of stack at most"
    );
    Ok(())
}

/// Returns true if `scene` is the one that this board's image is measured with.
pub(crate) fn is_for(scene: &SceneFile) -> bool {
    scene.path.ends_with(RP2040_SCENE)
}
