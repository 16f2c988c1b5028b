//! A calibration that is sent to a board.

use crate::common::{Device, scene, stream, text, ticks, trirrr};
use serde_json::Value;
use std::process::Output;
use tempfile::TempDir;

const TABLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../scenes/measurements/thesis.csv"
);

fn calibrate(folder: &TempDir, port: &str, more: &[&str]) -> Output {
    let mut command = trirrr();
    command.args(["calibrate", "scene.toml", TABLE, "--port", port, "--json"]);
    command.args(more).current_dir(folder).output().unwrap()
}

/// Motor angles of each row of a table.
fn angles(table: &str) -> Vec<[f64; 3]> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let places = ["th1_1", "th1_2", "th1_3"]
        .map(|name| names.iter().position(|other| *other == name).unwrap());
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.map(|place| cells[place].parse().unwrap())
    };
    lines.map(row).collect()
}

#[test]
fn a_board_with_the_calibrated_legs_moves_as_an_image_of_the_calibrated_scene() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);

    // Another scene than the board's: nothing is sent and nothing written.
    let other = ["--joints-placed", "--set", "platform.mass_kg=0.6"];
    let other = calibrate(&folder, &device.address, &other);
    let why = text(&other.stderr);
    assert_eq!(other.status.code(), Some(2), "{why}");
    assert!(why.contains("built for another scene"), "{why}");
    assert!(!folder.path().join("out").exists());

    // A machine that is off knows no pose.
    let off = calibrate(&folder, &device.address, &["--joints-placed"]);
    let why = text(&off.stderr);
    assert_eq!(off.status.code(), Some(2), "{why}");
    assert!(why.contains("disabled (`trirrr enable`"), "{why}");
    let on = trirrr()
        .args(["enable", "scene.toml", "--port", &device.address])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(on.status.success(), "{}", text(&on.stderr));

    let sent = calibrate(&folder, &device.address, &["--joints-placed"]);
    assert!(sent.status.success(), "{}", text(&sent.stderr));
    let found: Value = serde_json::from_slice(&sent.stdout).unwrap();
    let board = &found["board"];
    assert!(board["without_offsets"].is_null(), "{board}");
    // Motors that stand still hold the platform elsewhere than the nominal legs say: by about what the parts are off.
    let at = |name: &str, axis: usize| board[name][axis].as_f64().unwrap();
    let way = (at("stands", 0) - at("stood", 0)).hypot(at("stands", 1) - at("stood", 1));
    assert!((1e-4..5e-3).contains(&way), "{board}");

    // The job of the nominal scene is in poses: the board finds the angles.
    let streamed = stream(&folder, &device.address, &[]);
    assert!(streamed.status.success(), "{}", text(&streamed.stderr));
    let copy = "out/thesis-calibration/scene.toml";
    let run = trirrr()
        .args(["run", copy, "--fast", "--out", "wanted"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    let nominal = angles(&crate::common::run(&folder));
    let (found, wanted) = (
        angles(&ticks(&folder.path().join("out"))),
        angles(&ticks(&folder.path().join("wanted"))),
    );
    assert_eq!(found.len(), wanted.len());
    for ((found, wanted), nominal) in found.iter().zip(&wanted).zip(&nominal) {
        for motor in 0..3 {
            // The copy of the scene has 12 digits.
            assert!((found[motor] - wanted[motor]).abs() < 1e-9);
        }
        let most = (0..3).map(|motor| (found[motor] - nominal[motor]).abs());
        assert!(most.fold(0.0, f64::max) > 1e-4);
    }
}

/// The machine of the measurements has encoders that are far off: its calibrated legs with the nominal zeros would be worse than nothing.
#[test]
fn legs_that_make_nothing_better_without_encoder_offsets_are_not_sent() {
    let folder = scene("thesis", &[]);
    // No board is needed to know that.
    let sent = calibrate(&folder, "tcp:127.0.0.1:1", &[]);
    let why = text(&sent.stderr);
    assert_eq!(sent.status.code(), Some(2), "{why}");
    for part in [
        "897.5 um",
        "851.0 um",
        "motor 1 stands at +0.0019",
        "--joints-placed",
    ] {
        assert!(why.contains(part), "{part}: {why}");
    }
    assert!(!folder.path().join("out").exists());
}
