//! `cargo xtask rp2040 --run`: executes the image on rp2040js, a model of the chip from npm, plays the job of the scene there by `trirrr stream`,
//! and checks the pins (`tests/rp2040`).

use crate::image::Image;
use crate::other_boards;
use crate::programs::{Programs, succeed};
use crate::repository::{SceneFile, root, target_directory};
use crate::symbols;
use anyhow::{Context, Result, ensure};
use serde_json::json;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Command;
use trirrr_image::board::{BoardFile, Needs, Role};
use trirrr_image::generate::of_scene;
use trirrr_scene::{DriveKind, EnableLevel, Scene};

/// The model of the chip, with its version.
const MODEL: &str = "rp2040js@1.4.1";

/// Time by which an edge of a step pulse may be late, us: `docs/board.md`, times.
const LATE_US: f64 = 4.8;

#[derive(clap::Args)]
pub(crate) struct Rp2040Args {
    /// Execute the image on rp2040js, and check the pins
    #[arg(long)]
    run: bool,
    /// One case alone: power-up, job, hung-tick, free-run, panic, usb
    #[arg(long, requires = "run")]
    case: Option<String>,
}

pub(crate) fn run(arguments: &Rp2040Args) -> Result<()> {
    let (file, scene) = other_boards::rp2040()?;
    match arguments.run {
        true => execute(&file, &scene, arguments.case.as_deref()),
        false => Ok(()),
    }
}

/// Executes the image on the model of the chip.
fn execute(file: &SceneFile, scene: &Scene, case: Option<&str>) -> Result<()> {
    let image = Image::rp2040(file, of_scene(scene.number));
    let panicking = image.build_as("-panic", |cargo| {
        cargo
            .args(["--features", "fault-injection"])
            .env("FAULT", "panic");
    })?;
    let folder = target_directory().join("rp2040");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let mut install = Command::new("npm");
    install.args([
        "install",
        "--ignore-scripts",
        "--silent",
        "--no-audit",
        "--no-fund",
        "--prefix",
    ]);
    succeed(
        install.arg(&folder).arg(MODEL),
        "the installation of rp2040js",
    )?;
    let mut settings = settings(file, scene, [&image.build()?, &panicking])?;
    let over_usb = image.build_as("-usb", |cargo| {
        cargo.env("LINE", "usb");
    })?;
    symbols::check_mark(&over_usb, symbols::USB_LINE)?;
    settings["overUsb"] = json!(over_usb);
    let written = folder.join("settings.json");
    fs::write(&written, settings.to_string()).with_context(|| written.display().to_string())?;
    let mut bench = Command::new("node");
    bench.arg(root().join("tests/rp2040/bench.js"));
    succeed(
        bench.arg(&folder).arg(&written).args(case),
        "the image on the model of the RP2040",
    )
}

/// Pins of the board and figures of the scene, as the bench reads them.
fn settings(
    file: &SceneFile,
    scene: &Scene,
    [image, panicking]: [&Path; 2],
) -> Result<serde_json::Value> {
    let path = root().join("firmware/boards/files/pico.toml");
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let board = BoardFile::parse(&text, "pico.toml", None)?;
    let pins = |role: Role| -> Result<Vec<u32>> {
        let named = board.pins(role).with_context(|| format!("{role:?}"))?;
        let number = |name: &str| name.trim_start_matches("GP").parse();
        named
            .iter()
            .map(|pin| Ok(number(&pin.name)?))
            .collect::<Result<_>>()
    };
    let drives = scene.drives.as_ref().context("[[drive]] of the scene")?;
    let per_radian = drives
        .iter()
        .map(|drive| match &drive.kind {
            DriveKind::Stepper(motor) => {
                Ok(f64::from(motor.steps_per_rev * motor.microsteps) * drive.gear_ratio / TAU)
            }
            _ => anyhow::bail!("the drives are no steppers"),
        })
        .collect::<Result<Vec<f64>>>()?;
    let enable_high = drives.iter().all(|drive| {
        matches!(&drive.kind, DriveKind::Stepper(motor) if matches!(motor.enable, EnableLevel::High))
    });
    let (slots_hz, _) = Needs::of(scene, &file.name, None)?
        .slots
        .context("the slots of steppers")?;
    let tick_s = 1.0 / scene.tick_rate_hz;
    ensure!(scene.tool.is_some(), "[tool] of the scene");
    Ok(json!({
        "image": image,
        "panicking": panicking,
        "trirrr": Programs::build()?.trirrr,
        "scene": file.path,
        "step": pins(Role::Step)?,
        "direction": pins(Role::Direction)?,
        "enable": pins(Role::StepperEnable)?[0],
        "enableHigh": enable_high,
        "tool": pins(Role::Tool)?[0],
        "toolHigh": scene.tool.is_some_and(|tool| !tool.inverted),
        "reversed": drives.each_ref().map(|drive| drive.reversed),
        "microstepsPerRad": per_radian,
        "leastUs": 1e6 / f64::from(slots_hz) - LATE_US,
        "tickS": tick_s,
        "ticks": scene.ticks() + 1,
        "silenceS": scene.service.silence_timeout_s,
        "holdRampS": scene.service.hold_ramp_s,
        "watchdogS": (4.0 * tick_s).max(0.2),
    }))
}
