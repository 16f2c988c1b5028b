//! A board that gets geometry and plans it itself.

use crate::common::{Device, stream, text, ticks};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The scene `paths/onboard` with `edits`.
fn onboard(edits: &[(&str, &str)]) -> TempDir {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/paths/onboard.toml");
    let mut text = fs::read_to_string(file).unwrap();
    let patient = ("[service]\n", "[service]\nsilence_timeout_s = 600\n");
    for (from, to) in edits.iter().chain([&patient]) {
        assert_eq!(text.matches(from).count(), 1, "{from:?}");
        text = text.replace(from, to);
    }
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

#[test]
fn a_board_plans_the_pieces_that_it_gets() {
    let folder = onboard(&[]);
    let device = Device::start(&folder, &["--speed", "5"]);
    let output = stream(&folder, &device.address, &["--path"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    for part in [
        "12 of 12 pieces done\n",
        "one every tick, 0 missing",
        "machine.svg",
    ] {
        assert!(summary.contains(part), "{part} in\n{summary}");
    }
    // Columns by name: where the platform is, and how fast.
    let table = ticks(&folder.path().join("out"));
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let column = |name: &str| header.iter().position(|each| *each == name).unwrap();
    let [x, y, vx, vy, tool] = ["x", "y", "vx", "vy", "tool"].map(column);
    let number = |row: &Vec<&str>, column: usize| row[column].parse::<f64>().unwrap();
    let (mut least, mut most) = ([f64::INFINITY; 2], [0.0f64; 2]);
    let mut last = [0.0; 2];
    for row in rows {
        last = [number(&row, x), number(&row, y)];
        for axis in 0..2 {
            least[axis] = least[axis].min(last[axis]);
            most[axis] = most[axis].max(last[axis]);
        }
        let speed = number(&row, vx).hypot(number(&row, vy));
        // The ways to the circle and back are as fast as the machine can, with the beam off.
        let is_on = number(&row, tool) > 0.0;
        assert!(!is_on || speed <= 0.25 * (1.0 + 1e-5), "{speed} m/s");
    }
    // The plate is 140 mm by 90 mm, and the circle lies within it.
    for (found, drawn) in least.iter().chain(&most).zip([0.18, 0.245, 0.32, 0.335]) {
        assert!((found - drawn).abs() < 2e-5, "{found} m for {drawn} m");
    }
    assert!((last[0] - 0.25).abs() < 1e-6, "{last:?}");
}

#[test]
fn a_board_without_a_planner_says_so() {
    let folder = onboard(&[("plans_paths = true\n", "")]);
    let device = Device::start(&folder, &["--speed", "5"]);
    let output = stream(&folder, &device.address, &["--path"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    let error = text(&output.stderr);
    assert!(error.contains("plans no paths: set plans_paths"), "{error}");
}
