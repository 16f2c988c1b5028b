//! Writes the scene's constants and the linker scripts of the two images.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Memory of the emulated machines, by Rust target: start and length of what is executed from, and
/// of what is written to.
const MACHINES: &[(&str, [&str; 4])] = &[
    // microbit (nRF51822)
    ("thumbv6m-none-eabi", ["0", "256K", "0x20000000", "16K"]),
    // mps2-an385
    ("thumbv7m-none-eabi", ["0", "4M", "0x20000000", "4M"]),
    // mps2-an386
    ("thumbv7em-none-eabihf", ["0", "4M", "0x20000000", "4M"]),
    // virt, with -bios none
    (
        "riscv32imc-unknown-none-elf",
        ["0x80000000", "4M", "0x80400000", "4M"],
    ),
];

fn main() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or("no CARGO_MANIFEST_DIR")?);
    let root = here.join("../..");
    trirrr_image::generate::build_script(&root)?;

    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        link(&here)?;
    }
    Ok(())
}

fn link(here: &Path) -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
    let target = env::var("TARGET")?;
    let (_, [flash, flash_length, ram, ram_length]) = MACHINES
        .iter()
        .find(|(name, _)| *name == target)
        .ok_or_else(|| format!("no emulated machine is known for {target}"))?;
    let sections = here.join("count.x");
    let script = format!(
        "MEMORY\n{{\n  FLASH : ORIGIN = {flash}, LENGTH = {flash_length}\n  \
         RAM : ORIGIN = {ram}, LENGTH = {ram_length}\n}}\n\n{}",
        fs::read_to_string(&sections)?
    );
    fs::write(out.join("count.x"), script)?;
    println!("cargo:rerun-if-changed={}", sections.display());
    for binary in ["count", "admit", "plan", "serve"] {
        println!(
            "cargo:rustc-link-arg-bin={binary}=-T{}/count.x",
            out.display()
        );
    }
    println!("cargo:rerun-if-changed={}/bare.x", here.display());
    for binary in ["bare", "bare-service"] {
        println!(
            "cargo:rustc-link-arg-bin={binary}=-T{}/bare.x",
            here.display()
        );
    }
    Ok(())
}
