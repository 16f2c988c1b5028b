//! Writes the scene's constants, and tells the linker about the memory.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs, process};

fn main() {
    if let Err(error) = build() {
        // In the error's own words: it is the user's scene that it is about.
        eprintln!("{error}");
        process::exit(1);
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or("no CARGO_MANIFEST_DIR")?);
    let root = here.join("..");
    trirrr_image::generate::build_script(&root)?;

    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        // link.x includes memory.x by name: it has to lie where the linker searches, and alone.
        let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
        let memory = root.join("memory.x");
        fs::copy(&memory, out.join("memory.x"))?;
        println!("cargo:rerun-if-changed={}", memory.display());
        println!("cargo:rustc-link-search={}", out.display());
        for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    Ok(())
}
