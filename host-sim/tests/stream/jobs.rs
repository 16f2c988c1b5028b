//! A job in a file of its own, on a board with the image of the machine's scene.

use crate::common::{Device, text};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder with the scene `name`, whose host may be silent for long.
fn scene(name: &str) -> TempDir {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name);
    let text = fs::read_to_string(file).unwrap();
    let folder = TempDir::new().unwrap();
    let patient = "[service]\nsilence_timeout_s = 600\n";
    let text = text.replace("[service]\n", patient);
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

fn stream(folder: &TempDir, job: &str, address: &str) -> Output {
    fs::write(folder.path().join("job.ngc"), job).unwrap();
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(["stream", "job.ngc", "--machine", "scene.toml"])
        .args(["--port", address, "--origin", "250,245"])
        .current_dir(folder)
        .output()
        .unwrap()
}

const JOB: &str = "G21 G90\nM4 S500 F6000\nG1 X20\nG3 X30 Y10 I0 J10\nM5\nG0 X0 Y20\n";

/// The second job begins elsewhere than the first one ends: the machine goes there by itself.
#[test]
fn one_job_after_the_other_is_streamed() {
    let folder = scene("engraving.toml");
    let device = Device::start(&folder, &["--speed", "5"]);
    for time in 0..3 {
        let output = stream(&folder, JOB, &device.address);
        assert!(output.status.success(), "{time}: {}", text(&output.stderr));
        let summary = text(&output.stdout);
        assert!(summary.contains("0 missing"), "{time}: {summary}");
        assert!(folder.path().join("out/job-stream/ticks.csv").is_file());
    }
}

#[test]
fn what_a_board_does_not_play_is_refused_before_it_moves() {
    let folder = scene("engraving.toml");
    let output = stream(&folder, "G21\nG1 X5 F600\nM0\nG1 X0\n", "tcp:127.0.0.1:1");
    assert_eq!(output.status.code(), Some(2));
    let error = text(&output.stderr);
    assert!(
        error.contains("job.ngc:3: the job waits for the user"),
        "{error}"
    );
    // The image of a scene with cubics alone.
    let folder = scene("chained.toml");
    let output = stream(&folder, JOB, "tcp:127.0.0.1:1");
    assert_eq!(output.status.code(), Some(2));
    let error = text(&output.stderr);
    assert!(error.contains("plays no planned moves"), "{error}");
}
