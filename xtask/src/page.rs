//! `cargo xtask page`: the page as one file, and its test in a headless Chromium.
//!
//! The modules are compiled for WebAssembly, the generator that fits their wasm-bindgen writes their JavaScript and compresses them, and
//! esbuild bundles all with the page's TypeScript into `target/page/trirrr.html`. Tools come from npm by `web/page/package-lock.json`.

use crate::packages::choose_host;
use crate::programs::succeed;
use crate::repository::{cargo, root, target_directory};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Target of the modules.
pub(crate) const TARGET: &str = "wasm32-unknown-unknown";

/// Modules of the page: package, file, name of the JavaScript. The first is there at once, the others when the user opens a drawing or
/// connects a board.
const MODULES: [(&str, &str, &str); 3] = [
    ("trirrr-web", "trirrr_web.wasm", "core"),
    ("trirrr-web-drawing", "trirrr_web_drawing.wasm", "drawing"),
    ("trirrr-web-board", "trirrr_web_board.wasm", "board"),
];

/// Profile of the modules.
const PROFILE: &str = "web";

/// Ticks of each scene whose bits are compared.
const TICKS: u32 = 2000;

#[derive(clap::Args)]
pub(crate) struct PageArgs {
    /// Build the page, without the test in a browser
    #[arg(long)]
    build_only: bool,
    /// Ticks of each scene whose bits are compared with the native core
    #[arg(long, default_value_t = TICKS)]
    ticks: u32,
}

pub(crate) fn run(arguments: &PageArgs) -> Result<()> {
    let page = build()?;
    println!("wrote {}", page.display());
    match arguments.build_only {
        true => Ok(()),
        false => test(&page, arguments.ticks),
    }
}

/// Folder of everything that is made here.
fn folder() -> PathBuf {
    target_directory().join("page")
}

fn build() -> Result<PathBuf> {
    let mut module = cargo();
    module
        .args(["build", "--quiet", "--lib"])
        .args(
            MODULES
                .iter()
                .flat_map(|(package, ..)| ["--package", package]),
        )
        .args(["--target", TARGET, "--profile", PROFILE]);
    succeed(&mut module, "the page's modules")?;
    let build = folder().join("build");
    // A file that is no longer there would be checked with the others.
    let old = build.join("src");
    if old.is_dir() {
        fs::remove_dir_all(&old).with_context(|| old.display().to_string())?;
    }
    copy(&root().join("web/page"), &build)?;
    let modules = target_directory().join(TARGET).join(PROFILE);
    for (_, file, name) in MODULES {
        let mut generator = cargo();
        generator
            .args(["run", "--quiet", "--package", "trirrr-web-bindgen", "--"])
            .arg(modules.join(file))
            .arg(build.join("core"))
            .arg(name);
        succeed(&mut generator, "the JavaScript of a module")?;
    }
    let mut install = Command::new("npm");
    // No package runs a script of its own.
    install.args([
        "ci",
        "--ignore-scripts",
        "--no-audit",
        "--no-fund",
        "--loglevel=error",
    ]);
    succeed(
        install.current_dir(&build),
        "the installation of the page's tools",
    )?;
    let mut types = Command::new(build.join("node_modules/.bin/tsc"));
    succeed(types.current_dir(&build), "the check of the page's types")?;
    let page = folder().join("trirrr.html");
    let mut bundle = Command::new("node");
    bundle
        .arg("build.mjs")
        .arg(root().join("scenes"))
        .arg(&page);
    succeed(bundle.current_dir(&build), "the bundle")?;
    Ok(page)
}

fn test(page: &Path, ticks: u32) -> Result<()> {
    let mut example = cargo();
    example.args(["build", "--quiet"]);
    // As the tests are built, so that nothing is compiled twice.
    choose_host(&mut example);
    succeed(
        example.args(["--example", "bits", "--bin", "trirrr"]),
        "the bits of the native core, and the program with the board",
    )?;
    let native = Command::new(target_directory().join("debug/examples/bits"))
        .arg(ticks.to_string())
        .output()
        .context("the bits of the native core")?;
    ensure!(
        native.status.success(),
        "the bits of the native core: {}",
        String::from_utf8_lossy(&native.stderr)
    );
    let bits = folder().join("bits.txt");
    fs::write(&bits, &native.stdout).with_context(|| bits.display().to_string())?;
    let mut browser = Command::new("node");
    browser
        .arg("test.mjs")
        .args([page, &bits])
        .arg(ticks.to_string())
        .arg(folder())
        .arg(root().join("scenes/jobs"))
        .current_dir(folder().join("build"));
    succeed(&mut browser, "the page in Chromium")?;
    let mut board = Command::new("node");
    board
        .arg("test-board.mjs")
        .arg(page)
        .arg(target_directory().join("debug/trirrr"))
        .args([root().join("scenes"), folder()])
        .current_dir(folder().join("build"));
    succeed(&mut board, "the page and a board, in Chromium")
}

/// Copies the files of `from`, and leaves what else is in `to`: the tools that npm installed there.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let path = entry?.path();
        let target = to.join(path.file_name().unwrap_or_default());
        match path.is_dir() {
            true => copy(&path, &target)?,
            false => {
                fs::copy(&path, &target).with_context(|| target.display().to_string())?;
            }
        }
    }
    Ok(())
}
