//! `cargo xtask rp2040` and `cargo xtask g474`: build the firmware for another board than the STM32F405, check that it can boot, that no
//! interrupt panics and that it holds what its scene uses and no binary64, print its size and how deep its stack gets.

use crate::boards::{G474_SCENE, RP2040_SCENE};
use crate::elf::Footprint;
use crate::image::Image;
use crate::repository::{SceneFile, scenes_named};
use crate::size::measure_firmware;
use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::path::Path;
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// Returns the scene, too.
pub(crate) fn rp2040() -> Result<(SceneFile, Scene)> {
    measure("the RP2040", RP2040_SCENE, |scene, scalar| {
        Image::rp2040(scene, scalar)
    })
}

pub(crate) fn g474() -> Result<()> {
    measure("the STM32G474", G474_SCENE, |scene, scalar| {
        Image::g474(scene, scalar)
    })?;
    Ok(())
}

fn measure(
    board: &str,
    file: &'static str,
    image: for<'a> fn(&'a SceneFile, &'static str) -> Image<'a>,
) -> Result<(SceneFile, Scene)> {
    let name = Path::new(file).file_stem().and_then(OsStr::to_str);
    let mut scenes = scenes_named(&[name.context(file)?.to_owned()])?;
    let scene = scenes.pop().context(file)?;
    let read = Scene::read(&scene.path)?;
    let image = image(&scene, of_scene(read.number));
    let (Footprint { flash, ram }, stack) = measure_firmware(&image, &read)?;
    println!("{file} for {board}: {flash} bytes of flash, {ram} of RAM, {stack} of stack at most");
    Ok((scene, read))
}
