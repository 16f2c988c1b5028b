//! Probe and limit switches of a device.

use crate::common::{Device, scene, text, trirrr};
use std::io::Write;
use std::process::Output;
use tempfile::TempDir;

/// The scene with all inputs; its machine is beside it.
fn probing() -> TempDir {
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/thesis.toml");
    let machine = format!("{machine:?}");
    // `scene` puts a `[service]` in: that of this scene goes.
    let own = "[service]\nhold_ramp_s = 0.1\nsilence_timeout_s = 1.0\n\n";
    scene(
        "inputs/probing",
        &[("\"../thesis.toml\"", machine.as_str()), (own, "")],
    )
}

fn ask(folder: &TempDir, address: &str, arguments: &[&str]) -> Output {
    let mut command = trirrr();
    command.args([arguments[0], "scene.toml", "--port", address]);
    command.args(&arguments[1..]).current_dir(folder);
    command.output().unwrap()
}

const WAY: [&str; 7] = ["probe", "--to", "0.28", "0.22", "0.157", "--seconds", "0.5"];

/// The wall is found where it is, again from there it is not, and away from it the probe lets go.
#[test]
fn a_wall_is_probed_and_left() {
    let folder = probing();
    let mut device = Device::start(&folder, &["--touch", "x=0.25"]);
    let output = ask(&folder, &device.address, &WAY);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("not while the machine is disabled"));
    let output = ask(&folder, &device.address, &["enable"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = ask(&folder, &device.address, &WAY);
    let said = text(&output.stdout);
    assert!(output.status.success(), "{said}{}", text(&output.stderr));
    let x = said.split(['(', ',']).nth(1).expect("a place");
    let x: f64 = x.trim().parse().expect("a number");
    // A tick at 0.15 m/s at most is 0.2 mm.
    assert!((0.25..0.2502).contains(&x), "{said}");
    device.lines.wait_for("the probe's contact at (0.25");
    let output = ask(&folder, &device.address, &WAY);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the probe touches before the run"));
    let back = ["probe", "--to", "0.21", "0.22", "0.157", "--seconds", "0.5"];
    let output = ask(&folder, &device.address, &[&back[..], &["--away"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = ask(&folder, &device.address, &back);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("the probe has touched nothing"));
}

/// A motor on its limit switch is a fault with its number; no job starts there, and a recovery leads off.
#[test]
fn a_limit_switch_is_a_fault_that_a_recovery_leads_off() {
    let folder = probing();
    let mut device = Device::start(&folder, &["--keys"]);
    let mut keys = device.process.0.stdin.take().expect("a pipe");
    let output = ask(&folder, &device.address, &["enable"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    writeln!(keys, "limit2").unwrap();
    device.lines.wait_for("motor 2 on its limit switch");
    device
        .lines
        .wait_for("fault: motor 2 has reached its limit switch");
    let output = ask(&folder, &device.address, &["enable", "--clear"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = ask(&folder, &device.address, &WAY);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("motor 2 stands on its limit switch: only a recovery or homing"),
        "{said}"
    );
    writeln!(keys, "limit2").unwrap();
    device.lines.wait_for("no motor on its limit switch");
    let output = ask(&folder, &device.address, &["stream", "--recover", "0.5"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}
