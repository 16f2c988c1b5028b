//! Drives that tell where they are: switched on where the machine stands, and shown.

use crate::common::{Device, scene, stream, text, trirrr};
use std::path::Path;
use std::process::Output;

fn tool(name: &str, folder: &Path, address: &str, more: &[&str]) -> Output {
    trirrr()
        .arg(name)
        .arg(folder)
        .args(["--port", address])
        .args(more)
        .output()
        .expect("the program runs")
}

/// A machine that stands beside the start of its job is enabled there, and brought to the start.
#[test]
fn a_machine_is_enabled_where_its_drives_say_that_it_stands() {
    let folder = scene("plant-odrive", &[]);
    let file = folder.path().join("scene.toml");
    let offset = ["--offset-rad", "0.05", "-0.04", "0.03", "--speed", "5"];
    let mut device = Device::start(&folder, &offset);

    let shown = tool(
        "drives",
        &file,
        &device.address,
        &["--lines", "2", "--rate", "50"],
    );
    assert!(shown.status.success(), "{}", text(&shown.stderr));
    let lines = text(&shown.stdout);
    assert_eq!(lines.lines().count(), 2, "{lines}");
    assert!(
        lines.contains("| off ") && !lines.contains("| on "),
        "{lines}"
    );

    let enabled = tool("enable", &file, &device.address, &[]);
    assert!(enabled.status.success(), "{}", text(&enabled.stderr));
    assert!(
        text(&enabled.stdout).starts_with("idle, stands at x 0."),
        "{}",
        text(&enabled.stdout)
    );
    let shown = tool(
        "drives",
        &file,
        &device.address,
        &["--lines", "1", "--rate", "50"],
    );
    let line = text(&shown.stdout);
    assert_eq!(line.matches("| on ").count(), 3, "{line}");

    // A centimetre from the start, and from the end of the job.
    for more in [&[] as &[&str], &["--recover", "1"]] {
        let played = stream(&folder, &device.address, more);
        assert!(played.status.success(), "{}", text(&played.stderr));
    }

    let disabled = tool("disable", &file, &device.address, &[]);
    assert_eq!(text(&disabled.stdout), "disabled\n");
    device.lines.wait_for("disabled");
}

/// Beside its start by less than a count of an encoder, it goes there by itself.
#[test]
fn a_machine_beside_its_start_goes_there_by_itself() {
    let folder = scene("plant-odrive", &[]);
    let offset = [
        "--offset-rad",
        "0.0003",
        "-0.0002",
        "0.0001",
        "--speed",
        "5",
    ];
    let mut device = Device::start(&folder, &offset);
    let played = stream(&folder, &device.address, &[]);
    assert!(played.status.success(), "{}", text(&played.stderr));
    device.lines.wait_for("recovering");
}

#[test]
fn joints_that_fit_no_pose_are_named() {
    let folder = scene("plant-odrive", &[]);
    let file = folder.path().join("scene.toml");
    let device = Device::start(&folder, &["--offset-rad", "2.5", "0", "0"]);
    let enabled = tool("enable", &file, &device.address, &[]);
    assert_eq!(enabled.status.code(), Some(1));
    let why = text(&enabled.stderr);
    assert!(
        why.contains("not enabled: the joints stand at no pose"),
        "{why}"
    );
    let played = stream(&folder, &device.address, &[]);
    assert!(text(&played.stderr).contains("not enabled: the joints stand at no pose"));
}

#[test]
fn drives_that_tell_nothing_are_no_failure_of_the_line() {
    let folder = scene("thesis", &[]);
    let file = folder.path().join("scene.toml");
    let device = Device::start(&folder, &[]);
    let shown = tool("drives", &file, &device.address, &[]);
    assert_eq!(shown.status.code(), Some(2));
    assert!(
        text(&shown.stderr).contains("tell nothing"),
        "{}",
        text(&shown.stderr)
    );
    let enabled = tool("enable", &file, &device.address, &["--clear"]);
    assert!(enabled.status.success(), "{}", text(&enabled.stderr));
}

/// A stream asks for the samples of the drives by itself, and writes them beside their commands.
#[test]
fn a_stream_writes_what_the_drives_tell() {
    let folder = scene("plant-odrive", &[]);
    let device = Device::start(&folder, &["--speed", "5"]);
    let played = stream(&folder, &device.address, &[]);
    assert!(played.status.success(), "{}", text(&played.stderr));
    let said = text(&played.stdout);
    assert!(said.contains("force at the tool at most 0"), "{said}");
    let table = std::fs::read_to_string(folder.path().join("out/drives.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(rows.len() > 400, "{}", rows.len());
    for row in rows {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        // These drives obey exactly: commanded and measured angles, rates and torques are the same.
        for (commanded, measured) in cells[1..10].iter().zip(&cells[10..19]) {
            assert!((commanded - measured).abs() < 2e-6, "{row}");
        }
        // x, y, alpha, then how far that is off.
        assert!(cells[22] < 2e-6 && cells[23].abs() < 2e-5, "{row}");
    }
}
