//! Writes a scene as Rust source: its constants and the types that it needs.
//!
//! A build script calls [`build_script`] and the image includes `OUT_DIR/scene.rs`.

mod autonomous;
mod constant;
mod drive;
mod kinds;
mod over_line;
mod source;
mod tool;

pub use drive::{DriveError, drive, kind, slots_hz};
pub use over_line::BoardScene;
pub use source::source;
pub use tool::tool_kind;

use crate::board::Needs;
use crate::ram;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};
use trirrr_core::units::Units;
use trirrr_scene::{NumberType, RangeError, Scene, is_board_file, units_of_scene, visible};

/// Number types of images: name in scenes and tables, and Rust type.
pub const SCALARS: &[(&str, &str)] = &[
    ("f64", "f64"),
    ("f32", "f32"),
    ("fixed", FIXED),
    ("micromath", COARSE),
];

/// Rust type of the number type whose scenes have units of their own.
const FIXED: &str = "trirrr_core::number::Fixed";

const COARSE: &str = "trirrr_core::number::Coarse";

/// Number type of an image for a scene with `number`, unless `TRIRRR_SCALAR` names another.
pub fn of_scene(number: NumberType) -> &'static str {
    match number {
        NumberType::F64 | NumberType::F32 => "f32",
        NumberType::Fixed => "fixed",
        NumberType::Micromath => "micromath",
    }
}

/// The units of an image for the Rust type `scalar`.
///
/// # Errors
/// A quantity that does not fit the number type.
pub fn units(scene: &Scene, scalar: &str) -> Result<Units, RangeError> {
    match scalar == FIXED {
        true => units_of_scene(scene),
        false => Ok(Units::SI),
    }
}

/// Writes `OUT_DIR/scene.rs`, and tells Cargo about the files and variables that this depends on.
///
/// `SCENE` names the scene, as a path relative to `root`; the default is `scenes/thesis.toml`. `TRIRRR_SCALAR`
/// names the number type; the default is the scene's own, with `f32` for `f64`, which is for hosts.
///
/// The file names the [features](trirrr_service::features::Feature) of the scene as types. Sets as `cfg`s what source depends on beside them:
/// `drive = "..."` and `tool = "..."`, the kinds of drives and tool; `homing`; `autonomous` for one without a host; `update` for a program that may
/// be replaced over the line, `scene_over_line` for one that takes other scenes. A package
/// with a `links` key hands them on to the build scripts of its dependents, with the [needs](Needs) of the scene. Cargo warns of
/// a scene that lacks limits of its motors.
///
/// # Errors
/// A scene that is refused, with file, key, value and reason. A quantity outside the range of the number type.
/// Drives that no board has. An unknown number type. A file that cannot be written.
pub fn build_script(root: &Path) -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-env-changed=TRIRRR_SCALAR");
    let (file, scene) = chosen(root)?;
    let scalar = env::var("TRIRRR_SCALAR").unwrap_or_else(|_| of_scene(scene.number).into());
    let (_, scalar) = SCALARS
        .iter()
        .find(|(name, _)| *name == scalar)
        .ok_or_else(|| {
            let known: Vec<&str> = SCALARS.iter().map(|(name, _)| *name).collect();
            format!(
                "TRIRRR_SCALAR={scalar}: images are built for {}",
                known.join(", ")
            )
        })?;

    // The target of an RP2040.
    let is_small = env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv6m"));
    println!("cargo:rustc-check-cfg=cfg(small)");
    if is_small {
        println!("cargo:rustc-cfg=small");
    }
    // Without this its own build would fail beside the code that uses the flash.
    if scene.service.update && is_small {
        return Err(format!(
            "{}: update = true in [service]: an RP2040 takes another program by USB, from its ROM (docs/board.md, RP2040); \
             leave update and scene_over_line out",
            file.display()
        )
        .into());
    }
    // Without a line and its queues an image is a tenth of the RAM.
    if is_small && scene.service.autonomous.is_none() {
        println!("cargo:rerun-if-env-changed=LINE");
        let usb = env::var("LINE").is_ok_and(|line| line == "usb");
        let number = match *scalar {
            FIXED => NumberType::Fixed,
            COARSE => NumberType::Micromath,
            _ => NumberType::F32,
        };
        ram::check(&scene, number, usb).map_err(|why| format!("{}: {why}", file.display()))?;
    }

    let out =
        PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: not a build script")?);
    let name = file.display().to_string();
    let in_file = |error: DriveError| format!("{}: {error}", visible(&name));
    let drives = drive(&scene, &units(&scene, scalar)?).map_err(in_file)?;
    fs::write(
        out.join("scene.rs"),
        source(&scene, scalar)? + &drives + &tool::tool(&scene),
    )?;
    print_kinds(&scene);
    let shown = file.strip_prefix(root).unwrap_or(&file);
    let needs = Needs::of(&scene, &shown.display().to_string(), board(&scene, &file));
    for (name, value) in needs.map_err(in_file)?.metadata() {
        println!("cargo:{name}={value}");
    }
    Ok(())
}

