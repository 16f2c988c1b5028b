//! Tells the linker about the memory of the boot loader.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../../memory.x");
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let out = env::var("OUT_DIR")?;
        // `memory.x` includes it.
        fs::write(
            Path::new(&out).join("program.x"),
            "MEMORY { FLASH : ORIGIN = 0x08000000, LENGTH = 16K }\n",
        )?;
        println!("cargo:rustc-link-search={out}");
        for argument in ["--nmagic", "-Tlink.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    Ok(())
}
