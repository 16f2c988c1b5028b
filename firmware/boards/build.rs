//! Takes the kinds of the scene over from `trirrr-app`, writes the pins of the board, and tells the linker about its memory.

use std::error::Error;
use std::path::Path;
use std::{env, process};

/// Folder of the memory of an image behind the boot loader, of a board that has one.
const UPDATED: &str = "updated";

/// Firmware of a chip: its package, Rust target, and linker script. A package of several chips has a feature for each.
const FIRMWARE: [(&str, &str, &str, &str); 3] = [
    // From cortex-m-rt. It includes the `memory.x` of the root, which includes the `regions.x` of the chip.
    (
        "stm32f405",
        "trirrr-stm32",
        "thumbv7em-none-eabihf",
        "link.x",
    ),
    (
        "stm32g474",
        "trirrr-stm32",
        "thumbv7em-none-eabihf",
        "link.x",
    ),
    // A whole one of its own: cortex-m-rt has none for a second stage.
    ("rp2040", "trirrr-rp2040", "thumbv6m-none-eabi", "rp2040.x"),
];

fn main() {
    if let Err(error) = build() {
        // Printed as text: the user reads about a board file, not about a build script.
        eprintln!("{error}");
        process::exit(1);
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=../build.rs");
    let of_app = |name: &str| env::var(format!("DEP_TRIRRR_APP_{}", name.to_uppercase()));
    for name in ["drive", "tool"] {
        let kinds = of_app(&format!("{name}s"))?;
        println!("cargo:rustc-check-cfg=cfg({name}, values({kinds}))");
        println!("cargo:rustc-cfg={name}={:?}", of_app(name)?);
    }
    let set = |name: &str, is_set: bool| {
        println!("cargo:rustc-check-cfg=cfg({name})");
        if is_set {
            println!("cargo:rustc-cfg={name}");
        }
    };
    let needs = trirrr_image::board::Needs::read(|name| of_app(name).ok())?;
    // Drives on a CAN bus.
    set(
        "bus",
        matches!(needs.drive.as_str(), "odrive" | "mit" | "moteus"),
    );
    set("outputs", needs.has_outputs());
    set("update", of_app("update").is_ok());
    for (name, is_set) in needs.cfgs() {
        set(name, is_set);
    }
    let (package, target) = (env::var("CARGO_PKG_NAME")?, env::var("TARGET")?);
    // What all boards share has no pins of its own.
    let is_board = FIRMWARE.iter().any(|(_, of, _, _)| *of == package);
    if is_board && env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let here = env::var("CARGO_MANIFEST_DIR")?;
        let is_chosen = |chip: &str| {
            let feature = format!("CARGO_FEATURE_{}", chip.to_uppercase());
            package == format!("trirrr-{chip}") || env::var_os(feature).is_some()
        };
        let (chip, _, _, script) = FIRMWARE
            .iter()
            .find(|(chip, of, on, _)| *of == package && *on == target && is_chosen(chip))
            .ok_or_else(|| {
                format!("{package} has no firmware for {target}, or no feature that names the chip")
            })?;
        trirrr_image::board::build_script(chip, &Path::new(&here).join("../../.."))?;
        link(Path::new(&here), chip, script)?;
    }
    Ok(())
}

/// Tells the linker about the memory of the chip.
fn link(here: &Path, chip: &str, script: &str) -> Result<(), Box<dyn Error>> {
    let is_updated = env::var_os("DEP_TRIRRR_APP_UPDATE").is_some();
    let folder = here.join(chip);
    if is_updated && !folder.join(UPDATED).exists() {
        return Err(format!(
            "update = true in [service]: the {chip} has no boot loader; boards with an STM32F405 or an STM32G474 have one"
        )
        .into());
    }
    let own = here.join(script);
    let script = match own.exists() {
        true => {
            println!("cargo:rerun-if-changed={}", own.display());
            // `main` is in RAM, out of reach of the branch to it: the board's crate leads there.
            println!("cargo:rustc-link-arg-bins=--wrap=main");
            own.display().to_string()
        }
        false => {
            println!(
                "cargo:rerun-if-changed={}/../../../memory.x",
                here.display()
            );
            // `regions.x`, which `memory.x` includes.
            let regions = match is_updated {
                true => folder.join(UPDATED),
                false => folder,
            };
            println!("cargo:rerun-if-changed={}/regions.x", regions.display());
            println!("cargo:rustc-link-search={}", regions.display());
            script.to_owned()
        }
    };
    let script = format!("-T{script}");
    for argument in ["--nmagic", "--icf=all", &script, "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
