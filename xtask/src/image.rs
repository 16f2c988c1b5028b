//! Builds images for microcontrollers, one per scene, number type and target.

use crate::repository::{SceneFile, cargo, target_directory};
use crate::rp2040;
use crate::size::FIRMWARE_TARGET;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use trirrr_image::generate::{SCALARS, of_scene};
use trirrr_scene::{NumberType, Scene};

/// The Cargo profile of every image.
const PROFILE: &str = "device";

/// The number types that a scene is measured in: its own. One that is for hosts says none for a
/// board and is there to compare them: it is measured in all.
pub(crate) fn scalars(scene: &Scene) -> Vec<&'static str> {
    match scene.number {
        NumberType::F64 => SCALARS.iter().map(|(name, _)| *name).collect(),
        number => vec![of_scene(number)],
    }
}

/// What to build.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<'a> {
    /// Package and binary.
    pub(crate) package: &'static str,
    pub(crate) binary: &'static str,
    /// The scene that is built in.
    pub(crate) scene: &'a SceneFile,
    /// The number type.
    pub(crate) scalar: &'static str,
    /// The Rust target.
    pub(crate) target: &'static str,
}

impl<'a> Image<'a> {
    /// The image of the STM32F405 that is flashed.
    pub(crate) fn firmware(scene: &'a SceneFile, scalar: &'static str) -> Self {
        Self {
            package: "trirrr-stm32f405",
            binary: "trirrr-firmware",
            scene,
            scalar,
            target: FIRMWARE_TARGET,
        }
    }

    /// The image of the RP2040 that is flashed.
    pub(crate) fn rp2040(scene: &'a SceneFile, scalar: &'static str) -> Self {
        Self {
            package: "trirrr-rp2040",
            binary: "trirrr-firmware-rp2040",
            scene,
            scalar,
            target: rp2040::TARGET,
        }
    }

    /// Builds the image and copies it where the next one does not overwrite it.
    pub(crate) fn build(&self) -> Result<PathBuf> {
        self.build_as("", |_| {})
    }

    /// As [`Image::build`], with `suffix` behind its name and Cargo called as `configure` says.
    pub(crate) fn build_as(
        &self,
        suffix: &str,
        configure: impl FnOnce(&mut Command),
    ) -> Result<PathBuf> {
        let Image {
            package,
            binary,
            scene,
            scalar,
            target,
        } = *self;
        let name = format!("{binary}-{}-{scalar}-{target}{suffix}", scene.name);
        eprintln!("building {name}");
        let mut cargo = cargo();
        cargo
            .args(["build", "--quiet", "--package", package, "--bin", binary])
            .args(["--profile", PROFILE, "--target", target])
            .env("SCENE", &scene.path)
            .env("TRIRRR_SCALAR", scalar)
            // The repository's own flags for the target are to hold, whatever is set outside.
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS");
        configure(&mut cargo);
        let status = cargo.status().context("cargo cannot be run")?;
        ensure!(status.success(), "{name} does not build");

        let built = target_directory().join(target).join(PROFILE).join(binary);
        let directory = target_directory().join("images");
        fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
        let kept = directory.join(name);
        fs::copy(&built, &kept).with_context(|| built.display().to_string())?;
        Ok(kept)
    }
}
