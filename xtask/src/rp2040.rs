//! `cargo xtask rp2040`: builds the firmware for the RP2040, checks that it can boot, prints its size.

use crate::elf::{Footprint, Memory, check_boot, check_second_stage, footprint};
use crate::image::Image;
use crate::repository::scenes_named;
use anyhow::{Result, bail};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// The target of the firmware for the RP2040.
pub(crate) const TARGET: &str = "thumbv6m-none-eabi";

/// The scene that is made for a core like this.
pub(crate) const SCENE: &str = "pick-stepper";

/// As in its `memory.x`; the boot ROM goes to the vector table behind the second stage.
const MEMORY: Memory = Memory {
    vectors: 0x1000_0100,
    flash: (0x1000_0000, 2 * 1024 * 1024),
    ram: (0x2000_0000, 256 * 1024),
};

pub(crate) fn run() -> Result<()> {
    let scenes = scenes_named(&[SCENE.into()])?;
    let [scene] = scenes.as_slice() else {
        bail!("no scene {SCENE}");
    };
    let read = Scene::read(&scene.path)?;
    let image = Image {
        package: "trirrr-firmware",
        binary: "trirrr-firmware",
        scene,
        scalar: of_scene(read.number),
        target: TARGET,
    };
    let file = image.build()?;
    check_second_stage(&file, MEMORY.flash.0)?;
    check_boot(&file, MEMORY)?;
    let Footprint { flash, ram } = footprint(&file)?;
    println!("{SCENE} for the RP2040: {flash} bytes of flash, {ram} of RAM");
    Ok(())
}
