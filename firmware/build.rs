//! Writes the scene's constants, chooses the board by the target, and tells the linker about its
//! memory.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs, process};

/// The boards, by Rust target: each is a directory of `src/board`.
const BOARDS: [(&str, &str); 2] = [
    ("thumbv7em-none-eabihf", "stm32f405"),
    ("thumbv6m-none-eabi", "rp2040"),
];

fn main() {
    if let Err(error) = build() {
        // In the error's own words: it is the user's scene that it is about.
        eprintln!("{error}");
        process::exit(1);
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or("no CARGO_MANIFEST_DIR")?);
    trirrr_image::generate::build_script(&here.join(".."))?;

    let names = BOARDS.map(|(_, board)| format!("{board:?}")).join(", ");
    println!("cargo:rustc-check-cfg=cfg(board, values({names}))");
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let target = env::var("TARGET")?;
        let (_, board) = BOARDS
            .iter()
            .find(|(of, _)| *of == target)
            .ok_or_else(|| format!("{target}: no board has this target"))?;
        println!("cargo:rustc-cfg=board={board:?}");
        // link.x includes memory.x by name: it has to lie where the linker searches, and alone.
        let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
        let memory = here.join("src/board").join(board).join("memory.x");
        fs::copy(&memory, out.join("memory.x"))?;
        println!("cargo:rerun-if-changed={}", memory.display());
        println!("cargo:rustc-link-search={}", out.display());
        for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    Ok(())
}
