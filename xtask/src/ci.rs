//! `cargo xtask ci`: everything that CI checks, in order, up to the first failure.

use crate::bench::choose_bench;
use crate::boards::{FIRMWARE_TARGET, G474_SCENE, RP2040_SCENE};
use crate::client::cleared;
use crate::cores::CORES;
use crate::image::{PROFILE, RUN_BEGAN};
use crate::packages::{
    BARE_PACKAGES, DEVICE_PACKAGES, DevicePackage, Package, RP2040, STM32F405, STM32G474,
};
use crate::page;
use crate::programs::Programs;
use crate::repository::{root, target_directory};
use crate::steps::{self, Stage, Step};
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;
use std::time::SystemTime;

/// Targets without an FPU, ARM and not, that the libraries without `std` have to compile for. Images compile them for one with an FPU.
const BARE_TARGETS: [&str; 2] = ["thumbv6m-none-eabi", "riscv32imc-unknown-none-elf"];

/// Oldest toolchain that the published packages compile with: `rust-version` of the workspace.
const OLDEST_TOOLCHAIN: &str = env!("CARGO_PKG_RUST_VERSION");

/// Examples that end only with a board at the other end of a port.
const EXAMPLES_WITH_BOARD: [&str; 1] = ["stream_to_board"];

/// Programs that build the bench, and that install and run the Python package, senders of G-code and the page, and what they are asked.
const INSTALLED_NEED: [(&str, &[&str]); 5] = [
    ("cmake", &["--version"]),
    ("chromium", &["--version"]),
    ("python3", &["-c", "import tkinter, ensurepip, tomllib"]),
    ("node", &["--version"]),
    ("npm", &["--version"]),
];

pub(crate) fn run() -> Result<()> {
    check_tools()?;
    let began = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?;
    let mut stages = stages()?;
    for step in stages.iter_mut().flat_map(Stage::steps_mut) {
        // An image that the sizes were measured of is not built again to be emulated.
        step.command.env(RUN_BEGAN, began.as_secs().to_string());
    }
    steps::run(stages)
}

/// Looks for the tools before any step: a check that is skipped cannot fail.
fn check_tools() -> Result<()> {
    let mut missing = Vec::new();
    for core in CORES {
        let emulator = core.emulator;
        let complaint = format!("{} (Debian package {})", emulator.command, emulator.package);
        if !answers(emulator.command, &["--version"]) && !missing.contains(&complaint) {
            missing.push(complaint);
        }
    }
    let sysroot = Command::new("rustc")
        .args(["--print", "sysroot"])
        .output()
        .context("rustc cannot be run")?;
    let sysroot = String::from_utf8(sysroot.stdout).context("rustc printed no path")?;
    let targets = CORES.iter().map(|core| core.target);
    for target in targets.chain([page::TARGET]) {
        let library = Path::new(sysroot.trim()).join("lib/rustlib").join(target);
        if !library.is_dir() {
            missing.push(format!("rustup target add {target}"));
        }
    }
    for (program, arguments) in INSTALLED_NEED {
        if !answers(program, arguments) {
            missing.push(format!("{program} {}", arguments.join(" ")));
        }
    }
    if !answers("rustup", &["run", OLDEST_TOOLCHAIN, "cargo", "--version"]) {
        missing.push(format!(
            "rustup toolchain install {OLDEST_TOOLCHAIN} --profile minimal"
        ));
    }
    if missing.is_empty() {
        return Ok(());
    }
    bail!("not installed: {}; .ci/run installs it", missing.join(", "))
}

/// Tells whether a program runs with these arguments.
fn answers(program: &str, arguments: &[&str]) -> bool {
    let output = Command::new(program).args(arguments).output();
    output.is_ok_and(|output| output.status.success())
}

/// The stages in order, what fails soonest at the top. Tests, senders and emulated boards wait for clocks, and images are linked on one
/// core: such steps run beside each other.
fn stages() -> Result<Vec<Stage>> {
    let packages = Package::all()?;
    // All that the lints have checked, so that no dependency is checked again.
    let mut docs = Step::on_host("docs", "doc", &["--quiet", "--no-deps"]);
    docs.command.env("RUSTDOCFLAGS", "-Dwarnings");
    let compiled = Step::on_host("tests, compiled", "test", &["--quiet", "--no-run"]);
    // The log of a failure names them all.
    let mut tests = vec![Step::on_host("tests", "test", &["--no-fail-fast"])];
    tests.extend(examples(&packages));
    let mut images = lints_of_devices();
    images.push(Step::chore("the boot loaders", &["boot"])?);
    images.extend(figures()?);
    images.extend(releases(&packages));

    let mut stages: Vec<Stage> = lints()?.into_iter().map(Stage::from).collect();
    stages.push(compiled.into());
    stages.push(Stage::Beside([tests, images]));
    let [client, senders, page, board, host @ ..] = programs()?;
    stages.extend(host.map(Stage::from));
    let mut built = vec![client, docs];
    built.extend(benches()?);
    // They wait for clocks at times; that of an emulated board passes with instructions.
    stages.push(Stage::Beside([built, vec![page, senders, board]]));
    Ok(stages)
}

