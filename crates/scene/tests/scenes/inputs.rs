//! `[inputs]`: read, and refused with key and reason.

use crate::common::problems;
use trirrr_scene::{InputPorts, NormalContact, Scene};
use trirrr_service::StopCategory;
use trirrr_service::features::{Door, EmergencyStop, LimitInputs, ProbeInput};

const THESIS: &str = include_str!("../../../../scenes/thesis.toml");

/// The thesis machine at 1000 ticks per second with these inputs.
fn with(inputs: &str) -> String {
    THESIS
        .replace("tick_rate_hz = 100", "tick_rate_hz = 1000")
        .replace("[job]", &format!("{inputs}\n[job]"))
}

fn read(inputs: &str) -> InputPorts {
    let scene = Scene::parse(&with(inputs), "scene.toml");
    scene.unwrap_or_else(|error| panic!("{error}")).inputs
}

#[test]
fn inputs_are_read_with_their_defaults() {
    assert_eq!(read(""), InputPorts::default());
    assert!(!read("").are_named());
    let inputs = read("[inputs.estop]\n[inputs.door]");
    let stop = EmergencyStop {
        debounce_ticks: 5,
        category: StopCategory::Off,
    };
    assert_eq!(inputs.interlocks.emergency_stop, Some(stop));
    assert_eq!(inputs.interlocks.door, Some(Door { debounce_ticks: 5 }));
    assert_eq!(inputs.door_normally, NormalContact::Closed);
    assert!(inputs.are_named());
}

#[test]
fn a_probe_and_limit_switches_are_read_with_their_defaults() {
    let inputs = read("[inputs.probe]\n[inputs.limits]");
    assert_eq!(
        inputs.interlocks.probe,
        Some(ProbeInput { debounce_ticks: 5 })
    );
    assert_eq!(
        inputs.interlocks.limits,
        Some(LimitInputs { debounce_ticks: 5 })
    );
    assert_eq!(inputs.interlocks.emergency_stop, None);
    // A probe closes; a limit switch opens.
    assert_eq!(inputs.probe_normally, NormalContact::Open);
    assert_eq!(inputs.limits_normally, NormalContact::Closed);
    assert!(inputs.are_named() && inputs.has_limit_pins());
    let inputs =
        read("[inputs.probe]\nnormally = \"closed\"\n[inputs.limits]\nnormally = \"open\"");
    assert_eq!(inputs.probe_normally, NormalContact::Closed);
    assert_eq!(inputs.limits_normally, NormalContact::Open);
}

#[test]
fn limit_switches_may_be_those_of_homing() {
    let homed = include_str!("../../../../scenes/pick-home.toml");
    let with = |more: &str| {
        homed.replace(
            "[job]",
            &format!("[inputs.limits]\nshare_homing = true\n{more}\n[job]"),
        )
    };
    let scene = Scene::parse(&with(""), "scene.toml");
    let inputs = scene.unwrap_or_else(|error| panic!("{error}")).inputs;
    assert!(inputs.limits_share_homing && !inputs.has_limit_pins() && inputs.are_named());
    let found = problems(&with("normally = \"open\""));
    assert!(
        found
            .iter()
            .any(|problem| problem.key == "inputs.limits.normally"),
        "{found:?}"
    );
}

#[test]
fn the_stop_at_a_limit_switch_is_that_of_the_scene() {
    let category = |faults: &str| {
        let scene = Scene::parse(&with(&format!("{faults}\n[inputs.limits]")), "scene.toml");
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        scene.reactions.limit_switch
    };
    assert_eq!(category(""), StopCategory::Off);
    assert_eq!(
        category("[faults]\nlimit_switch = 2"),
        StopCategory::StopAndHold
    );
}

#[test]
fn a_debounce_time_is_rounded_down_to_ticks_and_is_one_at_least() {
    for (seconds, ticks) in [
        ("0.0", 1),
        ("0.0009", 1),
        ("0.0019", 1),
        ("0.003", 3),
        ("0.1", 100),
    ] {
        let inputs = read(&format!(
            "[inputs.door]\ndebounce_s = {seconds}\nnormally = \"open\""
        ));
        let door = inputs.interlocks.door.expect("a door");
        assert_eq!(door.debounce_ticks, ticks, "{seconds} s");
        assert_eq!(inputs.interlocks.emergency_stop, None);
        assert_eq!(inputs.door_normally, NormalContact::Open);
    }
}

#[test]
fn an_emergency_stop_is_of_category_0_or_1() {
    for (category, expected) in [(0, StopCategory::Off), (1, StopCategory::StopThenOff)] {
        let inputs = read(&format!("[inputs.estop]\nstop_category = {category}"));
        let stop = inputs.interlocks.emergency_stop.expect("a stop");
        assert_eq!(stop.category, expected);
    }
}

#[test]
fn a_status_lamp_is_there_where_the_scene_names_one() {
    let has = |io: &str| {
        let scene = Scene::parse(&with(io), "scene.toml");
        scene.unwrap_or_else(|error| panic!("{error}")).has_lamp
    };
    assert!(!has("") && !has("[io]\nlamp = false") && has("[io]\nlamp = true"));
    let found = problems(&with("[io]"));
    assert!(
        found.iter().any(|problem| problem.key == "io.lamp"),
        "{found:?}"
    );
}

#[test]
fn what_makes_no_sense_is_refused_with_its_key() {
    for (inputs, key, reason) in [
        ("[inputs]", "inputs", "names no input"),
        ("[inputs.lid]", "inputs.lid", ""),
        (
            "[inputs.estop]\nstop_category = 2",
            "inputs.estop.stop_category",
            "0 to 1",
        ),
        (
            "[inputs.estop]\nnormally = \"open\"",
            "inputs.estop.normally",
            "once its wire is broken",
        ),
        (
            "[inputs.door]\nnormally = \"shut\"",
            "inputs.door.normally",
            "\"closed\", \"open\"",
        ),
        (
            "[inputs.door]\ndebounce_s = 0.2",
            "inputs.door.debounce_s",
            "0.1",
        ),
        (
            "[inputs.limits]\nshare_homing = true",
            "inputs.limits.share_homing",
            "needs [homing] to switches",
        ),
        (
            "[inputs.probe]\nnormally = \"on\"",
            "inputs.probe.normally",
            "\"closed\", \"open\"",
        ),
        (
            "[inputs.door]\nstop_category = 1",
            "inputs.door.stop_category",
            "",
        ),
    ] {
        let found = problems(&with(inputs));
        let fits = |problem: &&trirrr_scene::Problem| {
            problem.key == key && problem.reason.contains(reason)
        };
        assert!(
            found.iter().any(|problem| fits(&problem)),
            "{inputs}: {found:?}"
        );
    }
}
