//! Files and boards whose texts would command a terminal.

use crate::common::{scene, stream, text, trirrr};
use std::io::{Read, Write};
use std::net::TcpListener;
use trirrr_client::local;
use trirrr_line::Frames;
use trirrr_protocol::message::{Command, Message, NAME_CAPACITY, Reply, Request, Start};
use trirrr_scene::Scene;

/// Title and colour of a terminal, a cleared screen, another direction of writing, a line of its own.
const HOSTILE: &str = "\u{1b}]0;owned\u{7}\u{1b}[31m\u{9b}2J\u{202e}\r\nx\u{7f}";

/// The same, in a string of TOML.
const IN_TOML: &str = r"\u001b]0;owned\u0007\u001b[31m\u009b2J\u202e\r\nx\u007f";

/// Its begin, as it is shown.
const SHOWN: &str = r"\u{1b}]0;owned\u{7}";

fn assert_harmless(said: &str) {
    let commands = |c: char| c.is_control() && c != '\n';
    assert!(
        !said.contains(commands) && !said.contains('\u{202e}'),
        "{said:?}"
    );
    assert!(said.contains(SHOWN), "{said:?}");
    assert!(!said.contains("\nx"), "a line of its own: {said:?}");
}

/// Standard output and standard error of `trirrr run` of a scene that begins with `top`.
fn run(top: &str) -> [String; 2] {
    let folder = scene("thesis", &[("description", &format!("{top}\n#"))]);
    let output = trirrr()
        .args(["run", "scene.toml", "--fast", "--out", "run"])
        .current_dir(&folder)
        .output()
        .unwrap();
    [output.stdout, output.stderr].map(|said| text(&said))
}

#[test]
fn a_file_commands_no_terminal() {
    let [summary, _] = run(&format!("description = \"{IN_TOML}\""));
    assert_harmless(&summary);
    // A key that is not known, one with a value that is refused, and what is no TOML.
    for top in [
        format!("\"{IN_TOML}\" = 1"),
        format!(
            "torque = '{}'",
            HOSTILE.replace(['\n', '\r', '\u{7f}', '\u{7}', '\u{1b}'], "")
        ),
        format!("# {HOSTILE}"),
    ] {
        let [_, refusal] = run(&top);
        let commands = |c: char| c.is_control() && c != '\n';
        assert!(refusal.contains("scene.toml:"), "{refusal:?}");
        assert!(
            !refusal.contains(commands) && !refusal.contains('\u{202e}'),
            "{refusal:?}"
        );
    }
    let [_, refusal] = run(&format!("\"{IN_TOML}\" = 1"));
    assert_harmless(&refusal);
    assert!(refusal.contains("unknown key"), "{refusal}");
}

#[cfg(unix)]
#[test]
fn the_name_of_a_file_commands_no_terminal() {
    let folder = scene("thesis", &[]);
    let name = format!("{HOSTILE}.toml");
    for told in ["there", "missing"] {
        if told == "there" {
            std::fs::rename(folder.path().join("scene.toml"), folder.path().join(&name)).unwrap();
        } else {
            std::fs::remove_file(folder.path().join(&name)).unwrap();
        }
        let output = trirrr()
            .args(["run", &name, "--fast", "--out", "run"])
            .current_dir(&folder)
            .output()
            .unwrap();
        let said = [&output.stdout, &output.stderr].map(|said| text(said));
        assert_harmless(&said.concat());
    }
}

/// A board that says hello as the machine of `scene` would, but for its name and what it failed of, and then nothing. Returns its port.
fn board(scene: Scene) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for mut link in listener.incoming().flatten() {
            let mut frames = Frames::default();
            let mut bytes = [0; 4096];
            while let Ok(length @ 1..) = link.read(&mut bytes) {
                let mut answers = Vec::new();
                frames.receive(&bytes[..length], |request: Request<f64>| {
                    if matches!(request.command, Command::Hello(_)) {
                        Frames::append(&hello(&scene, &request), &mut answers);
                    }
                });
                if link.write_all(&answers).is_err() {
                    break;
                }
            }
        }
    });
    format!("tcp:{port}")
}

fn hello(scene: &Scene, request: &Request<f64>) -> Message<f64> {
    let reply = local::with_machine::<f64, _>(scene, |machine| machine.answer(request)).unwrap();
    let Reply::Hello(mut identity) = reply else {
        panic!("{reply:?}");
    };
    let mut hostile = [0; NAME_CAPACITY];
    hostile[..HOSTILE.len()].copy_from_slice(HOSTILE.as_bytes());
    identity.name = hostile;
    identity.board.start = Start::Panic {
        file: hostile,
        line: 12,
    };
    Message::Reply {
        sequence: request.sequence,
        reply: Reply::Hello(identity),
    }
}

#[test]
fn a_board_commands_no_terminal() {
    let folder = scene("thesis", &[]);
    let port = board(Scene::read(folder.path().join("scene.toml")).unwrap());
    let output = stream(&folder, &port, &["--patience", "0.5"]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_harmless(&said);
    for label in ["board ", "warning ", "a panic in "] {
        let line = said.lines().find(|line| line.contains(label));
        assert!(
            line.is_some_and(|line| line.contains(SHOWN)),
            "{label} in {said}"
        );
    }
}
