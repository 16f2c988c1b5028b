//! Emergency stop and door of a device.

use crate::common::{Device, Lines, Process, Streaming, run, scene, stream, text, ticks, trirrr};
use std::io::Write;
use std::process::Stdio;

/// The guarded scene; its machine is beside it.
fn guarded(edits: &[(&str, &str)]) -> tempfile::TempDir {
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/thesis.toml");
    let machine = format!("{machine:?}");
    // `scene` puts a `[service]` in: that of this scene goes.
    let own = "[service]\nhold_ramp_s = 0.1\nsilence_timeout_s = 1.0\n\n";
    let all = [
        &[("\"../thesis.toml\"", machine.as_str()), (own, "")],
        edits,
    ]
    .concat();
    scene("inputs/guarded", &all)
}

/// The job waits while the door is open, with the tool off, and is the same job.
#[test]
fn a_job_waits_behind_an_open_door_until_the_user_resumes() {
    let folder = guarded(&[]);
    let mut device = Device::start(&folder, &["--keys", "--watch", "tcp:127.0.0.1:0"]);
    let mut keys = device.process.0.stdin.take().expect("a pipe");
    let port = device.lines.wait_for("takes watchers");
    let port = port.split(' ').next().expect("an address");
    let mut watch = trirrr()
        .args(["watch", "--port", port])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut watched = Lines::of(watch.stdout.take().unwrap());
    let _watch = Process(watch);
    let mut streaming = Streaming::start(&folder, &device.address, &["--keys"]);
    let mut user = streaming.process.0.stdin.take().expect("a pipe");
    streaming.lines.wait_for("running");
    writeln!(keys, "door").unwrap();
    let said = streaming.lines.wait_for("door open");
    assert!(!said.contains("emergency stop"), "no change of it: {said}");
    streaming
        .lines
        .wait_for("holding (door): close the door, then r goes on");
    watched.wait_for("door open");
    writeln!(user, "resume").unwrap();
    streaming
        .lines
        .wait_for("refused: the door is open: nothing moves before it is closed");
    writeln!(keys, "d").unwrap();
    streaming.lines.wait_for("door closed");
    writeln!(user, "resume").unwrap();
    streaming
        .lines
        .wait_for("the door was opened on the way: back to move");
    let out = streaming.out.clone();
    assert_eq!(
        streaming.process.code(),
        Some(0),
        "{}",
        streaming.lines.rest()
    );
    // The tool goes on at the very place at which it went off, and the rest is that of a run.
    let (first, rest) = (ticks(&out), ticks(&out.join("resumed-1")));
    let tool = |row: &str| {
        row.rsplit(',')
            .next()
            .and_then(|tool| tool.parse::<f64>().ok())
    };
    let with_tool = |row: &&str| tool(row) != Some(0.0);
    let last = pose(first.lines().rfind(with_tool).unwrap());
    let next = pose(rest.lines().skip(1).find(with_tool).unwrap());
    let way = (last[0] - next[0]).hypot(last[1] - next[1]);
    assert!(way < 1e-6, "{way} m from {last:?} to {next:?}");
    let whole = run(&folder);
    assert_eq!(
        rest.lines().last().map(pose),
        whole.lines().last().map(pose)
    );
}

/// x, y and alpha of a row.
fn pose(row: &str) -> [f64; 3] {
    let mut values = row.split(',').skip(1).map(|value| value.parse().unwrap());
    [(); 3].map(|()| values.next().unwrap())
}

/// A stop ends the job with a fault in words; it is acknowledged once it is released.
#[test]
fn an_emergency_stop_ends_the_job_and_is_acknowledged_once_it_is_released() {
    let folder = guarded(&[]);
    let mut device = Device::start(&folder, &["--press", "estop@0..0.2", "--keys"]);
    let mut keys = device.process.0.stdin.take().expect("a pipe");
    // Pressed when it was switched on.
    device
        .lines
        .wait_for("fault: the emergency stop was pressed");
    device.lines.wait_for("emergency stop released");
    let enable = |more: &[&str]| {
        let mut command = trirrr();
        command.args(["enable", "scene.toml", "--port", &device.address]);
        command.args(more).current_dir(&folder).output().unwrap()
    };
    let output = enable(&[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the emergency stop was pressed, or its wire is broken"));
    let output = enable(&["--clear"]);
    assert!(output.status.success(), "{}", text(&output.stderr));

    let mut streaming = Streaming::start(&folder, &device.address, &["--recover", "1"]);
    streaming.lines.wait_for("running");
    writeln!(keys, "e").unwrap();
    let code = streaming.process.code();
    let said = streaming.lines.rest();
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("emergency stop pressed"), "{said}");
    assert!(
        said.contains("release it, then acknowledge the fault (tick "),
        "{said}"
    );
    let output = enable(&["--clear"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("release it before the fault is acknowledged"),
        "{message}"
    );
    writeln!(keys, "e").unwrap();
    device.lines.wait_for("emergency stop released");
    let output = stream(&folder, &device.address, &["--recover", "1"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn an_input_that_the_scene_does_not_name_cannot_be_pressed() {
    let folder = scene("thesis", &[]);
    for (arguments, why) in [
        (&["--press", "door@1"][..], "[inputs.door] in it would"),
        (&["--keys"], "names none"),
        (&["--touch", "x=0.25"], "[inputs.probe] in it would"),
        (&["--press", "limit3@1"], "[inputs.limits] in it would"),
        (
            &["--press", "lid@1"],
            "\"lid\" is no input of scene thesis: estop, door, probe",
        ),
    ] {
        let output = trirrr()
            .args(["device", "scene.toml", "--listen", "tcp:127.0.0.1:0"])
            .args(arguments)
            .current_dir(&folder)
            .output()
            .unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(why), "{message}");
    }
}
