//! Jobs and boards that do not fit.

use crate::common::{Asker, Device, scene, stream, text, trirrr};
use trirrr_client::local;
use trirrr_protocol::message::{Command, Hello, PROTOCOL, Refusal, Reply};
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
    assert!(message.contains("the board computes in f64"), "{message}");
    assert!(message.contains("--scalar f64"), "{message}");
}

/// The first command of docs/board.md: the scene is in f64, the image in f32.
#[test]
fn a_board_in_another_number_type_is_talked_to_in_its_own() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &["--scalar", "f32"]);
    let output = stream(&folder, &device.address, &[]);
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("the board computes in f32"), "{message}");
    let summary = text(&output.stdout);
    assert_eq!(summary.matches("numbers     ").count(), 1, "{summary}");
    assert!(summary.contains("numbers     f32"), "{summary}");
    let output = crate::common::trirrr()
        .args([
            "goto",
            "scene.toml",
            "--port",
            &device.address,
            "--x",
            "0.25",
            "--y",
            "0.25",
        ])
        .current_dir(&folder)
        .output()
        .unwrap();
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("going on in f32"), "{message}");
}

#[test]
fn another_version_of_the_protocol_is_refused() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let scene = Scene::read(folder.path().join("scene.toml")).unwrap();
    let hello = local::hello::<f64>(&scene);
    let mut asker = Asker::new(&device.address);
    assert_eq!(
        asker.ask(77, Command::Start),
        Some(Reply::Refused(Refusal::HelloFirst)),
        "before the hello"
    );
    assert_eq!(asker.ask(78, Command::Start), None, "it is cut off");
    let mut asker = Asker::new(&device.address);
    let newer = Hello {
        protocol: PROTOCOL + 1,
        ..hello
    };
    let expected = PROTOCOL;
    assert_eq!(
        asker.ask(77, Command::Hello(newer)),
        Some(Reply::Refused(Refusal::Protocol { expected }))
    );
    let met = asker.ask(77, Command::Hello(hello));
    assert!(matches!(met, Some(Reply::Hello(_))));
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
