//! Builds images for microcontrollers, by scene, number type and target.

use crate::boards::{FIRMWARE_TARGET, RP2040_TARGET};
use crate::elf::Memory;
use crate::packages::{DevicePackage, RP2040, STM32F405, STM32G474};
use crate::repository::{SceneFile, cargo, target_directory};
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::{Duration, SystemTime};
use std::{env, fs};
use trirrr_image::generate::{SCALARS, of_scene};
use trirrr_scene::{NumberType, Scene};

/// The Cargo profile of every image.
pub(crate) const PROFILE: &str = "device";

/// The number types that a scene is measured in: its own. One that is for hosts says none for a
/// board and is there to compare them: it is measured in all.
pub(crate) fn scalars(scene: &Scene) -> Vec<&'static str> {
    match scene.number {
        NumberType::F64 => SCALARS.iter().map(|(name, _)| *name).collect(),
        number => vec![of_scene(number)],
    }
}

/// Variable of the environment: when a run of many chores began, in seconds since 1970. Its chores share images.
pub(crate) const RUN_BEGAN: &str = "TRIRRR_RUN_BEGAN";

/// Held from Cargo's start until its images are copied: the next build overwrites them.
static BUILDING: Mutex<()> = Mutex::new(());

/// Description of an image to build.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<'a> {
    /// Package with its chip, and binary.
    pub(crate) package: DevicePackage,
    pub(crate) binary: &'static str,
    /// The scene that is built in.
    pub(crate) scene: &'a SceneFile,
    /// The number type.
    pub(crate) scalar: &'static str,
    /// The Rust target.
    pub(crate) target: &'static str,
}

impl<'a> Image<'a> {
    /// A program that counts instructions or is measured itself.
    pub(crate) fn insns(
        binary: &'static str,
        scene: &'a SceneFile,
        scalar: &'static str,
        target: &'static str,
    ) -> Self {
        Self {
            package: DevicePackage::of("trirrr-insns", target),
            binary,
            scene,
            scalar,
            target,
        }
    }

    /// The image of the STM32F405 that is flashed.
    pub(crate) fn firmware(scene: &'a SceneFile, scalar: &'static str) -> Self {
        Self {
            package: STM32F405,
            binary: "trirrr-firmware",
            scene,
            scalar,
            target: FIRMWARE_TARGET,
        }
    }

    /// The image of the STM32G474 that is flashed.
    pub(crate) fn g474(scene: &'a SceneFile, scalar: &'static str) -> Self {
        Self {
            package: STM32G474,
            binary: "trirrr-firmware-g474",
            scene,
            scalar,
            target: FIRMWARE_TARGET,
        }
    }

    /// Memory of the board that the image is for.
    pub(crate) fn memory(&self) -> Memory {
        self.package.memory()
    }

    /// The image of the RP2040 that is flashed.
    pub(crate) fn rp2040(scene: &'a SceneFile, scalar: &'static str) -> Self {
        Self {
            package: RP2040,
            binary: "trirrr-firmware-rp2040",
            scene,
            scalar,
            target: RP2040_TARGET,
        }
    }

    /// Builds the image and copies it where the next one does not overwrite it.
    pub(crate) fn build(&self) -> Result<PathBuf> {
        self.build_as("", |_| {})
    }

    /// Builds the image for each of `targets`, as [`Image::build`]. One call of Cargo links them at the same
    /// time: a single image keeps one processor busy.
    pub(crate) fn build_for(&self, targets: &[&'static str]) -> Result<Vec<PathBuf>> {
        let of = |&target| Self { target, ..*self };
        let images: Vec<Self> = targets.iter().map(of).collect();
        build_together(&images, "", |_| {})
    }

    /// Builds the image and the one of `binary`, otherwise the same, in one call of Cargo.
    pub(crate) fn build_with(&self, binary: &'static str) -> Result<[PathBuf; 2]> {
        let images = [*self, Self { binary, ..*self }];
        let mut built = build_together(&images, "", |_| {})?.into_iter();
        match (built.next(), built.next()) {
            (Some(own), Some(other)) => Ok([own, other]),
            _ => bail!("cargo built less than two images"),
        }
    }

    /// As [`Image::build`], with `suffix` behind its name and Cargo called as `configure` says.
    pub(crate) fn build_as(
        &self,
        suffix: &str,
        configure: impl FnOnce(&mut Command),
    ) -> Result<PathBuf> {
        build_together(&[*self], suffix, configure)?
            .pop()
            .context("cargo built no image")
    }

    fn name(&self) -> String {
        let Self {
            binary,
            scene,
            scalar,
            target,
            ..
        } = self;
        format!("{binary}-{}-{scalar}-{target}", scene.name)
    }
}

/// Builds images that share package, scene and number type: each of their binaries for each of their targets.
fn build_together(
    images: &[Image],
    suffix: &str,
    configure: impl FnOnce(&mut Command),
) -> Result<Vec<PathBuf>> {
    let _building = BUILDING.lock().expect("no build panics");
    let first = images.first().context("an image to build")?;
    let mut cargo = cargo();
    cargo
        .args(["build", "--quiet", "--profile", PROFILE, "--package"])
        .arg(first.package.name)
        .args(first.package.features())
        .env("SCENE", &first.scene.path)
        .env("TRIRRR_SCALAR", first.scalar)
        // The repository's own flags for the target, and the scene's board with its line, are to hold, whatever is set outside.
        .env_remove("BOARD")
        .env_remove("LINE")
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    let chosen = |of: fn(&Image) -> &'static str| images.iter().map(of).collect::<BTreeSet<_>>();
    for binary in chosen(|image| image.binary) {
        cargo.args(["--bin", binary]);
    }
    for target in chosen(|image| image.target) {
        cargo.args(["--target", target]);
    }
    configure(&mut cargo);
    let names: Vec<String> = images.iter().map(|image| image.name() + suffix).collect();
    let directory = target_directory().join("images");
    let copies: Vec<PathBuf> = names.iter().map(|name| directory.join(name)).collect();
    if copies.iter().all(|copy| is_of_this_run(copy)) {
        return Ok(copies);
    }
    eprintln!("building {}", names.join(", "));
    let status = cargo.status().context("cargo cannot be run")?;
    ensure!(status.success(), "{} does not build", names.join(" or "));

    fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
    for (image, copy) in images.iter().zip(&copies) {
        let built = target_directory().join(image.target).join(PROFILE);
        let built = built.join(image.binary);
        // A board may be booting from an earlier copy: the new one takes its place in one step.
        let new = copy.with_extension("new");
        fs::copy(&built, &new).with_context(|| built.display().to_string())?;
        fs::rename(&new, copy).with_context(|| copy.display().to_string())?;
    }
    Ok(copies)
}

/// Returns true if `image` was built since a run of many chores began that says so in [`RUN_BEGAN`]: no source
/// changes during such a run.
fn is_of_this_run(image: &Path) -> bool {
    let began = env::var(RUN_BEGAN).ok().and_then(|text| text.parse().ok());
    let began = began.map(|seconds| SystemTime::UNIX_EPOCH + Duration::from_secs(seconds));
    let built = fs::metadata(image).and_then(|image| image.modified());
    matches!((began, built), (Some(began), Ok(built)) if built >= began)
}
