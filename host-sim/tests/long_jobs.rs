//! Jobs of very many lines: time to plan them, and memory.

#![allow(clippy::disallowed_methods)]

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Most memory of a job of any length, bytes: that of a program, and of the block that each core plans.
fn most_bytes() -> u64 {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    50_000_000 + 60_000_000 * cores as u64
}

/// More memory that a job of three million lines may take than one of a million, bytes. The most that a job takes is that of its two
/// largest blocks at a time: a job of a hundred thousand lines has a dozen blocks, and may not have met such.
const MORE_BYTES: u64 = 10_000_000;

/// Lines of the jobs.
const COUNTS: [u32; 4] = [10_000, 100_000, 1_000_000, 3_000_000];

/// Writes `count` chords of about 0.1 mm along circles of 8 to 20 mm, with another power on each of them.
fn write_job(file: &Path, count: u32) {
    let mut out = BufWriter::new(File::create(file).unwrap());
    writeln!(out, "G21 G90\nG0 X14 Y0\nM4 S500 F6000").unwrap();
    let mut line = String::new();
    for index in 1..=count {
        let (sin, cos) = (f64::from(index) * 7e-3).sin_cos();
        let radius = 14.0 + 6.0 * (f64::from(index) * 2e-5).sin();
        line.clear();
        let (x, y, power) = (radius * cos, radius * sin, 300 + index % 7 * 100);
        let _ = writeln!(line, "G1 X{x:.4} Y{y:.4} S{power}");
        out.write_all(line.as_bytes()).unwrap();
    }
    writeln!(out, "M5\nM2").unwrap();
}

/// Output of `trirrr ARGUMENTS`, its duration, and the most memory that it has had, bytes.
fn measured(folder: &TempDir, arguments: &[&str]) -> (serde_json::Value, Duration, u64) {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/engraving.toml");
    let start = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(arguments)
        .args(["--json", "--origin", "250,300", "--machine"])
        .arg(machine)
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = peak.and_then(|peak| peak.split_whitespace().next()?.parse::<u64>().ok());
        most = most.max(1024 * kilobytes.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(10));
    }
    let elapsed = start.elapsed();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    (
        serde_json::from_slice(&output.stdout).unwrap(),
        elapsed,
        most,
    )
}

/// `cargo test --release -p trirrr-host-sim --test long_jobs -- --ignored --nocapture`
#[test]
#[ignore = "long, and reads /proc: part of `cargo xtask nightly`"]
fn millions_of_lines_are_planned_and_played_in_constant_memory() {
    let folder = TempDir::new().unwrap();
    println!(
        "| lines | moves | motion, s | read and planned, lines a second | memory of `check`, MB | of `run`, MB |"
    );
    println!("|---:|---:|---:|---:|---:|---:|");
    let mut before: Option<[u64; 2]> = None;
    for count in COUNTS {
        write_job(&folder.path().join("long.ngc"), count);
        let (json, elapsed, checked) = measured(&folder, &["check", "long.ngc"]);
        let arguments = ["run", "long.ngc", "--fast", "--every", "1000"];
        let (played, _, run) = measured(&folder, &arguments);
        println!(
            "| {count} | {} | {:.1} | {:.0} | {:.0} | {:.0} |",
            json["moves"],
            json["duration_s"].as_f64().unwrap(),
            f64::from(count) / elapsed.as_secs_f64(),
            checked as f64 / 1e6,
            run as f64 / 1e6,
        );
        assert_eq!(played["end"], "complete", "{played}");
        assert_eq!(played["moves"], json["moves"]);
        assert!(checked.max(run) < most_bytes(), "{checked} {run}");
        if let Some(before) = before.filter(|_| count > 1_000_000) {
            assert!(checked < before[0] + MORE_BYTES, "{before:?} {checked}");
            assert!(run < before[1] + MORE_BYTES, "{before:?} {run}");
        }
        before = Some([checked, run]);
    }
    let table = fs::read_to_string(folder.path().join("out/long/ticks.csv")).unwrap();
    assert!(table.lines().count() > 900);
}

/// A place near the end of a long job at which the machine cannot be: nothing moves, and nothing is written.
#[test]
fn a_line_near_the_end_of_a_long_job_is_refused_before_anything_moves() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("long.ngc");
    write_job(&file, 9000);
    let text = fs::read_to_string(&file).unwrap();
    let far = text.replace("M5\n", "G4 P0.1\nG0 X1000 Y0\nM5\n");
    fs::write(&file, &far).unwrap();
    let line = far.lines().position(|line| line.contains("X1000")).unwrap() + 1;
    let output = Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args([
            "run",
            "long.ngc",
            "--fast",
            "--origin",
            "250,300",
            "--machine",
        ])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/engraving.toml"))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains(&format!("long.ngc:{line}: ")), "{error}");
    assert!(!folder.path().join("out").exists());
}

/// In another time through the file, too: the way back is a part of it.
#[test]
#[ignore = "plans a long job twice: part of `cargo xtask nightly`"]
fn a_short_file_that_is_played_often_is_a_long_job() {
    let folder = TempDir::new().unwrap();
    write_job(&folder.path().join("long.ngc"), 900);
    let often = ["check", "long.ngc", "--repeat", "10"];
    let (in_file, _, _) = measured(&folder, &often);
    // With a figure all of it is in memory.
    let (in_memory, _, _) = measured(&folder, &[&often[..], &["--figure", "path.svg"]].concat());
    assert_eq!(in_file, in_memory);
    assert!(in_file["moves"].as_u64() > Some(900));
}
