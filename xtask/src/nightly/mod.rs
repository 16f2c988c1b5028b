//! `cargo xtask nightly`: checks that take long and rarely fail, in parts.
//!
//! Every part runs, whatever fails before it. A part that has passed on the same commit is left out: a night that was cut off goes on.

mod record;

use crate::bench::{ALONE, UPDATED, choose_bench};
use crate::ci::with_oldest_toolchain;
use crate::image::PROFILE;
use crate::packages::{DevicePackage, NIGHTLY_PACKAGES, Package, STM32F405, STM32G474};
use crate::repository::{root, target_directory};
use crate::steps::Step;
use anyhow::{Result, bail, ensure};
use clap::Args;
use record::Record;
use std::process::Command;

#[derive(Args)]
pub(crate) struct NightlyArgs {
    /// Run the parts alone whose names hold these words. May stand several times
    #[arg(long, value_name = "WORDS")]
    part: Vec<String>,
    /// Print the parts, and how they ended last, and run none
    #[arg(long)]
    list: bool,
    /// Run parts again that have passed on this commit
    #[arg(long)]
    again: bool,
    /// Parts that run at a time
    #[arg(long, default_value_t = 2)]
    lanes: usize,
}

pub(crate) fn run(args: &NightlyArgs) -> Result<()> {
    let mut steps = steps()?;
    if !args.part.is_empty() {
        steps.retain(|step| args.part.iter().any(|words| step.name.contains(words)));
        ensure!(
            !steps.is_empty(),
            "no part has such a name; --list prints them"
        );
    }
    let names: Vec<String> = steps.iter().map(|step| step.name.clone()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut record = Record::read()?;
    if !args.list {
        let commit = record::commit()?;
        steps.retain(|step| args.again || !record.has_passed(&step.name, &commit));
        check_tools(&steps)?;
        record = record::run(steps, args.lanes.max(1), record, &commit)?;
    }
    print!("{}", record.table(&names));
    let failed = record.not_passed(&names);
    if !args.list && !failed.is_empty() {
        bail!(
            "not passed: {}; target/nightly has what they printed",
            failed.join(", ")
        );
    }
    Ok(())
}

/// Looks for the tools of `steps` before any of them.
fn check_tools(steps: &[Step]) -> Result<()> {
    let deny = Command::new("cargo-deny");
    let tools = [
        ("deny", deny, "cargo install cargo-deny --locked"),
        (
            "miri",
            on_nightly(),
            "rustup toolchain install nightly --component miri rust-src",
        ),
    ];
    for (word, mut tool, install) in tools {
        let needs = |step: &Step| step.command.get_args().any(|argument| argument == word);
        if steps.iter().any(needs) {
            let output = tool.arg("--version").output();
            let works = output.is_ok_and(|output| output.status.success());
            ensure!(works, "not installed: {install}");
        }
    }
    Ok(())
}

/// Checks of `clients/zenoh`, a workspace of its own: its dependencies, its lints, and its tests with those that take long.
fn zenoh() -> [Step; 4] {
    let manifest = ["--manifest-path", "clients/zenoh/Cargo.toml"];
    let build = target_directory().join("zenoh");
    let step = |name: &str, command: &str, rest: &[&str]| {
        let mut step = Step::cargo(name, &[&[command], manifest.as_slice()].concat());
        if matches!(command, "clippy" | "test") {
            step.command.arg("--target-dir").arg(&build);
        }
        step.command.args(rest);
        step
    };
    let rules = ["--config", "clients/zenoh/deny.toml", "check"];
    let rules = [rules.as_slice(), &["bans", "licenses", "sources"]].concat();
    let lints = ["--quiet", "--all-targets", "--", "-Dwarnings"];
    let tests = ["--", "--include-ignored", "--nocapture", "--test-threads=1"];
    [
        step("dependencies of machines on Zenoh", "deny", &rules),
        step("format of machines on Zenoh", "fmt", &["--check"]),
        step("lints of machines on Zenoh", "clippy", &lints),
        step("a hundred machines on Zenoh", "test", &tests),
    ]
}

/// Images that CI does not lint: package and scene. Scenes over the line with steppers, homing and a tool, and with amplifiers and feedback;
/// an update of the STM32G474; classic CAN on it.
const LINTED: [(DevicePackage, &str); 4] = [
    (STM32F405, "tests/mcu-bench/scenes/stepping.toml"),
    (STM32F405, "tests/mcu-bench/scenes/amplified.toml"),
    (STM32G474, "tests/mcu-bench/scenes/updated.toml"),
    (STM32G474, "scenes/plant-odrive.toml"),
];

/// Lints of an image.
fn lint_image((package, scene): (DevicePackage, &str)) -> Step {
    let lints = ["clippy", "--quiet", "--profile", PROFILE];
    let name = format!("lints of {} with {scene}", package.title());
    let mut step = Step::cargo(name, &lints);
    package.choose(&mut step.command);
    step.command.args(["--", "-Dwarnings"]).env("SCENE", scene);
    step
}

/// Tests of the bench's own peripherals.
fn model_of_registers() -> Step {
    let mut step = Step::cargo("the model of the registers", &["test", "--quiet"]);
    choose_bench(&mut step.command);
    step
}

/// Miri, of the nightly toolchain.
fn on_nightly() -> Command {
    let mut miri = Command::new("rustup");
    miri.current_dir(root())
        .args(["run", "nightly", "cargo", "miri"])
        // Set by the toolchain that runs this chore.
        .env_remove("CARGO")
        .env_remove("RUSTC")
        .env_remove("RUSTUP_TOOLCHAIN");
    miri
}

/// Tests of all that two threads share, as if each had a core of its own: no data race, no word before those that it announces.
fn hand_over(package: &str, filters: &[&str]) -> Step {
    let mut miri = on_nightly();
    miri.args(["test", "-p", package, "--lib", "--target-dir"])
        .arg(target_directory().join("miri"))
        .arg("--")
        .args(filters)
        .env("MIRIFLAGS", "-Zmiri-disable-isolation");
    Step::new(format!("the hand-over of {package} on two cores"), miri)
}

fn steps() -> Result<Vec<Step>> {
    let mut steps = vec![
        // Licences, sources and duplicates of dependencies, by deny.toml.
        Step::cargo(
            "dependencies",
            &[
                "deny",
                "--workspace",
                "check",
                "bans",
                "licenses",
                "sources",
            ],
        ),
        Step::on_host(
            "admission of ten thousand moves",
            "test",
            &["--test", "admission", "--", "--ignored", "--nocapture"],
        ),
        // By day a tenth of the cases.
        Step::on_host(
            "random cases at full length",
            "test",
            &[
                "--release",
                "--test",
                "admission",
                "--test",
                "agreement",
                "--test",
                "exactness",
                "--test",
                "linkages",
                "--test",
                "properties",
                "--test",
                "random_paths",
                "--test",
                "retarget",
                "--test",
                "torture",
            ],
        ),
        Step::on_host(
            "random cases of units at full length",
            "test",
            &[
                "--release",
                "--lib",
                "--",
                "assembly",
                "comparison",
                "redundant",
                "sqrt",
                "taylor",
                "tracking",
                "two_word",
            ],
        ),
        Step::on_host(
            "ten thousand random paths",
            "test",
            &[
                "--release",
                "--test",
                "random_paths",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "files that commands read and write, all pairs",
            "test",
            &["--test", "commands", "all_pairs", "--", "--ignored"],
        ),
        Step::on_host(
            "two thousand random programs through windows",
            "test",
            &[
                "--release",
                "--package",
                "trirrr-plan",
                "--test",
                "reference",
                "--",
                "--ignored",
                "--nocapture",
                "two_thousand",
            ],
        ),
        Step::on_host(
            "jobs of a million lines",
            "test",
            &[
                "--release",
                "--test",
                "long_jobs",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "ten million poses of a proven workspace",
            "test",
            &[
                "--release",
                "--package",
                "trirrr-design",
                "--test",
                "workspace",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "a thousand calibrated machines",
            "test",
            &[
                "--release",
                "--package",
                "trirrr-calibration",
                "--test",
                "calibration",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "169 programs of G-code",
            "test",
            &[
                "--release",
                "--test",
                "programs",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "ten thousand random drawings, and Chromium's outlines of them",
            "test",
            &[
                "--package",
                "trirrr-toolpath",
                "--features",
                "svg",
                "--test",
                "svg_random",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "a million retargets",
            "test",
            &[
                "--release",
                "--test",
                "retarget",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "goals that cut the motion, a slow line, a job of eight hours",
            "test",
            &[
                "--release",
                "--test",
                "torture",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "all states of the service",
            "test",
            &[
                "--release",
                "--package",
                "trirrr-service",
                "--lib",
                "explore",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        hand_over("trirrr-service", &["tests::shared", "tests::threads"]),
        hand_over("trirrr-drives", &["bldc::line"]),
        Step::chore(
            "the page, and a million ticks in WebAssembly",
            &["page", "--ticks", "65000"],
        )?,
        Step::chore("instructions of all scenes", &["insns", "--check"])?,
        Step::chore("admission of all scenes", &["admission", "--check"])?,
        Step::chore("modelled cycles of all scenes", &["cycles", "--check"])?,
        Step::chore("sizes of all scenes", &["size", "--check"])?,
        Step::chore(
            "emulated boards of all scenes, in fixed point too",
            &["emulate", "--fixed"],
        )?,
        Step::chore("the image for the STM32G474", &["g474"])?,
        model_of_registers(),
        Step::chore("pins of flashed images", &["bench"])?,
        Step::chore("updates of the STM32G474", &["bench", "--g474", UPDATED[0]])?,
        Step::chore("an STM32G474 without a host", &["bench", "--g474", ALONE])?,
        Step::chore(
            "classic CAN of the STM32G474",
            &["bench", "--g474", "plant-odrive"],
        )?,
        Step::chore(
            "a bad line of the STM32G474",
            &[
                "bench", "--g474", "chained", "--case", "line", "--case", "late",
            ],
        )?,
        Step::chore("pins of the RP2040's image", &["rp2040", "--run"])?,
        Step::cargo(
            "the study of integrators",
            &[
                "test",
                "--release",
                "--package",
                "trirrr-report",
                "--test",
                "report",
                "--",
                "--ignored",
            ],
        ),
        Step::on_host(
            "reader and machine near limits",
            "test",
            &[
                "--test",
                "reader_and_machine",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "holds at every tick of all scenes and of a thousand jobs",
            "test",
            &[
                "--release",
                "--test",
                "holds",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::cargo(
            "a thousand machines that fall, faults of drives, no contact in ten million ticks",
            &[
                "test",
                "--release",
                "-p",
                "trirrr-plant",
                "--test",
                "plant",
                "--test",
                "bus",
                "--test",
                "contact",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "tolerances of two thousand machines",
            "test",
            &["--test", "tolerances", "--", "--ignored", "--nocapture"],
        ),
        Step::on_host(
            "assembly modes next to double roots",
            "test",
            &[
                "-p",
                "trirrr-core",
                "--lib",
                "complete_lists",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::cargo(
            "a table of a million rows",
            &[
                "test",
                "--release",
                "-p",
                "trirrr-batch",
                "--test",
                "table",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::cargo(
            "a million lines of G-code, and a million damaged ones",
            &[
                "test",
                "--release",
                "-p",
                "trirrr-toolpath",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::cargo(
            "a thousand holds and two thousand programs of a sender",
            &[
                "test",
                "--release",
                "-p",
                "trirrr-host-sim",
                "--lib",
                "grbl",
                "--",
                "--ignored",
                "--nocapture",
            ],
        ),
        Step::on_host(
            "ten million ticks",
            "test",
            &["--release", "--test", "soak", "--", "--ignored"],
        ),
    ];
    steps.push(Step::chore(
        "what the main job hands over",
        &["weight", "--hand-over"],
    )?);
    steps.push(Step::chore("the first run", &["weight", "--first-run"])?);
    steps.extend(LINTED.map(lint_image));
    for package in NIGHTLY_PACKAGES {
        let lints = ["clippy", "--quiet", "-p", package, "--all-targets"];
        let mut lints = Step::cargo(format!("lints of {package}"), &lints);
        lints.command.args(["--", "-Dwarnings"]);
        steps.push(lints);
        steps.push(Step::cargo(
            format!("tests of {package}"),
            &["test", "-p", package],
        ));
    }
    steps.extend(zenoh());
    // As a user gets them: each archive is unpacked and compiled.
    let archives = ["package", "--quiet", "--allow-dirty"];
    let mut archives = Step::cargo("packages from their archives", &archives);
    let packages = Package::all()?;
    for package in packages.iter().filter(|package| package.is_published()) {
        archives.command.args(["-p", &package.name]);
    }
    steps.push(archives);
    let published = packages.iter().filter(|package| package.is_published());
    let published = published.map(|package| package.name.as_str());
    steps.push(with_oldest_toolchain(published.chain(["trirrr-host-sim"])));
    let line = ["emulate", "--part", "line", "--frames", "200000"];
    let cuts = ["--seconds", "600", "--cuts", "200"];
    let line = [line.as_slice(), &cuts].concat();
    steps.push(Step::chore(
        "a bad line for long, and a job that is cut off",
        &line,
    )?);
    let raster = ["emulate", "--part", "raster", "--seconds", "600"];
    steps.push(Step::chore("a raster image of ten minutes", &raster)?);
    let failures = ["emulate", "--part", "failures"];
    steps.push(Step::chore("injected failures", &failures)?);
    let alone = ["emulate", "--part", "alone"];
    steps.push(Step::chore("a board without a host", &alone)?);
    steps.push(Step::chore(
        "torques of MuJoCo and Pinocchio",
        &["simulators"],
    )?);
    steps.push(Step::chore("long fuzzing", &["fuzz", "--seconds", "600"])?);
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_a_name_of_its_own() {
        let steps = steps().expect("cargo metadata");
        let names: std::collections::BTreeSet<&str> =
            steps.iter().map(|step| step.name.as_str()).collect();
        assert_eq!(names.len(), steps.len());
    }
}