/// Reads the scene that `SCENE` names, and warns of limits that it lacks. Returns the path, too.
fn chosen(root: &Path) -> Result<(PathBuf, Scene), Box<dyn Error>> {
    println!("cargo:rerun-if-env-changed=SCENE");
    let file =
        env::var_os("SCENE").map_or_else(|| PathBuf::from("scenes/thesis.toml"), PathBuf::from);
    let file = root.join(file);
    println!("cargo:rerun-if-changed={}", file.display());
    let scene = Scene::read(&file)?;
    if let Some(machine) = &scene.machine_file {
        println!("cargo:rerun-if-changed={}", machine.display());
    }
    if let Some(warning) = scene.limits_warning() {
        println!("cargo:warning={warning}");
    }
    Ok((file, scene))
}

/// The board that the scene names: one by its path is beside the scene.
fn board(scene: &Scene, file: &Path) -> Option<String> {
    let name = scene.board.as_deref()?;
    let beside = file.parent().filter(|_| is_board_file(name));
    Some(beside.map_or_else(
        || name.into(),
        |folder| folder.join(name).display().to_string(),
    ))
}

/// Sets the kinds of the scene as `cfg`s. The build scripts of dependent packages learn them by [`Needs`]; here the names of all kinds
/// (`DEP_..._DRIVES`, `TOOLS`), `UPDATE` and `FEEDBACK` are handed on.
fn print_kinds(scene: &Scene) {
    print_kind("drive", drive::KINDS, kind(scene));
    print_kind("tool", tool::TOOLS, tool_kind(scene));
    println!("cargo:rustc-check-cfg=cfg(homing)");
    if scene.homing.is_some() {
        println!("cargo:rustc-cfg=homing");
    }
    println!("cargo:rustc-check-cfg=cfg(autonomous)");
    if scene.service.autonomous.is_some() {
        println!("cargo:rustc-cfg=autonomous");
    }
    println!("cargo:rustc-check-cfg=cfg(update)");
    if scene.service.update {
        println!("cargo:rustc-cfg=update");
        println!("cargo:update=yes");
    }
    println!("cargo:rustc-check-cfg=cfg(scene_over_line)");
    if scene.service.scene_over_line {
        println!("cargo:rustc-cfg=scene_over_line");
    }
    if scene.feedback.is_some() {
        println!("cargo:feedback=yes");
    }
}

/// Sets `cfg(name = "kind")`, one of `kinds`, which are handed on.
fn print_kind(name: &str, kinds: &[&str], kind: &str) {
    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    let kinds = kinds.join(", ");
    println!("cargo:rustc-check-cfg=cfg({name}, values({kinds}))");
    println!("cargo:{name}s={kinds}");
    println!("cargo:rustc-cfg={name}={kind:?}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_by_its_path_is_beside_the_scene() {
        let of = |named: &str| {
            let text = include_str!("../../../scenes/thesis.toml");
            let text = text.replacen("tick_rate_hz", &format!("{named}\ntick_rate_hz"), 1);
            let scene = Scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
            board(&scene, Path::new("own/scene.toml"))
        };
        assert_eq!(of(""), None);
        assert_eq!(of("board = \"pico\"").as_deref(), Some("pico"));
        let beside = of("board = \"mine.toml\"").map(PathBuf::from);
        assert_eq!(beside, Some(Path::new("own").join("mine.toml")));
    }
}
