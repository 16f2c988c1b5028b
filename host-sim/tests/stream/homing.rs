//! A machine that has to find its motors before it can play a job.

use crate::common::{Device, run, scene, stream, text, ticks};
use std::f64::consts::TAU;

/// A microstep of the motors at the joint, rad: 200 full steps of 16 and a gear of 5.
const STEP_RAD: f64 = TAU / (200.0 * 16.0 * 5.0);

/// How far the device says that its motors are from where they are thought, rad.
fn errors(line: &str) -> Vec<f64> {
    let (_, behind) = line.split_once("the motors are ").expect(line);
    let (errors, _) = behind.split_once(" rad from").expect(line);
    errors
        .split(", ")
        .map(|error| error.parse().expect(line))
        .collect()
}

/// Wherever the motors are, and whether a switch is closed when the machine is switched on: after
/// homing they are where they are thought to be, and the job is that of the run, in the bits.
#[cfg(unix)]
#[test]
fn a_machine_is_homed_before_its_job() {
    let folder = scene("pick-home", &[]);
    let whole = run(&folder);
    let own: &[&str] = &[];
    for offset in [
        own,
        &["--offset-rad", "0.2", "-0.15", "0.1"],
        // Motor 1 stands in its switch.
        &["--offset-rad", "0.33", "0.1", "-0.2"],
    ] {
        let more = [&["--speed", "5"], offset].concat();
        let mut device = Device::start(&folder, &more);
        let output = stream(&folder, &device.address, &[]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let summary = text(&output.stdout);
        assert!(summary.contains("4 of 4 moves done\n"), "{summary}");
        assert!(!summary.contains("warning"), "{summary}");
        assert_eq!(ticks(&folder.path().join("out")), whole, "{offset:?}");

        device.lines.wait_for("homing, 0 moves done");
        device.lines.wait_for("a motor is found");
        device.lines.wait_for("recovering, 0 moves done");
        device.lines.wait_for("running, 0 moves done");
        device.process.interrupt();
        let left = errors(&device.lines.wait_for("switched off"));
        assert_eq!(left.len(), 3);
        for error in left {
            assert!(error.abs() <= STEP_RAD, "{error} rad with {offset:?}");
        }
        assert_eq!(device.process.code(), Some(0));
    }
}

/// Who wants to home by hand is told that it has to be done.
#[cfg(unix)]
#[test]
fn without_homing_the_job_does_not_begin() {
    let folder = scene("pick-home", &[]);
    let offset = ["--offset-rad", "0.2", "-0.15", "0.1"];
    let mut device = Device::start(&folder, &offset);
    let output = stream(&folder, &device.address, &["--no-homing"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("the machine is not free: not homed"),
        "{message}"
    );
    // It has not moved.
    device.process.interrupt();
    let left = errors(&device.lines.wait_for("switched off"));
    assert_eq!(left, [0.2, -0.15, 0.1]);
}

/// The way to the switch is longer than a motor may search.
#[test]
fn a_switch_that_is_never_found_is_named_with_its_motor() {
    let folder = scene("pick-home", &[]);
    // Motor 2 is 0.3 + 0.6 rad from its switch.
    let more = ["--speed", "5", "--offset-rad", "0", "0.6", "0"];
    let mut device = Device::start(&folder, &more);
    let output = stream(&folder, &device.address, &[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    let fault = "homing: motor 2 has not found its switch or stop within 0.8 rad";
    assert!(message.contains(fault), "{message}");
    device.lines.wait_for(fault);

    // The fault stays, until it is acknowledged; then the machine is homed from where it is.
    let output = stream(&folder, &device.address, &[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains(fault), "{message}");
    let output = stream(&folder, &device.address, &["--recover", "1"]);
    let summary = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(summary.contains("4 of 4 moves done\n"), "{summary}");
    assert_eq!(ticks(&folder.path().join("out")), run(&folder));
}

/// Amplifiers and encoders are homed to hard stops that the torque of their loops tells.
#[cfg(unix)]
#[test]
fn hard_stops_are_felt_by_the_torque() {
    // Behind the stops lies nothing of the job.
    let homing = "[homing]\nto = \"hard-stops\"\nstall_torque_nm = 0.2\nangle_rad = [0.376, -2.196, 2.25]\n\
                  direction = [1, -1, -1]\nsearch_rate_rad_s = 0.4\nlatch_rate_rad_s = 0.05\n\
                  acceleration_rad_s2 = 4.0\nback_off_rad = 0.05\ntravel_max_rad = 0.8\n\n[job]";
    let folder = scene("plant-thesis", &[("[job]", homing)]);
    let whole = run(&folder);
    for offset in [["0.2", "-0.15", "0.1"], ["-0.1", "0.02", "-0.2"]] {
        let more = [&["--speed", "5", "--offset-rad"][..], &offset].concat();
        let mut device = Device::start(&folder, &more);
        let output = stream(&folder, &device.address, &[]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(ticks(&folder.path().join("out")), whole, "{offset:?}");
        device.lines.wait_for("a motor is found");
        device.process.interrupt();
        for error in errors(&device.lines.wait_for("switched off")) {
            assert!(error.abs() <= 1e-6, "{error} rad with {offset:?}");
        }
    }
}
