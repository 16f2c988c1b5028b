//! `trirrr bridge`: a board's line behind a TCP port.

use crate::common::{Device, run, scene, stream, text, ticks, trirrr};
use std::io::{Read, Write};
use std::net::TcpStream;

/// A machine with a key, and the way to it for clients without one.
#[test]
fn a_bridge_carries_a_job_with_the_bits_of_the_run() {
    let folder = scene("thesis", &[]);
    let key = trirrr().args(["key", "key"]).current_dir(&folder).status();
    assert!(key.unwrap().success());
    for scalar in ["f64", "f32"] {
        let board = Device::start(&folder, &["--key", "key", "--scalar", scalar]);
        let mut bridge = Device::start_as(
            &folder,
            &[
                "bridge",
                "--port",
                &board.address,
                "--far-key",
                "key",
                "--listen",
                "tcp:127.0.0.1:0",
                "--watch",
                "tcp:127.0.0.1:0",
            ],
        );
        bridge.lines.wait_for("takes watchers");
        let output = stream(&folder, &bridge.address, &["--scalar", scalar]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        bridge.lines.wait_for("is gone: closed by the far end");
        if scalar == "f64" {
            assert_eq!(ticks(&folder.path().join("out")), run(&folder));
        }
    }
}

#[cfg(unix)]
#[test]
fn a_bridge_carries_a_serial_line() {
    let folder = scene("thesis", &[]);
    let board = Device::start(&folder, &[]);
    let port = crate::proxy::serial(&board.address);
    let bridge = Device::bridge(&folder, &port);
    let output = stream(&folder, &bridge.address, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(ticks(&folder.path().join("out")), run(&folder));
}

#[test]
fn a_browser_does_not_reach_the_board() {
    let folder = scene("thesis", &[]);
    let mut board = Device::start(&folder, &[]);
    let mut bridge = Device::bridge(&folder, &board.address);
    board.lines.wait_for("is connected");
    let mut browser = TcpStream::connect(bridge.address.strip_prefix("tcp:").unwrap()).unwrap();
    // A frame in the body, behind a zero: the hello of docs/wire.md.
    let hello = b"\x02\x07\x0b\x03\xbc\xd9\xf0\xe6\xb0\xdd\xc0\x8c\x26\x05\x32\x1a\x83\x6e\x00";
    let post = [
        b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n\x00",
        &hello[..],
    ]
    .concat();
    browser.write_all(&post).unwrap();
    bridge.lines.wait_for("does not speak the protocol");
    assert!(
        browser
            .read(&mut [0; 16])
            .map_or(true, |length| length == 0)
    );
    // The board is free for the next.
    let output = stream(&folder, &bridge.address, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// The board is switched off in the middle of a job, and on again.
#[test]
fn a_bridge_finds_its_board_again() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let board = Device::start(&folder, &[]);
    let address = board.address.clone();
    let mut bridge = Device::bridge(&folder, &address);
    let mut first = crate::common::Streaming::start(&folder, &bridge.address, &["--patience", "1"]);
    first.lines.wait_for("running");
    board.process.kill();
    bridge.lines.wait_for("the line to the board is lost");
    let message = first.lines.rest();
    assert_eq!(first.process.code(), Some(1), "{message}");
    assert!(message.contains("closed by the far end"), "{message}");
    let device = ["device", "scene.toml", "--listen", &address];
    let _board = Device::start_as(&folder, &device);
    bridge.lines.wait_for("the line is open again");
    let arguments = [
        "goto",
        "scene.toml",
        "--port",
        &bridge.address,
        "--x",
        "0.25",
        "--y",
        "0.25",
    ];
    let gone = trirrr()
        .args(arguments)
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(gone.status.success(), "{}", text(&gone.stderr));
}
