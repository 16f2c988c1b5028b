//! `cargo xtask bench`: executes the flashed images of the STM32F405 and of the STM32G474 with a model of the registers that they use, and
//! checks their pins.
//!
//! The bench is built with a feature that brings its CPU: Unicorn, a C library, which takes cmake and libclang to build.

use crate::boot;
use crate::image::Image;
use crate::packages::choose_host;
use crate::parallel;
use crate::repository::{self, SceneFile, cargo, target_directory};
use crate::symbols;
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use trirrr_scene::{DriveKind, Scene};

/// Board of the STM32G474 whose pins the bench knows.
const G474_BOARD: &str = "nucleo-g474re";

/// Scenes without names, before [`SWITCHED`], [`ACTUATORS`], [`UPDATED`] and [`ALONE`]: a laser on steppers with an emergency stop, a longer job, drives with encoders, drives on a bus, the same
/// on CAN FD, and the line alone, without drives.
const SCENES: [&str; 6] = [
    "inputs/guarded",
    "engraving",
    "bldc-massless",
    "plant-odrive",
    "plant-moteus",
    "chained",
];

/// A scene whose job switches spare outputs.
const SWITCHED: &str = "tests/mcu-bench/scenes/switched.toml";

/// A scene that its board plays without a host.
pub(crate) const ALONE: &str = "tests/mcu-bench/scenes/alone.toml";

/// Drives that know the angles of their joints, whatever happens to their supply.
const ACTUATORS: &str = "tests/mcu-bench/scenes/actuators.toml";

/// An image that is replaced over the line, and the one that takes its place.
pub(crate) const UPDATED: [&str; 2] = [
    "tests/mcu-bench/scenes/updated.toml",
    "tests/mcu-bench/scenes/other.toml",
];

/// Scene whose images have their line over USB, on both chips, and the cases that look at that.
const USB_SCENE: &str = "inputs/guarded";
const USB_CASES: [&str; 9] = [
    "power-up",
    "crystal",
    "job",
    "cable",
    "enumeration",
    "bus-reset",
    "suspend",
    "reader",
    "transfer",
];

/// Number type of the images: the bench talks to them in it.
const SCALAR: &str = "f32";

/// Feature of the bench that brings its CPU.
pub(crate) const EMULATOR: &str = "trirrr-mcu-bench/emulator";

#[derive(Args)]
pub(crate) struct BenchArgs {
    /// Scenes, by name or file; without, a choice of those that are shipped
    scenes: Vec<String>,
    /// Images for the STM32G474, whatever board the scene names
    #[arg(long)]
    g474: bool,
    /// Images with their line over USB, whatever port the board file names
    #[arg(long, requires = "scenes")]
    usb: bool,
    /// Case to run, all without; repeat for more
    #[arg(long)]
    case: Vec<String>,
    /// File for the edges of the job of one scene, as Value Change Dump
    #[arg(long)]
    vcd: Option<PathBuf>,
}

pub(crate) fn run(arguments: &BenchArgs) -> Result<()> {
    let names = match arguments.scenes.as_slice() {
        [] => {
            let files =
                [SWITCHED, ACTUATORS, UPDATED[0], ALONE].map(|file| repository::root().join(file));
            let files = files.map(|file| file.display().to_string());
            SCENES.map(str::to_owned).into_iter().chain(files).collect()
        }
        some => some.to_vec(),
    };
    let scenes = repository::scenes_named(&names)?;
    ensure!(
        arguments.vcd.is_none() || scenes.len() == 1,
        "--vcd: one scene at a time, for there is one file"
    );
    let bench = build()?;
    // One image runs on one processor.
    let printed = Mutex::new(());
    parallel::map(parallel::workers(), &scenes, |scene| {
        check(arguments, &bench, scene, &printed).with_context(|| scene.name.clone())
    })?;
    if arguments.scenes.is_empty() && arguments.case.is_empty() {
        for g474 in [false, true] {
            let arguments = BenchArgs {
                scenes: vec![USB_SCENE.to_owned()],
                g474,
                usb: true,
                case: USB_CASES.map(str::to_owned).into(),
                vcd: None,
            };
            run(&arguments)?;
        }
    }
    Ok(())
}

/// Adds to `cargo` the choice of the bench with its CPU, beside every package that is for a host: it uses the libraries that they
/// have compiled.
pub(crate) fn choose_bench(cargo: &mut Command) {
    choose_host(cargo);
    cargo
        .args(["--features", EMULATOR])
        .args(["--bin", "trirrr-mcu-bench"]);
}

/// Builds the bench; its program.
fn build() -> Result<PathBuf> {
    let mut cargo = cargo();
    cargo.args(["build", "--quiet"]);
    choose_bench(&mut cargo);
    let status = cargo.status().context("cargo cannot be run")?;
    ensure!(
        status.success(),
        "the bench does not build; besides Rust it needs the Debian packages cmake and libclang-dev"
    );
    Ok(target_directory().join("debug/trirrr-mcu-bench"))
}

/// Runs the cases on the images of a scene.
fn check(
    arguments: &BenchArgs,
    bench: &Path,
    scene: &SceneFile,
    printed: &Mutex<()>,
) -> Result<()> {
    let board = Scene::read(&scene.path)?.board;
    let is_for_g474 = arguments.g474 || board.as_deref() == Some(G474_BOARD);
    let image = match is_for_g474 {
        true => Image::g474(scene, SCALAR),
        false => Image::firmware(scene, SCALAR),
    };
    let mut command = Command::new(bench);
    // An image with another line is another file.
    let line = if arguments.usb { "-usb" } else { "" };
    if arguments.usb {
        command.arg("--usb");
    }
    if is_for_g474 {
        command.args(["--chip", "stm32g474"]);
    }
    let built = image.build_as(line, |cargo| {
        if arguments.usb {
            cargo.env("LINE", "usb");
        }
    })?;
    if arguments.usb {
        symbols::check_mark(&built, symbols::USB_LINE)?;
    }
    command.arg(&scene.path).arg(built);
    // Over USB it has panicked before a host finds it.
    if has_steppers(scene)? && !arguments.usb {
        let panicking = image.build_as("-panic", |cargo| {
            cargo
                .args(["--features", "fault-injection"])
                .env("FAULT", "panic");
        })?;
        command.arg("--panicking").arg(panicking);
    }
    if Scene::read(&scene.path)?.service.update {
        let other = repository::root().join(UPDATED[1]).display().to_string();
        for other in repository::scenes_named(&[other])? {
            let other = match is_for_g474 {
                true => Image::g474(&other, SCALAR),
                false => Image::firmware(&other, SCALAR),
            };
            command.arg("--other").arg(other.build()?);
        }
        command.arg("--boot").arg(boot::build_for(&image)?);
    }
    for case in &arguments.case {
        command.args(["--case", case]);
    }
    if let Some(file) = &arguments.vcd {
        command.arg("--vcd").arg(env::current_dir()?.join(file));
    }
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .context("the bench cannot be run")?;
    // Tables of scenes that run at the same time stand one below the other.
    let _turn = printed.lock().expect("no worker panics");
    print!("{}", String::from_utf8_lossy(&output.stdout));
    ensure!(output.status.success(), "the bench has failed");
    Ok(())
}

fn has_steppers(scene: &SceneFile) -> Result<bool> {
    let drives = Scene::read(&scene.path)?.drives;
    Ok(drives.is_some_and(|[first, ..]| matches!(first.kind, DriveKind::Stepper(_))))
}
