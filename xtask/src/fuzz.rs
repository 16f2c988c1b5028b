//! `cargo xtask fuzz`: coverage-guided fuzzing of the targets in `tests/fuzz/` with stable Rust.
//!
//! What `cargo fuzz` adds to the compiler's arguments is stable too, but for the address sanitizer,
//! which finds nothing in code without `unsafe`. So CI needs neither a nightly toolchain nor cargo-fuzz; with
//! both, `cargo +nightly fuzz run TARGET ../../target/fuzz-corpus/TARGET` works in the same folder.

use crate::repository::{cargo, root, rustc, target_directory};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Passes and options of LLVM that libFuzzer's feedback needs.
const COVERAGE: &str = "-Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares \
    -Ccodegen-units=1";

/// The longest input, bytes.
const LONGEST: u32 = 512;

#[derive(Args)]
pub(crate) struct FuzzArgs {
    /// Targets; all without
    targets: Vec<String>,
    /// Inputs to try for each target
    #[arg(long, default_value_t = 10_000)]
    runs: u64,
    /// Fuzz for so many seconds in place of a number of inputs
    #[arg(long)]
    seconds: Option<u64>,
    /// Add inputs that cover more to the corpus of the target, tests/fuzz/corpus/TARGET.hex
    #[arg(long)]
    keep: bool,
}

pub(crate) fn run(arguments: &FuzzArgs) -> Result<()> {
    let fuzz = root().join("tests/fuzz");
    let known = targets()?;
    for target in &arguments.targets {
        ensure!(
            known.contains(target),
            "{target}: no fuzz target; there are {}",
            known.join(", ")
        );
    }
    let chosen = match arguments.targets.as_slice() {
        [] => &known,
        some => some,
    };
    // Named, so that build scripts are not compiled for the fuzzer.
    let host = host()?;
    let build = target_directory().join("fuzz");
    let status = cargo()
        .args([
            "build",
            "--quiet",
            "--release",
            "--manifest-path",
            "tests/fuzz/Cargo.toml",
        ])
        .args(["--target", &host])
        .arg("--target-dir")
        .arg(&build)
        .env("RUSTFLAGS", COVERAGE)
        .status()
        .context("cargo cannot be run")?;
    ensure!(status.success(), "the fuzz targets cannot be built");
    for target in chosen {
        let program = build.join(&host).join("release").join(target);
        let corpus = unpack(target)?;
        // Findings go here, so that a run leaves the corpus as it is.
        let found = target_directory().join("fuzz-found").join(target);
        fs::create_dir_all(&found)?;
        let artifacts = fuzz.join("artifacts").join(target);
        fs::create_dir_all(&artifacts)?;
        let mut fuzzer = Command::new(&program);
        fuzzer
            .arg(format!("-max_len={LONGEST}"))
            .arg("-seed=1")
            .arg("-print_final_stats=1")
            .arg("-verbosity=0")
            .arg(format!("-artifact_prefix={}/", artifacts.display()));
        match arguments.seconds {
            Some(seconds) => fuzzer.arg(format!("-max_total_time={seconds}")),
            None => fuzzer.arg(format!("-runs={}", arguments.runs)),
        };
        // New inputs go to the first folder.
        if !arguments.keep {
            fuzzer.arg(&found);
        }
        fuzzer.arg(&corpus);
        println!("{target}:");
        let status = fuzzer
            .status()
            .with_context(|| program.display().to_string())?;
        if !status.success() {
            bail!("{target}: an input breaks it, see {}", artifacts.display());
        }
        if arguments.keep {
            pack(target, &corpus)?;
        }
    }
    Ok(())
}

/// Corpus of a target: one input a line, in hexadecimal digits.
fn packed(target: &str) -> PathBuf {
    root().join(format!("tests/fuzz/corpus/{target}.hex"))
}

/// Writes each input of the corpus of `target` into a file, as the fuzzer reads it. Returns the folder.
fn unpack(target: &str) -> Result<PathBuf> {
    let folder = target_directory().join("fuzz-corpus").join(target);
    if folder.is_dir() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let packed = packed(target);
    let text = fs::read_to_string(&packed).with_context(|| packed.display().to_string())?;
    for (index, line) in text.lines().enumerate() {
        let byte = |at: usize| {
            line.get(at..at + 2)
                .and_then(|two| u8::from_str_radix(two, 16).ok())
        };
        let bytes: Option<Vec<u8>> = (0..line.len()).step_by(2).map(byte).collect();
        let bytes =
            bytes.with_context(|| format!("{}:{}: no bytes", packed.display(), index + 1))?;
        fs::write(folder.join(format!("{index:05}")), bytes)?;
    }
    Ok(folder)
}

/// Writes the inputs in `folder` as the corpus of `target`: those that it had, in their order, and what the fuzzer has added.
fn pack(target: &str, folder: &Path) -> Result<()> {
    let files = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut files: Vec<PathBuf> = files.collect::<Result<_>>()?;
    files.sort();
    let mut text = String::new();
    for file in files {
        let digits = fs::read(&file)?;
        text.extend(digits.iter().map(|byte| format!("{byte:02x}")));
        text.push('\n');
    }
    let packed = packed(target);
    fs::write(&packed, text).with_context(|| packed.display().to_string())
}

/// The targets, by their files.
fn targets() -> Result<Vec<String>> {
    let folder = root().join("tests/fuzz/fuzz_targets");
    let mut names = Vec::new();
    for entry in fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if let Some(name) = path.file_stem().and_then(|stem| stem.to_str()) {
            names.push(name.to_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// The triple of this machine.
fn host() -> Result<String> {
    let text = rustc("-vV")?;
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).context("rustc -vV names no host")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_a_corpus_that_is_unpacked_and_packed_unchanged() {
        let targets = targets().unwrap();
        assert!(targets.len() >= 2);
        for target in targets {
            let text = fs::read(packed(&target)).unwrap();
            let folder = unpack(&target).unwrap();
            assert!(fs::read_dir(&folder).unwrap().count() >= 10, "{target}");
            pack(&target, &folder).unwrap();
            assert_eq!(fs::read(packed(&target)).unwrap(), text, "{target}");
        }
    }
}