fn lints() -> Result<[Step; 5]> {
    let all = ["--quiet", "--all-targets", "--", "-Dwarnings"];
    Ok([
        Step::cargo("format", &["fmt", "--all", "--check"]),
        Step::on_host("lints of the host crates", "clippy", &all),
        // Without the commands that it hands over.
        Step::cargo(
            "lints of the main job",
            &["clippy", "--quiet", "--bin", "trirrr", "--", "-Dwarnings"],
        ),
        Step::chore("the shape of the source", &["house", "--check"])?,
        Step::chore("the reference of the wire", &["wire", "--check"])?,
    ])
}

fn lints_of_devices() -> Vec<Step> {
    let lint = |package: DevicePackage| {
        let name = format!("lints of {}", package.title());
        // The profile of images: their build scripts are compiled once.
        let mut step = Step::cargo(name, &["clippy", "--quiet", "--profile", PROFILE]);
        package.choose(&mut step.command);
        step.command.args(["--", "-Dwarnings"]);
        // Scenes with drives: without them there is less to check.
        match package {
            RP2040 => _ = step.command.env("SCENE", RP2040_SCENE),
            STM32G474 => _ = step.command.env("SCENE", G474_SCENE),
            _ => {}
        }
        step
    };
    let mut lints: Vec<Step> = DEVICE_PACKAGES.map(lint).into();
    // Built for a host, too: its logic is tested there.
    lints.push(lint(DevicePackage::of("trirrr-boot", FIRMWARE_TARGET)));
    // Pins on other ports than the default board's, of a scene with steppers, homing and a tool.
    let mut other_board = lint(STM32F405);
    other_board.name += " for another board";
    other_board.command.env("BOARD", "feather-f405");
    other_board.command.env("SCENE", "scenes/pick-home.toml");
    lints.push(other_board);
    // Lines over USB: of a scene whose drives are at none of its pins.
    lints.extend([STM32F405, STM32G474, RP2040].map(|of| {
        let mut usb = lint(of);
        usb.name += " with a line over USB";
        usb.command
            .env("LINE", "usb")
            .env("SCENE", "scenes/thesis.toml");
        usb
    }));
    lints
}

/// Runs each example that needs no board; the tests' step has built them.
fn examples(packages: &[Package]) -> Vec<Step> {
    let built = target_directory().join("debug/examples");
    let alone = packages
        .iter()
        .flat_map(Package::examples)
        .filter(|example| !EXAMPLES_WITH_BOARD.contains(example));
    alone
        .map(|example| {
            let mut command = Command::new(built.join(example));
            command.current_dir(root());
            Step::new(format!("the example {example}"), command)
        })
        .collect()
}

/// Compiles `packages` with the oldest toolchain. Newer parts of the standard library in all other packages are found by the lints.
pub(crate) fn with_oldest_toolchain<'a>(packages: impl IntoIterator<Item = &'a str>) -> Step {
    let mut oldest = Command::new("rustup");
    oldest
        .current_dir(root())
        .args(["run", OLDEST_TOOLCHAIN, "cargo", "check", "--quiet"])
        .arg("--target-dir")
        .arg(target_directory().join("oldest"))
        // Set by the toolchain that runs this chore.
        .env_remove("CARGO")
        .env_remove("RUSTC")
        .env_remove("RUSTUP_TOOLCHAIN");
    for package in packages {
        oldest.args(["-p", package]);
    }
    Step::new(format!("Rust {OLDEST_TOOLCHAIN}"), oldest)
}

