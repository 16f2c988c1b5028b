//! Spare outputs and inputs of a device: by command, and with the moves of a job in G-code.

use crate::common::{Device, scene, text, trirrr};
use std::fs;
use std::io::Write;
use std::process::Output;
use tempfile::TempDir;

/// The scene with spare pins; its machine is beside it.
fn valves() -> TempDir {
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/thesis.toml");
    let machine = format!("{machine:?}");
    // `scene` puts a `[service]` in: that of this scene goes.
    let own = "[service]\nhold_ramp_s = 0.1\nsilence_timeout_s = 1.0\n\n";
    scene(
        "inputs/valves",
        &[("\"../thesis.toml\"", machine.as_str()), (own, "")],
    )
}

fn ask(folder: &TempDir, address: &str, arguments: &[&str]) -> Output {
    let mut command = trirrr();
    command.args(arguments).args(["--port", address]);
    command.current_dir(folder).output().unwrap()
}

#[test]
fn outputs_and_inputs_are_switched_and_shown_by_name() {
    let folder = valves();
    let mut device = Device::start(&folder, &["--keys"]);
    let output = |more: &[&str]| {
        let arguments = [&["output", "scene.toml"], more].concat();
        ask(&folder, &device.address, &arguments)
    };
    let shown = output(&[]);
    let expected = "output P0 air: off\noutput P1 vacuum: off\ninput P0 sheet: not active\n";
    assert_eq!(text(&shown.stdout), expected, "{}", text(&shown.stderr));
    let refused = output(&["vacuum", "on"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("not while the machine is disabled"), "{said}");
    let refused = output(&["vent", "on"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(
        said.contains("has no output \"vent\"; its outputs are air, vacuum"),
        "{said}"
    );
    let enabled = ask(&folder, &device.address, &["enable", "scene.toml"]);
    assert!(enabled.status.success(), "{}", text(&enabled.stderr));
    let switched = output(&["vacuum", "on"]);
    assert!(
        text(&switched.stdout).contains("vacuum: on"),
        "{}",
        text(&switched.stderr)
    );
    let mut keys = device.process.0.stdin.take().expect("a pipe");
    writeln!(keys, "sheet").unwrap();
    device
        .lines
        .wait_for("outputs on: vacuum; inputs active: sheet");
    let disabled = ask(&folder, &device.address, &["disable", "scene.toml"]);
    assert!(disabled.status.success(), "{}", text(&disabled.stderr));
    device
        .lines
        .wait_for("outputs on: none; inputs active: sheet");
}

/// The job of the scene itself switches them, with its moves.
#[test]
fn the_job_of_a_scene_switches_outputs() {
    let folder = valves();
    let mut device = Device::start(&folder, &["--speed", "5"]);
    let played = ask(&folder, &device.address, &["stream", "scene.toml"]);
    assert!(played.status.success(), "{}", text(&played.stderr));
    for on in ["air, vacuum", "vacuum"] {
        device.lines.wait_for(&format!("outputs on: {on}; inputs"));
    }
    let shown = ask(&folder, &device.address, &["output", "scene.toml"]);
    let shown = text(&shown.stdout);
    assert!(
        shown.contains("P0 air: off\noutput P1 vacuum: on"),
        "{shown}"
    );
}

const JOB: &str = "G21 G90\nM64 P1\nG1 X5 F6000\nM62 P0\nX10\nM63 P0\nX15\nM62 P0\nX0\nM65 P1\n";

/// The outputs change in the order of the program, and the last stand of it is played, too.
#[test]
fn a_job_in_g_code_switches_outputs() {
    let folder = valves();
    let mut device = Device::start(&folder, &["--speed", "5"]);
    fs::write(folder.path().join("job.ngc"), JOB).unwrap();
    let arguments = [
        "stream",
        "job.ngc",
        "--machine",
        "scene.toml",
        "--origin",
        "210,220",
    ];
    let played = ask(&folder, &device.address, &arguments);
    assert!(played.status.success(), "{}", text(&played.stderr));
    for on in [
        "vacuum",
        "air, vacuum",
        "vacuum",
        "air, vacuum",
        "air",
        "none",
    ] {
        device.lines.wait_for(&format!("outputs on: {on}; inputs"));
    }
    // A machine that plans by itself knows no such moves.
    let refused = ask(
        &folder,
        &device.address,
        &[&arguments[..], &["--path"]].concat(),
    );
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("outputs change with moves"), "{said}");
}
