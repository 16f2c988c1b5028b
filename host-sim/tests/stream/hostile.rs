//! Memory of a device under clients that mean it no good. Linux tells how much a process has used at most.

use crate::common::{Asker, Device, scene, text, trirrr};
use std::io::Write;
use std::net::TcpStream;
use std::thread;
use std::time::Duration;
use tempfile::TempDir;
use trirrr_client::local;
use trirrr_line::Frames;
use trirrr_protocol::message::{Command, Hello, Reply, Request};
use trirrr_scene::Scene;

/// Most memory that a device may use beyond what its first well-behaved client has taken, kB.
const MOST_KB: u64 = 4 * 1024;

/// Bytes that endless senders send at most: far more than the device may keep.
const ENDLESS: usize = 32 << 20;

/// Most memory that the device has used so far, kB.
fn peak_kb(device: &Device) -> u64 {
    let file = format!("/proc/{}/status", device.process.0.id());
    let status = std::fs::read_to_string(file).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let figure = line.unwrap().split_whitespace().nth(1);
    figure.unwrap().parse().unwrap()
}

/// Connection to `tcp:HOST:PORT` that gives up writing where nobody reads.
fn connect(address: &str) -> TcpStream {
    let stream = TcpStream::connect(address.strip_prefix("tcp:").unwrap()).unwrap();
    let limit = Some(Duration::from_millis(200));
    stream.set_write_timeout(limit).unwrap();
    stream
}

/// Writes `block` until [`ENDLESS`] bytes are gone, the far end closes the link, or does not read.
fn pour(mut stream: TcpStream, block: &[u8]) {
    let mut left = ENDLESS;
    while left > 0 && stream.write_all(block).is_ok() {
        left = left.saturating_sub(block.len());
    }
}

/// Says hello and asks for the status: a well-behaved client, to which the machine answers. Returns the tick.
fn tick(address: &str, hello: Hello) -> u32 {
    // Who was there before keeps the place for some seconds.
    for _ in 0..200 {
        let mut asker = Asker::new(address);
        if let Some(Reply::Hello(identity)) = asker.ask(1, Command::Hello(hello))
            && let Some(Reply::Status(status)) = asker.ask(identity.next_sequence, Command::Status)
        {
            return status.tick;
        }
        thread::sleep(Duration::from_millis(100));
    }
    panic!("{address} does not answer any more");
}

/// The machine answers, and goes on ticking.
fn lives(device: &Device, hello: Hello, start: u64, after: &str) {
    let before = tick(&device.address, hello);
    let later = (0..100).any(|_| tick(&device.address, hello) != before);
    assert!(later, "no tick after {after}");
    bounded(device, start, after);
}

fn bounded(device: &Device, start: u64, after: &str) {
    let more = peak_kb(device) - start;
    println!("{start} kB at the start, {more} kB more after {after}");
    assert!(more <= MOST_KB, "{more} kB after {after}");
}

/// A client with the key, to whom the machine answers.
fn enable(folder: &TempDir, device: &Device) {
    let port = ["enable", "scene.toml", "--port", &device.address];
    let mut command = trirrr();
    command.args(port).args(["--key", "key"]);
    let output = command.current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
}

fn folder() -> (TempDir, Hello) {
    let folder = scene("thesis", &[]);
    let file = folder.path().join("scene.toml");
    // A client that is silent gives way soon.
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("timeout_s = 600", "timeout_s = 0.2")).unwrap();
    let hello = local::hello::<f64>(&Scene::read(&file).unwrap());
    (folder, hello)
}

/// 200,000 requests behind a hello, whose answers nobody reads.
fn unread_requests(address: &str, hello: Hello) -> Asker {
    let mut asker = Asker::new(address);
    let Some(Reply::Hello(identity)) = asker.ask(1, Command::Hello(hello)) else {
        panic!("no hello");
    };
    let first = identity.next_sequence;
    assert!(asker.ask(first, Command::telemetry(1)).is_some());
    let mut bytes = Vec::new();
    for count in 1..=200_000 {
        let sequence = first.wrapping_add(count);
        let command = Command::<f64>::Status;
        Frames::append(&Request { sequence, command }, &mut bytes);
    }
    // The device does not read on while its answers wait, and the system keeps what it likes.
    asker.send(&bytes);
    asker
}

#[test]
fn no_client_takes_memory_or_ticks() {
    let (folder, hello) = folder();
    let device = Device::start(&folder, &[]);
    tick(&device.address, hello);
    let start = peak_kb(&device);
    let _unread = unread_requests(&device.address, hello);
    lives(&device, hello, start, "200,000 unread requests");
    let garbage: Vec<u8> = (0..1 << 16_u32)
        .map(|i: u32| (i.wrapping_mul(0x9e37_79b1) >> 24) as u8)
        .collect();
    pour(connect(&device.address), &garbage);
    lives(&device, hello, start, "endless garbage");
    pour(connect(&device.address), &[0xa5; 1 << 16]);
    lives(&device, hello, start, "endless bytes without a zero");
    pour(connect(&device.address), &[0; 1 << 16]);
    lives(&device, hello, start, "endless zeros");
    let many: Vec<_> = (0..64).map(|_| connect(&device.address)).collect();
    drop(many);
    lives(&device, hello, start, "64 connections");
}

#[test]
fn no_watcher_and_no_half_handshake_takes_memory_or_ticks() {
    let (folder, hello) = folder();
    let mut device = Device::start(&folder, &["--watch", "tcp:127.0.0.1:0"]);
    let watch = device.lines.wait_for("takes watchers");
    let watch = watch.split(' ').next().unwrap();
    tick(&device.address, hello);
    let start = peak_kb(&device);
    let silent: Vec<_> = (0..64).map(|_| connect(watch)).collect();
    device.lines.wait_for("16 others watch");
    // What a watcher gets, no watcher reads: more than the system and the device keep for it.
    let _unread = unread_requests(&device.address, hello);
    lives(&device, hello, start, "64 watchers that do not read");
    pour(connect(watch), &[0; 1 << 16]);
    lives(&device, hello, start, "an endless watcher");
    drop(silent);

    let key = trirrr().args(["key", "key"]).current_dir(&folder).status();
    assert!(key.unwrap().success());
    let mut device = Device::start(&folder, &["--key", "key"]);
    enable(&folder, &device);
    let start = peak_kb(&device);
    let half: Vec<_> = (0..64)
        .map(|_| {
            let mut stream = connect(&device.address);
            let _ = stream.write_all(b"\x00\x30 half of a handshake");
            stream
        })
        .collect();
    device.lines.wait_for("others came before it showed a key");
    bounded(&device, start, "64 halves of handshakes");
    drop(half);
    enable(&folder, &device);
}
