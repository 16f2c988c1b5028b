//! `[contact]`, `[faults] contact` and `[plant.push]`: read, and refused with key and reason.

use crate::common::problems;
use trirrr_scene::{Contact, Scene};
use trirrr_service::StopCategory;

const ODRIVE: &str = include_str!("../../../../scenes/plant-odrive.toml");
const STEPPER: &str = include_str!("../../../../scenes/pick-stepper.toml");

/// `scene` without what it says of contacts, and with `tables` before its limits.
fn with(scene: &str, tables: &str) -> String {
    let mut lines = Vec::new();
    let mut skips = false;
    for line in scene.lines() {
        if line.starts_with('[') {
            skips = line.starts_with("[contact");
        }
        if line.starts_with("[limits]") {
            lines.push(tables);
        }
        if !skips {
            lines.push(line);
        }
    }
    lines.join("\n")
}

fn read(tables: &str) -> Contact {
    let scene = Scene::parse(&with(ODRIVE, tables), "scene.toml");
    scene.expect("a good scene").contact.expect("contacts")
}

#[test]
fn a_detection_is_read() {
    let least = read("[contact]\nforce_n = 3\ntorque_nm = 0.1\n");
    assert_eq!((least.force_n, least.torque_nm), (3.0, 0.1));
    assert_eq!((least.bandwidth_hz, least.confirm_ticks), (20.0, 2));
    assert_eq!(least.friction.coulomb_nm, [0.0; 3]);
    assert_eq!(least.reaction, StopCategory::StopThenOff);
    assert_eq!(least.parameters(500.0).retreat_ticks, 0);
    let back = read("[contact]\nforce_n = 3\ntorque_nm = 0.1\nretreat_s = 0.2\n");
    assert_eq!(back.parameters(500.0).retreat_ticks, 100);
    let all = read(
        "[faults]\ncontact = 2\n[contact]\nforce_n = 3\ntorque_nm = 0.1\nbandwidth_hz = 50\nconfirm_ticks = 5\n\
         [contact.friction]\ncoulomb_nm = [0.1, 0.2, 0.3]\nviscous_nm_s_rad = 0.01\nsliding_rad_s = 0.1\n",
    );
    assert_eq!((all.bandwidth_hz, all.confirm_ticks), (50.0, 5));
    assert_eq!(all.friction.coulomb_nm, [0.1, 0.2, 0.3]);
    assert_eq!(all.friction.viscous_nm_s_rad, [0.01; 3]);
    assert_eq!(all.friction.sliding_rad_s, 0.1);
    assert_eq!(all.reaction, StopCategory::StopAndHold);
    // A category of another fault leaves that of contacts as it is.
    let other = read("[faults]\nlimit = 0\n[contact]\nforce_n = 3\ntorque_nm = 0.1\n");
    assert_eq!(other.reaction, StopCategory::StopThenOff);
}

#[test]
fn what_cannot_be_detected_is_refused() {
    let good = "[contact]\nforce_n = 3\ntorque_nm = 0.1\n";
    let fixed = ODRIVE.replace("number = \"f32\"", "number = \"fixed\"");
    let without = ODRIVE
        .replace("number = \"f32\"", "number = \"f32\"\ntorque = false")
        .replace("torque_nm = 4.0\n", "")
        .replace("feed_forward = true", "feed_forward = false");
    for (scene, tables, key, reason) in [
        (
            STEPPER,
            good,
            "contact",
            "needs drives that tell their torque: kind = \"can\"",
        ),
        (&fixed, good, "contact", "f32, micromath or f64"),
        (&without, good, "contact", "torque = false leaves out"),
        (
            ODRIVE,
            "[contact]\ntorque_nm = 0.1\n",
            "contact.force_n",
            "missing",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0\n",
            "contact.torque_nm",
            "must be greater than 0 (N m)",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = -3\ntorque_nm = 0.1\n",
            "contact.force_n",
            "must be greater than 0 (N)",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0.1\nbandwidth_hz = 126\n",
            "contact.bandwidth_hz",
            "at most a quarter of tick_rate_hz, 125 (Hz)",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0.1\nconfirm_ticks = 0\n",
            "contact.confirm_ticks",
            "must be a whole number from 1 to 1000",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0.1\nfriction = { coulomb_nm = -1 }\n",
            "contact.friction.coulomb_nm",
            "must not be negative",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0.1\nmoment_nm = 1\n",
            "contact.moment_nm",
            "unknown key",
        ),
        (
            ODRIVE,
            "[contact]\nforce_n = 3\ntorque_nm = 0.1\nretreat_s = -0.1\n",
            "contact.retreat_s",
            "must be from 0 to 10",
        ),
        (
            ODRIVE,
            "[faults]\ncontact = 0\n[contact]\nforce_n = 3\ntorque_nm = 0.1\nretreat_s = 0.1\n",
            "contact.retreat_s",
            "the drives go off at once",
        ),
        (
            ODRIVE,
            "[faults]\ncontact = 2\n",
            "faults",
            "contact needs the table [contact]",
        ),
        (
            ODRIVE,
            "[faults]\ncontact = 3\n[contact]\nforce_n = 3\ntorque_nm = 0.1\n",
            "faults.contact",
            "from 0 to 2",
        ),
    ] {
        let found = problems(&with(scene, tables));
        let named = found
            .iter()
            .any(|each| each.key == key && each.reason.contains(reason));
        assert!(named, "{key}: {reason} is not in {found:#?}");
    }
}

#[test]
fn a_push_is_read_or_refused() {
    let push = |table: &str| with(ODRIVE, &format!("[plant.push]\n{table}"));
    let scene = Scene::parse(
        &push("at_s = 0.5\nduration_s = 0.1\nforce_n = [5, 0]\n"),
        "scene.toml",
    );
    let push_read = scene
        .expect("a good scene")
        .plant
        .and_then(|plant| plant.push);
    let push_read = push_read.expect("a push");
    assert_eq!((push_read.at_s, push_read.duration_s), (0.5, 0.1));
    assert_eq!((push_read.force_n, push_read.torque_nm), ([5.0, 0.0], 0.0));
    for (table, key, reason) in [
        (
            "at_s = 0.5\nduration_s = 0.1\n",
            "plant.push",
            "pushes nothing",
        ),
        (
            "at_s = 5\nduration_s = 0.1\ntorque_nm = 1\n",
            "plant.push",
            "lies behind the run, which lasts 1.2 s",
        ),
        (
            "duration_s = 0.1\ntorque_nm = 1\n",
            "plant.push.at_s",
            "missing",
        ),
        (
            "at_s = 0.5\nduration_s = 0\ntorque_nm = 1\n",
            "plant.push.duration_s",
            "must be greater than 0",
        ),
    ] {
        let found = problems(&push(table));
        let named = found
            .iter()
            .any(|each| each.key == key && each.reason.contains(reason));
        assert!(named, "{key}: {reason} is not in {found:#?}");
    }
}
