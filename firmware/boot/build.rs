//! Tells the linker about the memory of the boot loader.

use std::env;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../../memory.x");
    println!("cargo:rerun-if-changed=regions.x");
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        // `memory.x` of the root includes the `regions.x` of this folder.
        println!(
            "cargo:rustc-link-search={}",
            env::var("CARGO_MANIFEST_DIR")?
        );
        for argument in ["--nmagic", "-Tlink.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    Ok(())
}
