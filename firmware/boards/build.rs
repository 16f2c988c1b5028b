//! Takes the kinds of the scene over from `trirrr-app`, writes the pins of the board, and tells the linker about its memory.

use std::error::Error;
use std::path::Path;
use std::{env, process};

/// Folder of the memory of an image behind the boot loader, of a board that has one.
const UPDATED: &str = "updated";

/// Boards: package, Rust target, and linker script.
const BOARDS: [(&str, &str, &str); 3] = [
    // From cortex-m-rt. It includes the `memory.x` of the root, which includes the `regions.x` of the package.
    ("trirrr-stm32f405", "thumbv7em-none-eabihf", "link.x"),
    ("trirrr-stm32g474", "thumbv7em-none-eabihf", "link.x"),
    // A whole one of its own: cortex-m-rt has none for a second stage.
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
    // Something that a failure has to switch off: drives, a tool or spare outputs.
    println!("cargo:rustc-check-cfg=cfg(outputs)");
    let has = |name: &str| env::var(name).is_ok_and(|kind| kind != "none");
    let has_spare = env::var_os("DEP_TRIRRR_APP_DIGITAL").is_some();
    if has("DEP_TRIRRR_APP_DRIVE") || has("DEP_TRIRRR_APP_TOOL") || has_spare {
        println!("cargo:rustc-cfg=outputs");
    }
    for name in [
        "homing",
        "brake",
        "lamp",
        "digital",
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
    let here = env::var("CARGO_MANIFEST_DIR")?;
    if is_updated && !Path::new(&here).join(UPDATED).exists() {
        return Err(format!(
            "update = true in [service]: {package} has no boot loader; boards with an STM32F405 or an STM32G474 have one"
        )
        .into());
    }
    let own = Path::new(&here).join(script);
    let script = match own.exists() {
        true => {
            println!("cargo:rerun-if-changed={}", own.display());
            // `main` is in RAM, out of reach of the branch to it: the board's crate leads there.
            println!("cargo:rustc-link-arg-bins=--wrap=main");
            own.display().to_string()
        }
        false => {
            println!("cargo:rerun-if-changed={here}/../../../memory.x");
            // `regions.x`, which `memory.x` includes.
            let regions = match is_updated {
                true => Path::new(&here).join(UPDATED),
                false => Path::new(&here).to_path_buf(),
            };
            println!("cargo:rerun-if-changed={}/regions.x", regions.display());
            println!("cargo:rustc-link-search={}", regions.display());
            (*script).to_owned()
        }
    };
    let script = format!("-T{script}");
    for argument in ["--nmagic", "--icf=all", &script, "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
