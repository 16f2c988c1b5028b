//! What a user asks for while the job runs.

use crate::common::{Device, Streaming, run, scene, stream, text, ticks, trirrr};
use std::io::Write;

fn say(streaming: &mut Streaming, word: &str) {
    let stdin = streaming.process.0.stdin.as_mut().unwrap();
    writeln!(stdin, "{word}").unwrap();
}

fn values(row: &str) -> Vec<f64> {
    row.split(',').map(|field| field.parse().unwrap()).collect()
}

/// A hold leaves neither the path nor the count of its ticks: the poses after it are those of the
/// run, in the bits, and only later.
#[test]
fn a_hold_delays_the_rest_of_the_job() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 4.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &["--keys"]);
    streaming.lines.wait_for("running");
    say(&mut streaming, "hold");
    streaming.lines.wait_for("holding (hold)");
    say(&mut streaming, "resume");
    streaming.lines.wait_for("idle");
    device.lines.wait_for("1 move done");
    assert_eq!(streaming.process.code(), Some(0));

    let (streamed, whole) = (ticks(&streaming.out), run(&folder));
    let rows: Vec<Vec<f64>> = streamed.lines().skip(1).map(values).collect();
    let expected: Vec<Vec<f64>> = whole.lines().skip(1).map(values).collect();
    let later = rows.len() - expected.len();
    assert!(later > 0);
    // It was held before the last second of the job and after its first tick.
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!(first, &expected[0]);
    assert_eq!(last[1..], expected[expected.len() - 1][1..]);
    assert_eq!(last[0], (rows.len() - 1) as f64 / 100.0);
    for (row, expected) in rows[rows.len() - 50..]
        .iter()
        .zip(&expected[expected.len() - 50..])
    {
        assert_eq!(row[1..], expected[1..]);
    }
    // It stood: no velocity at all.
    assert!(
        rows[1..rows.len() - 1]
            .iter()
            .any(|row| row[4..7] == [0.0; 3])
    );
}

#[test]
fn a_stop_ends_the_job_on_its_path() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &["--keys"]);
    streaming.lines.wait_for("running");
    say(&mut streaming, "stop");
    streaming.lines.wait_for("stopping (stop)");
    device.lines.wait_for("idle");
    assert_eq!(streaming.process.code(), Some(0));
}

/// A machine that was stopped, or has played the job, stands where no job starts.
#[test]
fn the_next_job_goes_to_its_start_by_itself() {
    let folder = scene("thesis", &[]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &["--keys"]);
    streaming.lines.wait_for("running");
    say(&mut streaming, "stop");
    streaming.lines.wait_for("stopping (stop)");
    device.lines.wait_for("idle");
    assert_eq!(streaming.process.code(), Some(0));

    for more in [&[] as &[&str], &[], &["--recover", "1"]] {
        let output = stream(&folder, &device.address, more);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(ticks(&folder.path().join("out")), run(&folder));
    }
    device.lines.wait_for("recovering");

    // Parked at the start, there is no way to go.
    let mut park = trirrr();
    park.arg("park")
        .arg(folder.path().join("scene.toml"))
        .args(["--port", &device.address]);
    let output = park.output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(
        text(&output.stdout),
        "parked at x 0.210000 m, y 0.220000 m, alpha 0.157080 rad\n"
    );
    let output = park.args(["--x", "0.9"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let why = text(&output.stderr);
    assert!(
        why.contains("stands at (0.210000 m, 0.220000 m, 0.157080 rad)"),
        "{why}"
    );
    assert!(why.contains("way to (0.900000 m"), "{why}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_the_machine_on_its_path_and_then_the_stream() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &[]);
    streaming.lines.wait_for("running");
    streaming.process.interrupt();
    device.lines.wait_for("stopping (stop)");
    device.lines.wait_for("idle");
    assert_eq!(streaming.process.code(), Some(130));
    device.process.interrupt();
    device.lines.wait_for("ended by Ctrl-C");
    assert_eq!(device.process.code(), Some(0));
}
