//! Jobs and boards that do not fit.

use crate::common::{Device, scene, stream, text, trirrr};
use std::time::Duration;
use trirrr_client::local;
use trirrr_client::transport::{self, Frames};
use trirrr_protocol::message::{Command, Hello, Message, PROTOCOL, Refusal, Reply, Request};
use trirrr_scene::Scene;

/// A job that breaks a limit is refused when its scene is read, by the run and by the device.
#[test]
fn a_job_beyond_a_limit_is_refused_in_words() {
    let folder = scene("thesis", &[("rate_rad_s = 2.0", "rate_rad_s = 0.5")]);
    for arguments in [
        &["run", "scene.toml", "--fast", "--out", "run"][..],
        &["device", "scene.toml", "--listen", "tcp:127.0.0.1:0"],
    ] {
        let output = trirrr()
            .args(arguments)
            .current_dir(&folder)
            .output()
            .unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in [
            "scene.toml:",
            ": job.move[1]: at t = ",
            ": rate of motor 3 would be ",
            " rad/s, the most allowed is 0.5 rad/s; ",
            " would be long enough",
        ] {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
    assert!(!folder.path().join("run").exists());
}

#[test]
fn a_board_of_another_scene_or_number_type_is_refused() {
    let (thesis, links) = (scene("thesis", &[]), scene("thesis-links", &[]));
    let device = Device::start(&links, &["--scalar", "f64"]);
    let output = stream(&thesis, &device.address, &["--scalar", "f64"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("was built for another scene"), "{message}");

    let output = stream(&links, &device.address, &["--scalar", "f32"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("another layout"), "{message}");
}

#[test]
fn another_version_of_the_protocol_is_refused() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let scene = Scene::read(folder.path().join("scene.toml")).unwrap();
    let hello = local::hello::<f64>(&scene);
    let mut link = transport::open(&device.address.parse().unwrap(), 0).unwrap();
    let mut frames = Frames::default();
    let mut ask = |command: Command<f64>| -> Reply<f64> {
        let sequence = 77;
        let mut bytes = Vec::new();
        Frames::append(&Request { sequence, command }, &mut bytes);
        link.send(&bytes).unwrap();
        loop {
            let mut bytes = [0; 1024];
            let length = link.receive(&mut bytes, Duration::from_secs(120)).unwrap();
            let mut answer = None;
            frames.receive(&bytes[..length], |message: Message<f64>| {
                if let Message::Reply {
                    sequence: 77,
                    reply,
                } = message
                {
                    answer = Some(reply);
                }
            });
            if let Some(answer) = answer {
                return answer;
            }
        }
    };
    assert_eq!(
        ask(Command::Start),
        Reply::Refused(Refusal::HelloFirst),
        "before the hello"
    );
    let newer = Hello {
        protocol: PROTOCOL + 1,
        ..hello
    };
    let expected = PROTOCOL;
    assert_eq!(
        ask(Command::Hello(newer)),
        Reply::Refused(Refusal::Protocol { expected })
    );
    assert!(matches!(ask(Command::Hello(hello)), Reply::Hello(_)));
}

/// What is refused before anything is opened.
#[test]
fn a_device_needs_a_scene_and_an_address() {
    let folder = scene("thesis", &[("mass_kg = 0.5", "mass_kg = -0.5")]);
    let device = |more: &[&str]| {
        let mut command = trirrr();
        command.args(["device", "scene.toml"]).args(more);
        command.current_dir(&folder).output().unwrap()
    };
    let output = device(&["--listen", "tcp:127.0.0.1:0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("mass_kg"));
    let output = device(&["--listen", "/dev/ttyUSB0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("tcp:HOST:PORT"));

    let folder = scene("thesis", &[]);
    let first = Device::start(&folder, &[]);
    let taken = trirrr()
        .args(["device", "scene.toml", "--listen", &first.address])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert_eq!(taken.status.code(), Some(1));
    assert!(text(&taken.stderr).contains(&first.address));
}
