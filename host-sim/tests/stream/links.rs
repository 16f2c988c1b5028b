//! Lines that fail, and lines of another kind.

use crate::common::{Device, Streaming, run, scene, stream, text, ticks};
use crate::proxy;

/// The line is cut in the middle of the job and is there again a moment later: the machine goes on
/// meanwhile, and the stream finds it where it is.
#[test]
fn a_line_that_is_cut_costs_samples_and_nothing_else() {
    let folder = scene("chained", &[]);
    let device = Device::start(&folder, &["--speed", "2"]);
    // Somewhere in the first half of some 8000 samples of 90 bytes and more.
    let port = proxy::cut_once(&device.address, 200_000);
    let output = stream(&folder, &port, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    assert!(summary.contains("22 of 22 moves done\n"), "{summary}");
    assert!(summary.contains("port opened anew 1 times"), "{summary}");
    let (streamed, whole) = (ticks(&folder.path().join("out")), run(&folder));
    let mut rows = whole.lines();
    for row in streamed.lines() {
        // In the order of the run; what is between was lost.
        assert!(rows.any(|other| other == row), "{row}");
    }
    assert_eq!(streamed.lines().next(), whole.lines().next());
    assert_eq!(streamed.lines().last(), whole.lines().last());
    let missing = whole.lines().count() - streamed.lines().count();
    assert!(
        summary.contains(&format!("{missing} missing")),
        "{missing}\n{summary}"
    );
}

#[test]
fn a_board_that_is_switched_off_is_given_up() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &["--patience", "1"]);
    device.lines.wait_for("running");
    streaming.lines.wait_for("running");
    device.process.kill();
    let message = streaming.lines.rest();
    assert_eq!(streaming.process.code(), Some(1), "{message}");
    assert!(message.contains("nothing listens there"), "{message}");
    assert!(message.contains("nothing was heard for"), "{message}");
    // What had come is written.
    assert!(ticks(&streaming.out).lines().count() > 1);
    assert!(streaming.out.join("machine.svg").exists());
}

#[test]
fn a_board_that_does_not_answer_is_given_up() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let _open: Vec<_> = listener.incoming().collect();
    });
    let folder = scene("thesis", &[]);
    let output = stream(&folder, &address, &["--patience", "0.5"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the board does not answer"), "{message}");
    assert!(message.contains("nothing was heard for"), "{message}");
    assert!(text(&output.stdout).contains("did not answer"));
}

/// A client that dies leaves the machine to itself: it comes to rest on its path and waits. It is not free for another job, but can be
/// talked to.
#[test]
fn a_machine_without_a_host_waits() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 10.0")]);
    let file = folder.path().join("scene.toml");
    let text_of = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text_of.replace("timeout_s = 600", "timeout_s = 0.5")).unwrap();
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &[]);
    streaming.lines.wait_for("running");
    device.lines.wait_for("running");
    let ticks = folder.path().join("out/ticks.csv");
    // The first samples are written behind the first words.
    for _ in 0..3000 {
        if ticks.is_file() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    streaming.process.kill();
    device.lines.wait_for("is gone");
    device.lines.wait_for("slowing (host silent)");
    device.lines.wait_for("holding (host silent)");
    let output = stream(&folder, &device.address, &[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("the machine is not free: holding"),
        "{message}"
    );
    // Telemetry up to the kill is not lost by that stream.
    assert!(ticks.is_file());
}

#[test]
fn one_client_at_a_time() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut first = Streaming::start(&folder, &device.address, &["--keys"]);
    first.lines.wait_for("running");
    let second =
        crate::common::stream_command(&folder, &device.address, "second", &["--patience", "0.3"])
            .output()
            .unwrap();
    let message = text(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{message}");
    assert!(
        message.contains("another client has the machine"),
        "{message}"
    );
    device.lines.wait_for("is turned away");
    for command in ["enable", "goto"] {
        let mut command = [command, "scene.toml", "--port", &device.address].to_vec();
        if command[0] == "goto" {
            command.extend(["--x", "0.25", "--y", "0.25", "--patience", "0.3"]);
        }
        let output = crate::common::trirrr()
            .args(&command)
            .current_dir(&folder)
            .output()
            .unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(
            message.contains("another client has the machine"),
            "{message}"
        );
    }
    // The first has not noticed.
    use std::io::Write;
    writeln!(first.process.0.stdin.as_mut().unwrap(), "stop").unwrap();
    first.lines.wait_for("idle");
    assert_eq!(first.process.code(), Some(0));
}

#[cfg(unix)]
#[test]
fn a_serial_port_carries_the_same() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let port = proxy::serial(&device.address);
    let output = stream(&folder, &port, &["--baud", "921600", "--telemetry", "1"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(ticks(&folder.path().join("out")), run(&folder));
}

#[test]
fn ports_that_are_not_there_are_named() {
    let folder = scene("thesis", &[]);
    for (port, reason) in [
        ("/dev/tty-that-is-not-there", "no such port"),
        ("tcp:127.0.0.1:1", "nothing listens there"),
    ] {
        let output = stream(&folder, port, &[]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(
            message.contains(port) && message.contains(reason),
            "{message}"
        );
    }
    let output = stream(&folder, "tcp:nowhere", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("tcp:HOST:PORT"));
}
