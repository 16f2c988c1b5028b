//! Says what the scene needs, names the board, and tells the linker about its memory.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, process};

/// The boards: the package that is for one, its Rust target, and its directory in `src/board`.
const BOARDS: [(&str, &str, &str); 2] = [
    ("trirrr-firmware", "thumbv7em-none-eabihf", "stm32f405"),
    ("trirrr-firmware-rp2040", "thumbv6m-none-eabi", "rp2040"),
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
    let root = above(&here, "scenes")?;
    trirrr_image::generate::kinds_script(root)?;

    let names = BOARDS.map(|(_, _, board)| format!("{board:?}")).join(", ");
    println!("cargo:rustc-check-cfg=cfg(board, values({names}))");
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let (package, target) = (env::var("CARGO_PKG_NAME")?, env::var("TARGET")?);
        let (_, _, board) = BOARDS
            .iter()
            .find(|(of, on, _)| *of == package && *on == target)
            .ok_or_else(|| format!("{target}: {package} has no board with this target"))?;
        println!("cargo:rustc-cfg=board={board:?}");
        // link.x includes memory.x by name, and the linker looks into the workspace's root before it
        // looks anywhere else: each board's lies there.
        let memory = above(&here, "memory.x")?;
        println!(
            "cargo:rerun-if-changed={}",
            memory.join("memory.x").display()
        );
        println!("cargo:rustc-link-search={}", memory.display());
        for argument in ["--nmagic", "--icf=all", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    Ok(())
}

/// The nearest directory, from `here` upwards, in which there is a `name`.
fn above<'a>(here: &'a Path, name: &str) -> Result<&'a Path, Box<dyn Error>> {
    let found = here
        .ancestors()
        .find(|directory| directory.join(name).exists());
    Ok(found.ok_or_else(|| format!("no {name} from {} upwards", here.display()))?)
}
