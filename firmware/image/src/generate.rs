//! Writes a scene as Rust source: its constants and the types that it needs.
//!
//! A build script calls [`build_script`] and the image includes `OUT_DIR/scene.rs`.

mod constant;
mod drive;
mod kinds;
mod source;
mod tool;

pub use drive::{DriveError, drive, kind};
pub use source::{source, units};
pub use tool::tool_kind;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};
use trirrr_scene::{NumberType, Scene, visible};

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

/// Writes `OUT_DIR/scene.rs`, and tells Cargo about the files and variables that this depends on.
///
/// `SCENE` names the scene, as a path relative to `root`; the default is `scenes/thesis.toml`. `TRIRRR_SCALAR`
/// names the number type; the default is the scene's own, with `f32` for `f64`, which is for hosts.
///
/// Sets the kind of the scene's drives as `cfg(drive = "...")`, that of its tool as `cfg(tool = "...")`, `cfg(homing)` for a
/// scene with homing, `cfg(interlocks)` for one with inputs, of which `cfg(estop)` and `cfg(door)` are there, `cfg(levels)` for one with power lists, `cfg(adjustable)` for one that clients may change, and `cfg(contact)` for one
/// that detects contacts. A package with a `links` key hands the first two on to the build scripts of its dependents. Cargo warns of
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

    let out =
        PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: not a build script")?);
    let drives = drive(&scene, &units(&scene, scalar)?)
        .map_err(|error| format!("{}: {error}", visible(&file.display().to_string())))?;
    fs::write(
        out.join("scene.rs"),
        source(&scene, scalar)? + &drives + &tool::tool(&scene),
    )?;
    print_kinds(&scene);
    print_contact(&scene, scalar);
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

/// Sets the kinds of the scene as `cfg`s, and tells them to the build scripts of dependent packages
/// (`DEP_..._DRIVES`, `DRIVE`, `TOOLS`, `TOOL`, `HOMING`, `BRAKE`, `INTERLOCKS`, `ESTOP`, `DOOR` and `FEEDBACK`).
fn print_kinds(scene: &Scene) {
    print_kind("drive", drive::KINDS, kind(scene));
    print_kind("tool", tool::TOOLS, tool_kind(scene));
    println!("cargo:rustc-check-cfg=cfg(homing)");
    if scene.homing.is_some() {
        println!("cargo:rustc-cfg=homing");
        println!("cargo:homing=yes");
    }
    println!("cargo:rustc-check-cfg=cfg(brake)");
    if scene.power.has_brake {
        println!("cargo:rustc-cfg=brake");
        println!("cargo:brake=yes");
    }
    println!("cargo:rustc-check-cfg=cfg(interlocks, estop, door)");
    let interlocks = &scene.inputs.interlocks;
    for (name, is_named) in [
        ("interlocks", scene.inputs.are_named()),
        ("estop", interlocks.emergency_stop.is_some()),
        ("door", interlocks.door.is_some()),
    ] {
        if is_named {
            println!("cargo:rustc-cfg={name}");
            println!("cargo:{name}=yes");
        }
    }
    println!("cargo:rustc-check-cfg=cfg(levels)");
    if scene.service.power_lists > 0 {
        println!("cargo:rustc-cfg=levels");
    }
    println!("cargo:rustc-check-cfg=cfg(adjustable)");
    if scene.service.adjustable {
        println!("cargo:rustc-cfg=adjustable");
    }
    println!("cargo:rustc-check-cfg=cfg(feedback)");
    if scene.feedback.is_some() {
        println!("cargo:rustc-cfg=feedback");
        println!("cargo:feedback=yes");
    }
}

/// Sets `cfg(name = "kind")`, one of `kinds`, and hands both on.
fn print_kind(name: &str, kinds: &[&str], kind: &str) {
    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    let kinds = kinds.join(", ");
    println!("cargo:rustc-check-cfg=cfg({name}, values({kinds}))");
    println!("cargo:{name}s={kinds}");
    println!("cargo:rustc-cfg={name}={kind:?}");
    println!("cargo:{name}={kind}");
}

/// Sets `cfg(contact)` for a scene that detects contacts, and `cfg(retreat)` if it goes back then, or `cfg(contact_refused)` where the number type `scalar` cannot.
fn print_contact(scene: &Scene, scalar: &str) {
    println!("cargo:rustc-check-cfg=cfg(contact, contact_refused, retreat)");
    let retreats = |contact: &trirrr_scene::Contact| contact.retreat_s > 0.0;
    if scene.contact.as_ref().is_some_and(retreats) && scalar != FIXED {
        println!("cargo:rustc-cfg=retreat");
    }
    match (scene.contact.is_some(), scalar == FIXED) {
        (true, false) => println!("cargo:rustc-cfg=contact"),
        (true, true) => println!("cargo:rustc-cfg=contact_refused"),
        (false, _) => {}
    }
}
