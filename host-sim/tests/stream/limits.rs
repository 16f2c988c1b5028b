//! Scenes without limits of their motors.

use crate::common::{Device, scene, stream, text, trirrr};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

const WARNING: &str =
    "trirrr: warning: scene thesis has no rate_rad_s and no torque_nm in [limits]: ";

#[test]
fn a_scene_without_limits_is_warned_of() {
    let folder = scene(
        "thesis",
        &[("rate_rad_s = 2.0\n", ""), ("torque_nm = 0.1\n", "")],
    );
    for arguments in [
        &["run", "scene.toml", "--fast", "--out", "run"][..],
        // It has no path, which is refused after the warning.
        &["plan", "scene.toml"],
    ] {
        let output = trirrr()
            .args(arguments)
            .current_dir(&folder)
            .output()
            .unwrap();
        let said = text(&output.stderr);
        assert_eq!(said.matches(WARNING).count(), 1, "{said}");
    }
    let mut device = trirrr()
        .args(["device", "scene.toml", "--listen", "tcp:127.0.0.1:0"])
        .current_dir(&folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = String::new();
    let mut lines = BufReader::new(device.stderr.take().unwrap());
    lines.read_line(&mut said).unwrap();
    device.kill().unwrap();
    device.wait().unwrap();
    assert!(said.starts_with(WARNING), "{said}");

    let device = Device::start(&folder, &["--speed", "5"]);
    let output = stream(&folder, &device.address, &[]);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert_eq!(said.matches(WARNING).count(), 1, "{said}");
}

#[test]
fn a_scene_with_limits_is_not() {
    let folder = scene("thesis", &[]);
    let output = trirrr()
        .args(["run", "scene.toml", "--fast", "--out", "run"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(output.status.success());
    let said = text(&output.stderr);
    assert!(!said.contains("warning"), "{said}");
}
