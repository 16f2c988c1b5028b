//! Watchers of a device.

use crate::common::{Device, Lines, Process, run, scene, stream, text, ticks, trirrr};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Stdio;

/// Address of the port for watchers.
fn watch_address(device: &mut Device) -> String {
    let line = device.lines.wait_for("takes watchers");
    line.split(' ').next().unwrap().into()
}

/// `trirrr watch` in the background.
fn watch(port: &str, more: &[&str]) -> (Process, Lines) {
    let mut child = trirrr()
        .args(["watch", "--port", port])
        .args(more)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = Lines::of(child.stdout.take().unwrap());
    (Process(child), lines)
}

#[test]
fn watchers_see_the_job_from_its_begin_and_from_its_middle() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 3.0")]);
    let mut device = Device::start(
        &folder,
        &["--scalar", "fixed", "--watch", "tcp:127.0.0.1:0"],
    );
    let port = watch_address(&mut device);
    let (first, mut lines) = watch(&port, &[]);
    device.lines.wait_for("watcher 127.0.0.1");
    let (second, mut json) = watch(&port, &["--json"]);
    device.lines.wait_for("watcher 127.0.0.1");
    let output = stream(&folder, &device.address, &["--scalar", "fixed"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    lines.wait_for("a client said hello: scene thesis in fixed, 100 ticks per second");
    lines.wait_for("running, 0 moves done");
    let pose = lines.wait_for(" rad, running, 0 moves done");
    assert!(
        pose.contains("x 0.2") && pose.contains(" m, y 0.2"),
        "{pose}"
    );
    lines.wait_for("running, 1 move done");
    let state = json.wait_for("\"state\":\"running\"");
    assert!(
        state.contains("\"moves_done\":0") && state.contains("\"pose\":[0.2"),
        "{state}"
    );
    let (third, mut lines) = watch(&port, &[]);
    lines.wait_for("a client said hello: scene thesis in fixed");
    lines.wait_for("idle, 1 move done");
    drop((first, second, third));
    device.lines.wait_for("watcher");
    device.lines.wait_for("is gone: closed by the far end");
}

/// Watchers that do not read, that talk, or that are too many cost the job nothing.
#[test]
fn watchers_disturb_nobody() {
    let folder = scene("thesis", &[]);
    let mut device = Device::start(&folder, &["--watch", "tcp:127.0.0.1:0"]);
    let port = watch_address(&mut device);
    let port = port.strip_prefix("tcp:").unwrap();
    let mut talks = TcpStream::connect(port).unwrap();
    talks.write_all(b"\x02\x07\x0b\x03").unwrap();
    device.lines.wait_for("a watcher sends nothing, and it did");
    // The link was closed, with a reset where something was not read: this ends.
    let _ = talks.read_to_end(&mut Vec::new());
    let silent: Vec<_> = (0..17).map(|_| TcpStream::connect(port).unwrap()).collect();
    device.lines.wait_for("turned away: 16 others watch");
    let output = stream(&folder, &device.address, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(ticks(&folder.path().join("out")), run(&folder));
    drop(silent);
}
