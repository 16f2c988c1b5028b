//! `trirrr goto`, `jog` and `follow` on a device that stands or moves.

use crate::common::{Device, Streaming, scene, text, trirrr};
use std::io::{BufRead, BufReader, Write};
use std::process::{Output, Stdio};
use tempfile::TempDir;

/// Runs a command on the device, with lines on its standard input.
fn go(folder: &TempDir, device: &Device, args: &[&str], lines: &str) -> Output {
    let mut child = trirrr()
        .arg(args[0])
        .args(["scene.toml", "--port", &device.address])
        .args(&args[1..])
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(lines.as_bytes())
        .unwrap();
    child.wait_with_output().unwrap()
}

fn stands_at(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The client of a job is gone, and its machine still moves.
#[test]
fn goto_cuts_a_job_that_is_under_way() {
    let folder = scene("thesis", &[("duration_s = 1.0", "duration_s = 600.0")]);
    let mut device = Device::start(&folder, &[]);
    let mut streaming = Streaming::start(&folder, &device.address, &[]);
    streaming.lines.wait_for("running");
    streaming.process.kill();
    device.lines.wait_for("is gone");
    let output = go(
        &folder,
        &device,
        &["goto", "--x", "0.22", "--y", "0.23", "--alpha", "0.2"],
        "",
    );
    let stands = stands_at(&output);
    assert_eq!(
        stands,
        "stands at x 0.220000 m, y 0.230000 m, alpha 0.200000 rad\n"
    );
    // Out of reach.
    let output = go(
        &folder,
        &device,
        &["goto", "--x", "-0.9", "--y", "0.23"],
        "",
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("no motion to the goal"),
        "{output:?}"
    );
    // The machine remembers that refusal: it is of no other goal.
    let output = go(&folder, &device, &["jog"], "feed 100\nfeed 0\n");
    let said = text(&output.stderr);
    assert!(!said.contains("no motion to the goal"), "{said}");
    assert!(said.contains("from 1 to 100"), "{said}");
    let output = go(
        &folder,
        &device,
        &["goto", "--x", "0.23", "--y", "0.23"],
        "",
    );
    assert!(stands_at(&output).starts_with("stands at x 0.230000 m"));
    // The same refusal twice in one session is told twice.
    let lines = "step -2 0\nstep -2 0\nstep 0.001 0\n";
    let output = go(&folder, &device, &["jog"], lines);
    let said = text(&output.stderr);
    assert!(said.contains("no motion to the goal"), "{said}");
}

#[test]
fn steps_and_poses_add_up() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let lines = "step 0.01 0\nstep 0 0.005\nnothing\nspeed 0.01 0.01\nstop\nstep 0.005 0 0.01\n";
    let output = go(&folder, &device, &["jog"], lines);
    assert!(text(&output.stdout).starts_with("stands at"));
    // All but a line are obeyed.
    assert_eq!(output.status.code(), Some(2));
    let why = "1 of 6 lines left out, last line 3: `nothing` is no line of a jog";
    assert!(text(&output.stderr).contains(why), "{output:?}");
    let poses = "x_m,y_m,alpha_rad\n0.22,0.23\n0.23,0.24,0.1\n0.25 0.25 0.15\n";
    let output = go(&folder, &device, &["follow", "--every", "0.05"], poses);
    let stands = stands_at(&output);
    assert_eq!(
        stands,
        "stands at x 0.250000 m, y 0.250000 m, alpha 0.150000 rad\n"
    );
    let output = go(&folder, &device, &["follow"], "0.22,0.23,0.1,5\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("give 2, 3 or 6 numbers"),
        "{output:?}"
    );
}

/// The input ends while a velocity lasts: that is no failure.
#[test]
fn a_jog_that_ends_at_a_velocity_stands_where_it_led_to() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let output = go(
        &folder,
        &device,
        &["jog", "--renew", "0.3"],
        "speed 0.02 0\n",
    );
    let stands = stands_at(&output);
    let x = stands
        .split([' ', ','])
        .nth(3)
        .unwrap()
        .parse::<f64>()
        .unwrap();
    assert!(x > 0.2105, "{stands}");
}

/// The machine stops at the edge, which is told once, and comes straight back.
#[test]
fn a_jog_into_the_edge_of_the_workspace_comes_back() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    let mut child = trirrr()
        .args([
            "jog",
            "scene.toml",
            "--port",
            &device.address,
            "--renew",
            "1.5",
        ])
        .current_dir(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut refusals = 0;
    input.write_all(b"speed 0.3 0\n").unwrap();
    for line in told.by_ref() {
        let line = line.unwrap();
        refusals += u32::from(line.contains("no motion to the goal"));
        // At rest on its path.
        if refusals > 0 && line.contains("idle") {
            break;
        }
    }
    input.write_all(b"speed -0.05 0\n").unwrap();
    for line in told.by_ref() {
        let line = line.unwrap();
        assert!(!line.contains("no motion"), "{line}");
        if line.contains("running") {
            break;
        }
    }
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(refusals, 1);
}

/// The last pose is in motion, and no other comes.
#[test]
fn follow_ends_on_the_way_to_a_last_pose_in_motion() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    for poses in [
        "0.23 0.23 0.16 0.02 0.02 0\n",
        "0.2301 0.2301 0.16 0.02 0.02 0\n",
    ] {
        let output = go(&folder, &device, &["follow"], poses);
        assert!(stands_at(&output).starts_with("stands at"));
        assert!(
            text(&output.stderr).contains("the last pose is in motion"),
            "{output:?}"
        );
    }
    let output = go(
        &folder,
        &device,
        &["goto", "--x", "0.22", "--y", "0.23"],
        "",
    );
    assert!(stands_at(&output).starts_with("stands at x 0.220000 m, y 0.230000 m"));
}
