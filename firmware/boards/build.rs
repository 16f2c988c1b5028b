//! Takes the kinds of the scene over from `trirrr-app`, writes the pins of the board, and tells the linker about its memory.

use std::error::Error;
use std::path::Path;
use std::{env, fs, process};

/// Flash of an image in the whole of it, and of one in the slot of the program of `trirrr_boot::Layout::STM32F405`.
const WHOLE: &str = "ORIGIN = 0x08000000, LENGTH = 1024K";
const IN_SLOT: &str = "ORIGIN = 0x08020000, LENGTH = 256K";

/// Package whose board has a boot loader.
const UPDATED: &str = "trirrr-stm32f405";

/// Boards: package, Rust target, and linker script.
const BOARDS: [(&str, &str, &str); 2] = [
    // From cortex-m-rt. It includes `memory.x`, which the linker finds in the root of the workspace.
    ("trirrr-stm32f405", "thumbv7em-none-eabihf", "link.x"),
    // A whole one of its own: any `memory.x` would be that of the root.
    ("trirrr-rp2040", "thumbv6m-none-eabi", "rp2040.x"),
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
    for name in ["drive", "tool"] {
        let of_app = format!("DEP_TRIRRR_APP_{}", name.to_uppercase());
        let kinds = env::var(format!("{of_app}S"))?;
        println!("cargo:rustc-check-cfg=cfg({name}, values({kinds}))");
        println!("cargo:rustc-cfg={name}={:?}", env::var(of_app)?);
    }
    for name in [
        "homing",
        "brake",
        "feedback",
        "interlocks",
        "estop",
        "door",
        "update",
    ] {
        println!("cargo:rustc-check-cfg=cfg({name})");
        if env::var_os(format!("DEP_TRIRRR_APP_{}", name.to_uppercase())).is_some() {
            println!("cargo:rustc-cfg={name}");
        }
    }
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../..");
        trirrr_image::board::build_script(&env::var("CARGO_PKG_NAME")?, &root)?;
        link()?;
    }
    Ok(())
}

fn link() -> Result<(), Box<dyn Error>> {
    let (package, target) = (env::var("CARGO_PKG_NAME")?, env::var("TARGET")?);
    let (_, _, script) = BOARDS
        .iter()
        .find(|(of, on, _)| *of == package && *on == target)
        .ok_or_else(|| format!("{package} is for another board than {target}"))?;
    let is_updated = env::var_os("DEP_TRIRRR_APP_UPDATE").is_some();
    if is_updated && package != UPDATED {
        return Err(format!(
            "update = true in [service]: {package} has no boot loader; boards with an STM32F405 have one"
        )
        .into());
    }
    let here = env::var("CARGO_MANIFEST_DIR")?;
    let own = Path::new(&here).join(script);
    let script = match own.exists() {
        true => {
            println!("cargo:rerun-if-changed={}", own.display());
            own.display().to_string()
        }
        false => {
            println!("cargo:rerun-if-changed={here}/../../../memory.x");
            // `memory.x` includes it.
            let out = env::var("OUT_DIR")?;
            let flash = if is_updated { IN_SLOT } else { WHOLE };
            fs::write(
                Path::new(&out).join("program.x"),
                format!("MEMORY {{ FLASH : {flash} }}\n"),
            )?;
            println!("cargo:rustc-link-search={out}");
            (*script).to_owned()
        }
    };
    let script = format!("-T{script}");
    for argument in ["--nmagic", "--icf=all", &script, "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
