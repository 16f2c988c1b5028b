//! A long job of G-code, whose moves come from a file.

use crate::common::{Device, Lines, Process, text};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Chords along circles: more of them than are held in memory.
const CHORDS: u32 = 12_600;

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/engraving.toml");
    let scene = fs::read_to_string(scene).unwrap();
    let timeout = "[service]\nsilence_timeout_s = 0.5\n";
    fs::write(
        folder.path().join("scene.toml"),
        scene.replace("[service]\n", timeout),
    )
    .unwrap();
    let mut job = String::from("G21 G90\nG0 X12 Y0\nM4 S500 F6000\n");
    for index in 1..=CHORDS {
        let (sin, cos) = (f64::from(index) * 3.3e-3).sin_cos();
        // The machine may stand where the tool is off.
        let power = if index % 500 == 0 { 0 } else { 500 };
        let _ = writeln!(job, "G1 X{:.4} Y{:.4} S{power}", 12.0 * cos, 12.0 * sin);
    }
    job += "M5\nM2\n";
    fs::write(folder.path().join("job.ngc"), job).unwrap();
    folder
}

fn command(folder: &TempDir, name: &str, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"));
    command
        .args([name, "job.ngc", "--machine", "scene.toml"])
        .args(["--origin", "250,260", "--out", name])
        .args(more)
        .current_dir(folder);
    command
}

/// A stream under way, and its standard error.
fn start(folder: &TempDir, address: &str, more: &[&str]) -> (Process, Lines) {
    let mut child = command(folder, "stream", &[&["--port", address], more].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = Lines::of(child.stderr.take().unwrap());
    (Process(child), lines)
}

/// Rows of the table in `out` without the time, which counts from the first sample of each stream.
fn rows(folder: &TempDir, out: &str) -> Vec<String> {
    let table = fs::read_to_string(folder.path().join(out).join("ticks.csv")).unwrap();
    let behind = |row: &str| row.split_once(',').unwrap().1.to_owned();
    table.lines().skip(1).map(behind).collect()
}

/// Waits until the journal of the stream says that the machine has reached a move.
fn reach(folder: &TempDir, index: u64) {
    let journal = folder.path().join("stream/job.json");
    loop {
        let text = fs::read_to_string(&journal).unwrap_or_default();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        if value["reached"]["index"].as_u64() >= Some(index) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The host is killed on the way, then host and machine: each time the job goes on at its place, and ends as one that was never left.
#[test]
fn a_long_job_goes_on_on_a_machine_that_waits_and_on_one_that_has_lost_it() {
    let folder = folder();
    let output = command(&folder, "run", &["--fast"]).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let whole = rows(&folder, "run");
    let summary = text(&output.stdout);
    let moves = summary.lines().find_map(|line| {
        let (count, _) = line.strip_prefix("job ")?.split_once(" moves")?;
        count.trim().parse().ok()
    });
    let moves: u64 = moves.expect("a number of moves");

    let mut device = Device::start(&folder, &[]);
    let (stream, _lines) = start(&folder, &device.address, &[]);
    reach(&folder, moves / 5);
    stream.kill();
    device.lines.wait_for("holding (host silent)");

    // It waits: the job goes on at the very bit.
    let (stream, _lines) = start(&folder, &device.address, &["--resume"]);
    // In the second of three blocks.
    reach(&folder, moves / 2);
    stream.kill();
    device.process.kill();

    // It is new, and knows of nothing: back to the place, along the job, with the tool off.
    let device = Device::start(&folder, &[]);
    let resumed = ["--resume", "--recover", "0.3", "--port", &device.address];
    let output = command(&folder, "stream", &resumed).output().unwrap();
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(
        message.contains("the machine has lost the job: back to move"),
        "{message}"
    );
    let last = rows(&folder, "stream/resumed-2");
    let tool = |row: &str| row.rsplit(',').next().unwrap().parse::<f64>().unwrap();
    let on = last.iter().position(|row| tool(row) != 0.0).unwrap();
    // The way back is on the path of the job, up to the place; from there on all is as in the whole job.
    let tail = &last[on + 1..];
    assert!(on > 0 && tail.len() > 500, "{on} {}", tail.len());
    assert!(whole.len() > last.len(), "{} {}", whole.len(), last.len());
    assert_eq!(&tail[tail.len() - 500..], &whole[whole.len() - 500..]);
    assert!(!folder.path().join("stream/job.json").exists());
}
