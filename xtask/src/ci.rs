//! `cargo xtask ci`: everything that CI checks, in order, up to the first failure.

use crate::cores::CORES;
use crate::programs::Programs;
use crate::repository::{cargo, root, target_directory};
use crate::rp2040;
use crate::size::FIRMWARE_TARGET;
use anyhow::{Context, Result, bail};
use std::iter;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// The crates that are built for microcontrollers only; a host has nothing to check in them.
const DEVICE_PACKAGES: [(&str, &str); 4] = [
    ("trirrr-app", FIRMWARE_TARGET),
    ("trirrr-stm32f405", FIRMWARE_TARGET),
    ("trirrr-rp2040", rp2040::TARGET),
    ("trirrr-insns", FIRMWARE_TARGET),
];

/// Targets that the core has to build for although nothing runs there: no operating system, with
/// and without an FPU, ARM and not.
const CORE_TARGETS: [&str; 3] = [
    "thumbv7em-none-eabihf",
    "thumbv6m-none-eabi",
    "riscv32imc-unknown-none-elf",
];

struct Step {
    name: String,
    command: Command,
}

pub(crate) fn run() -> Result<()> {
    check_tools()?;
    let start = Instant::now();
    for mut step in steps() {
        println!("== {}", step.name);
        let begin = Instant::now();
        let status = step
            .command
            .status()
            .with_context(|| format!("{}: cannot be started", step.name))?;
        let time = seconds(begin.elapsed());
        if !status.success() {
            bail!(
                "{} failed after {time} ({status}): {}",
                step.name,
                line(&step.command)
            );
        }
        println!("== {}: passed, {time}", step.name);
    }
    println!("== everything passed, {}", seconds(start.elapsed()));
    Ok(())
}

/// What has to be installed is looked for before anything else, for a count that is skipped would
/// be a check that cannot fail.
fn check_tools() -> Result<()> {
    let mut missing = Vec::new();
    for core in CORES {
        let emulator = core.emulator;
        let found = Command::new(emulator.command).arg("--version").output();
        let complaint = format!("{} (Debian package {})", emulator.command, emulator.package);
        if !found.is_ok_and(|output| output.status.success()) && !missing.contains(&complaint) {
            missing.push(complaint);
        }
    }
    let targets = Command::new("rustc")
        .args(["--print", "sysroot"])
        .output()
        .context("rustc cannot be run")?;
    let sysroot = String::from_utf8(targets.stdout).context("rustc printed no path")?;
    for core in CORES {
        let library = Path::new(sysroot.trim())
            .join("lib/rustlib")
            .join(core.target);
        if !library.is_dir() {
            missing.push(format!("rustup target add {}", core.target));
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    bail!("not installed: {}; .ci/run installs it", missing.join(", "))
}

fn steps() -> Vec<Step> {
    let mut steps = vec![
        step("format", &["fmt", "--all", "--check"]),
        on_host(
            "lints of the host crates",
            "clippy",
            &["--quiet", "--all-targets", "--", "-Dwarnings"],
        ),
    ];
    for (package, target) in DEVICE_PACKAGES {
        steps.push(lints(&format!("lints of {package}"), package, target));
    }
    steps.push(on_host("tests", "test", &[]));
    steps.push(on_host(
        "admission of ten thousand moves",
        "test",
        &["--test", "admission", "--", "--ignored", "--nocapture"],
    ));
    let mut docs = step("docs", &["doc", "--quiet", "--no-deps"]);
    docs.command.env("RUSTDOCFLAGS", "-Dwarnings");
    steps.push(docs);
    for target in CORE_TARGETS {
        steps.push(step(
            &format!("core for {target}"),
            &["build", "--quiet", "-p", "trirrr-core", "--target", target],
        ));
    }
    steps.push(step(
        "linkages without std",
        &[
            "check",
            "--quiet",
            "-p",
            "trirrr-linkage",
            "--no-default-features",
            "--target",
            CORE_TARGETS[0],
        ],
    ));
    steps.push(step(
        "instructions per tick",
        &["xtask", "insns", "--check"],
    ));
    steps.push(step(
        "instructions per admission",
        &["xtask", "admission", "--check"],
    ));
    // Builds the firmware too, for both boards, and checks that it can boot.
    steps.push(step("sizes", &["xtask", "size", "--check"]));
    // All that are needed at once, as the steps below need them: `cargo run` would compile them another time.
    steps.push(Step {
        name: "the host programs".into(),
        command: Programs::builder(),
    });
    let simulator = |name: &str, arguments: &[&str], out: &str| {
        let mut command = Command::new(Programs::built().trirrr);
        command.current_dir(root()).args(arguments).arg("--out");
        command.arg(target_directory().join("ci").join(out));
        Step {
            name: name.into(),
            command,
        }
    };
    let run = ["run", "scenes/thesis.toml", "--fast"];
    steps.push(simulator("a scene run", &run, "thesis"));
    let eval = ["eval", "--scalar", "f32", "tests/reference/extreme.csv"];
    steps.push(simulator("a batch evaluation", &eval, "extreme.csv"));
    steps.push(step("the Python client", &["xtask", "client"]));
    for part in ["jobs", "line", "failures"] {
        steps.push(step(
            &format!("the emulated board: {part}"),
            &["xtask", "emulate", "--part", part],
        ));
    }
    steps.push(step("fuzzing", &["xtask", "fuzz"]));
    steps
}

/// Clippy on a package that is for microcontrollers.
fn lints(name: &str, package: &str, target: &str) -> Step {
    let mut step = step(name, &["clippy", "--quiet"]);
    step.command.args(["-p", package, "--target", target]);
    step.command.args(["--", "-Dwarnings"]);
    if target == rp2040::TARGET {
        // A scene with drives: without them there is less to check.
        step.command.env("SCENE", rp2040::SCENE);
    }
    step
}

/// Something about every package that is for a host. All at once, so that what they share is compiled
/// once: chosen one by one, they ask for different features of it.
fn on_host(name: &str, command: &str, arguments: &[&str]) -> Step {
    let mut step = step(name, &[command, "--workspace"]);
    for (package, _) in DEVICE_PACKAGES {
        step.command.args(["--exclude", package]);
    }
    step.command.args(arguments);
    step
}

fn step(name: &str, arguments: &[&str]) -> Step {
    let mut command = cargo();
    command.args(arguments);
    Step {
        name: name.into(),
        command,
    }
}

/// The command as one would type it in the root.
fn line(command: &Command) -> String {
    // Cargo is called by its path.
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or_default();
    let words: Vec<_> = iter::once(program)
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect();
    format!("{} (in {})", words.join(" "), root().display())
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_step_can_be_repeated_from_its_message() {
        let step = step("tests", &["test", "-p", "xtask"]);
        assert!(line(&step.command).starts_with("cargo test -p xtask (in "));
    }

    #[test]
    fn every_step_has_a_name_of_its_own() {
        let mut names: Vec<String> = steps().into_iter().map(|step| step.name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
