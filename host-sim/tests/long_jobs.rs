//! Jobs of very many lines: time to plan them, and memory.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Most memory that a line may take, bytes.
const LINE_BYTES: u64 = 1_000;

/// Memory of a program and of a short job, bytes.
const BASE_BYTES: u64 = 120_000_000;

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
fn a_million_lines_are_planned_and_played() {
    let folder = TempDir::new().unwrap();
    println!("| lines | moves | motion, s | read and planned, lines a second | memory, MB |");
    println!("|---:|---:|---:|---:|---:|");
    for count in [10_000, 100_000, 1_000_000] {
        write_job(&folder.path().join("long.ngc"), count);
        let (json, elapsed, memory) = measured(&folder, &["check", "long.ngc"]);
        println!(
            "| {count} | {} | {:.1} | {:.0} | {:.0} |",
            json["moves"],
            json["duration_s"].as_f64().unwrap(),
            f64::from(count) / elapsed.as_secs_f64(),
            memory as f64 / 1e6
        );
        assert!(memory < BASE_BYTES + u64::from(count) * LINE_BYTES);
    }
    let arguments = ["run", "long.ngc", "--fast", "--every", "1000"];
    let (json, _, memory) = measured(&folder, &arguments);
    assert_eq!(json["end"], "complete", "{json}");
    assert!(memory < BASE_BYTES + 1_000_000 * LINE_BYTES);
    let table = fs::read_to_string(folder.path().join("out/long/ticks.csv")).unwrap();
    assert!(table.lines().count() > 900);
}