/// Checks of what is published: targets, the oldest toolchain, the archives.
fn releases(packages: &[Package]) -> Vec<Step> {
    let mut bare = Step::cargo("libraries without std", &["check", "--quiet"]);
    for package in BARE_PACKAGES {
        bare.command.args(["-p", package]);
    }
    for target in BARE_TARGETS {
        bare.command.args(["--target", target]);
    }
    let oldest = with_oldest_toolchain(BARE_PACKAGES);
    // Every library was compiled by the steps above; only the files of its archive are checked here.
    let archives = ["package", "--quiet", "--no-verify", "--allow-dirty"];
    let mut archives = Step::cargo("archives of the packages", &archives);
    for package in packages.iter().filter(|package| package.is_published()) {
        archives.command.args(["-p", &package.name]);
    }
    let optional = [
        "check",
        "--quiet",
        "-p",
        "trirrr-linkage",
        "-p",
        "trirrr-plan",
    ];
    let mut optional = Step::cargo("linkages and planning without std", &optional);
    let without = ["--no-default-features", "--target", BARE_TARGETS[0]];
    optional.command.args(without);
    vec![bare, optional, oldest, archives]
}

/// Scenes whose figures CI measures: a kind of drive or of machine each, in the number type of its image. `cargo xtask nightly` measures
/// those of all scenes in all types: others tick as one of these does.
const MEASURED: [&str; 2] = [
    // Steppers, fixed point, homing.
    "pick-home",
    // No drives, links without masses.
    "thesis",
];

/// Cores that CI measures: those of the boards, with an FPU and without. Nightly measures all.
const CORES_MEASURED: [&str; 2] = ["m4f", "m0"];

/// Scenes whose jobs CI plays on emulated boards, one with a simulated plant. Nightly plays all, spoils the line,
/// burns a raster image and injects failures.
const EMULATED: [&str; 2] = [
    "pick-home",
    // Amplifiers and encoders, under the board's own loops.
    "plant-thesis",
];

/// Lints of the bench, and what CI looks at on it: the pins of an engraver in its job and in every failure, frames to drives on a bus, and a
/// line that damages every fifth frame. Nightly looks at all.
fn benches() -> Result<[Step; 3]> {
    let mut lints = Step::cargo("lints of the bench", &["clippy", "--quiet"]);
    choose_bench(&mut lints.command);
    lints.command.args(["--", "-Dwarnings"]);
    let bus = [
        "bench",
        "plant-odrive",
        "--case",
        "can",
        "--case",
        "bus-off",
    ];
    Ok([
        lints,
        Step::chore(
            "pins and line of flashed images",
            &["bench", "inputs/guarded", "chained"],
        )?,
        Step::chore("the bus of a flashed image", &bus)?,
    ])
}

/// Figures of images against those that are checked in.
fn figures() -> Result<[Step; 4]> {
    let scenes = MEASURED.map(|scene| ["--scene", scene]).concat();
    let cores = CORES_MEASURED.map(|core| ["--core", core]).concat();
    let measured = |name: &str, chore: &str| {
        let arguments = [[chore, "--check", "--own"].as_slice(), &scenes, &cores].concat();
        Step::chore(name, &arguments)
    };
    Ok([
        measured("instructions per tick", "insns")?,
        measured("instructions per admission", "admission")?,
        // Traces the images of the two steps above.
        measured("modelled cycles", "cycles")?,
        // Builds the firmware too, for both boards, and checks that it can boot.
        measured("sizes", "size")?,
    ])
}

/// The host programs, alone and with an emulated board.
fn programs() -> Result<[Step; 8]> {
    let simulator = |name: &str, arguments: &[&str], out: &str| -> Result<Step> {
        let mut command = Command::new(Programs::built().trirrr);
        command.current_dir(root()).args(arguments).arg("--out");
        command.arg(cleared(target_directory().join("ci").join(out))?);
        Ok(Step::new(name, command))
    };
    let run = ["run", "scenes/thesis.toml", "--fast"];
    let eval = ["eval", "--scalar", "f32", "tests/reference/extreme.csv"];
    let board = [["emulate"].as_slice(), &EMULATED].concat();
    Ok([
        Step::chore("the Python package", &["client"])?,
        Step::chore("senders of G-code", &["senders"])?,
        Step::chore("the page", &["page"])?,
        Step::chore("the emulated board", &board)?,
        Step::new("the host programs", Programs::builder()),
        Step::chore("services in the program", &["weight"])?,
        simulator("a scene run", &run, "thesis")?,
        simulator("a batch evaluation", &eval, "extreme.csv")?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_a_name_of_its_own() {
        let mut stages = stages().expect("cargo metadata");
        let steps = stages.iter_mut().flat_map(Stage::steps_mut);
        let mut names: Vec<_> = steps.map(|step| &step.name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn every_example_with_a_board_is_one() {
        let packages = Package::all().expect("cargo metadata");
        let known: Vec<&str> = packages.iter().flat_map(Package::examples).collect();
        for example in EXAMPLES_WITH_BOARD {
            assert!(known.contains(&example), "{example}");
        }
    }
}
