//! Ways to get in: addresses beyond this computer, keys, and numbers that are tried.

use crate::common::{Asker, Device, run, scene, stream, text, ticks, trirrr};
use tempfile::TempDir;
use trirrr_client::local;
use trirrr_protocol::message::{Command, Hello, Reply};
use trirrr_scene::Scene;

/// Writes a key.
fn key(folder: &TempDir, name: &str) {
    let output = trirrr()
        .args(["key", name])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// Exit code and standard error of `trirrr`.
fn refused(folder: &TempDir, arguments: &[&str]) -> (Option<i32>, String) {
    let output = trirrr()
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    (output.status.code(), text(&output.stderr))
}

#[test]
fn an_address_beyond_loopback_needs_leave_and_a_key() {
    let folder = scene("thesis", &[]);
    key(&folder, "key");
    let device = ["device", "scene.toml", "--listen", "tcp:127.0.0.1:0"];
    for (more, why) in [
        (
            &["--listen", "tcp:0.0.0.0:0"][..],
            "--beyond-loopback and a key",
        ),
        (
            &["--listen", "tcp:0.0.0.0:0", "--key", "key"],
            "give --beyond-loopback",
        ),
        (
            &["--listen", "tcp:[::]:0", "--beyond-loopback"],
            "--key FILE",
        ),
        (&["--watch", "tcp:0.0.0.0:0"], "--beyond-loopback and a key"),
    ] {
        let device = match more[0] {
            "--listen" => &device[..2],
            _ => &device[..],
        };
        let (code, message) = refused(&folder, &[device, more].concat());
        assert_eq!(code, Some(2), "{message}");
        for part in [why, more[1], "can be reached from other computers"] {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
    let arguments = [
        "device",
        "scene.toml",
        "--listen",
        "tcp:0.0.0.0:0",
        "--beyond-loopback",
        "--key",
        "key",
    ];
    let mut child = trirrr()
        .args(arguments)
        .current_dir(&folder)
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = crate::common::Lines::of(child.stdout.take().unwrap());
    let _process = crate::common::Process(child);
    let first = lines.wait_for("tcp:0.0.0.0:");
    lines.wait_for("can be reached from other computers");
    let address = first
        .split(' ')
        .next()
        .unwrap()
        .replace("0.0.0.0", "127.0.0.1");
    let output = stream(&folder, &address, &["--key", "key"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(ticks(&folder.path().join("out")), run(&folder));
}

#[test]
fn a_key_is_written_once() {
    let folder = TempDir::new().unwrap();
    key(&folder, "key");
    let file = folder.path().join("key");
    let before = std::fs::read_to_string(&file).unwrap();
    assert_eq!(before.trim_end().len(), 64);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(&file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
    let (code, message) = refused(&folder, &["key", "key"]);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("not overwritten"), "{message}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), before);
}

#[test]
fn who_has_another_key_or_none_is_told_so_at_once() {
    let folder = scene("thesis", &[]);
    key(&folder, "key");
    key(&folder, "other");
    std::fs::write(folder.path().join("short"), "0123\n").unwrap();
    let keyed = Device::start(&folder, &["--key", "key", "--watch", "tcp:127.0.0.1:0"]);
    let plain = Device::start(&folder, &[]);
    let mut lines = keyed.lines;
    let watch = lines.wait_for("takes watchers");
    let watch = watch.split(' ').next().unwrap();
    // Each of these would wait for minutes if it had to find out by itself.
    let patience = &["--patience", "1000"][..];
    for (address, more, code, why) in [
        (
            &keyed.address,
            &["--key", "other"][..],
            1,
            "did not accept the key",
        ),
        (
            &keyed.address,
            &[],
            1,
            "expects a key: give its key file with --key",
        ),
        (
            &plain.address,
            &["--key", "key"],
            1,
            "has no key: leave the key out",
        ),
        (
            &plain.address,
            &["--key", "none"],
            2,
            "`trirrr key none` writes a new key",
        ),
        (
            &plain.address,
            &["--key", "short"],
            2,
            "64 hexadecimal digits",
        ),
    ] {
        for command in ["stream", "enable"] {
            let start = [command, "scene.toml", "--port", address];
            let (found, message) = refused(&folder, &[&start, patience, more].concat());
            assert_eq!(found, Some(code), "{message}");
            assert!(message.contains(why), "{why} in {message}");
        }
    }
    for (more, why) in [
        (&[][..], "expects a key"),
        (&["--key", "other"], "did not accept the key"),
    ] {
        let (code, message) = refused(&folder, &[&["watch", "--port", watch], more].concat());
        assert_eq!(code, Some(1), "{message}");
        assert!(message.contains(why), "{why} in {message}");
    }
    lines.wait_for("it has another key");
    let output = stream(&folder, &keyed.address, &["--key", "key"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[cfg(unix)]
#[test]
fn a_key_that_others_can_read_is_warned_of() {
    use std::os::unix::fs::PermissionsExt;
    let folder = scene("thesis", &[]);
    key(&folder, "key");
    let open = std::fs::Permissions::from_mode(0o644);
    std::fs::set_permissions(folder.path().join("key"), open).unwrap();
    let device = Device::start(&folder, &[]);
    let arguments = [
        "stream",
        "scene.toml",
        "--port",
        &device.address,
        "--key",
        "key",
    ];
    let (_, message) = refused(&folder, &arguments);
    assert!(message.contains("chmod 600 key"), "{message}");
}

fn hello(folder: &TempDir) -> Hello {
    let scene = Scene::read(folder.path().join("scene.toml")).unwrap();
    local::hello::<f64>(&scene)
}

/// Says hello; the number of the next request.
fn greeted(asker: &mut Asker, hello: Hello) -> u32 {
    match asker.ask(1, Command::Hello(hello)) {
        Some(Reply::Hello(identity)) => identity.next_sequence,
        other => panic!("{other:?}"),
    }
}

/// One wrong number is one connection, whether a hello comes before or not, from a board behind a bridge, too.
#[test]
fn numbers_cannot_be_tried_one_after_the_other() {
    let folder = scene("thesis", &[]);
    let hello = hello(&folder);
    let board = Device::start(&folder, &[]);
    let mut bridge = Device::bridge(&folder, &board.address);
    let mut device = Device::start(&folder, &[]);
    for (served, is_bridge) in [(&mut device, false), (&mut bridge, true)] {
        for says_hello in [true, false] {
            let mut asker = Asker::new(&served.address);
            if says_hello {
                greeted(&mut asker, hello);
            }
            let wrong = 0x8000_0000;
            let reply = asker.ask(wrong, Command::Start);
            assert!(matches!(reply, Some(Reply::Refused(_))), "{reply:?}");
            assert_eq!(asker.ask(wrong + 1, Command::Start), None);
            served.lines.wait_for("have other numbers");
            if is_bridge {
                // It is a client of its board, which has cut it off for the same reason.
                served.lines.wait_for("the line is open again");
            }
        }
        // Who knows the number may err later.
        let mut asker = Asker::new(&served.address);
        let next = greeted(&mut asker, hello);
        let status = asker.ask(next, Command::Status);
        assert!(matches!(status, Some(Reply::Status(_))), "{status:?}");
        for _ in 0..3 {
            let reply = asker.ask(next ^ 0x8000_0000, Command::Start);
            assert!(matches!(reply, Some(Reply::Refused(_))), "{reply:?}");
        }
        let status = asker.ask(next.wrapping_add(1), Command::Status);
        assert!(matches!(status, Some(Reply::Status(_))), "{status:?}");
    }
}

#[test]
fn who_only_says_hello_is_cut_off() {
    let folder = scene("thesis", &[]);
    let hello = hello(&folder);
    let mut device = Device::start(&folder, &[]);
    for scene in [hello.scene, hello.scene ^ 1] {
        let mut asker = Asker::new(&device.address);
        let hello = Hello { scene, ..hello };
        let hellos = (0..100).take_while(|each| asker.ask(*each, Command::Hello(hello)).is_some());
        assert_eq!(hellos.count(), 8);
        device.lines.wait_for("says hello again and again");
    }
}
