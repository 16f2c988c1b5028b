//! `[io]`: spare outputs and inputs, read, and refused with key and reason.

use crate::common::problems;
use trirrr_scene::{NormalContact, Scene, SpareInput, SpareOutput, SparePins};

const THESIS: &str = include_str!("../../../../scenes/thesis.toml");

/// The thesis machine at 1000 ticks per second with these pins.
fn with(io: &str) -> String {
    THESIS
        .replace("tick_rate_hz = 100", "tick_rate_hz = 1000")
        .replace("[job]", &format!("{io}\n[job]"))
}

fn read(io: &str) -> SparePins {
    let scene = Scene::parse(&with(io), "scene.toml");
    scene.unwrap_or_else(|error| panic!("{error}")).spare_pins
}

#[test]
fn outputs_and_inputs_are_read_with_their_defaults() {
    assert_eq!(read(""), SparePins::default());
    assert!(!read("").are_named());
    assert!(!read("[io]\nlamp = true").are_named());
    let pins = read(
        "[[io.outputs]]\nname = \"air\"\njob_only = true\n[[io.outputs]]\nname = \"vacuum\"\n\
         [[io.inputs]]\nname = \"fixture\"\n[[io.inputs]]\nname = \"lid\"\nnormally = \"closed\"\ndebounce_s = 0.02",
    );
    let outputs = [("air", true), ("vacuum", false)].map(|(name, job_only)| SpareOutput {
        name: name.into(),
        job_only,
    });
    let inputs = [
        ("fixture", 5, NormalContact::Open),
        ("lid", 20, NormalContact::Closed),
    ]
    .map(|(name, debounce_ticks, normally)| SpareInput {
        name: name.into(),
        debounce_ticks,
        normally,
    });
    assert_eq!(pins.outputs, outputs);
    assert_eq!(pins.inputs, inputs);
    assert_eq!(pins.output("vacuum"), Some(1));
    assert_eq!(pins.output("fixture"), None);
    assert_eq!(pins.active_high(), 0b10);
    let parameters = pins.parameters();
    assert_eq!((parameters.outputs, parameters.inputs), (2, 2));
    assert_eq!(parameters.in_jobs, 0b01);
    assert_eq!(parameters.debounce_ticks, [5, 20, 1, 1, 1, 1, 1, 1]);
}

#[test]
fn what_makes_no_sense_is_refused_with_its_key() {
    let nine = |key: &str| {
        let each = (0..9).map(|index| format!("[[io.{key}]]\nname = \"pin-{index}\"\n"));
        each.collect::<String>()
    };
    for (io, key, reason) in [
        ("[io]\noutput = 1", "io.output", "did you mean `outputs`?"),
        ("[[io.outputs]]", "io.outputs[1].name", "missing"),
        (
            "[[io.outputs]]\nname = \"a b\"",
            "io.outputs[1].name",
            "must be 1 to",
        ),
        (
            "[[io.outputs]]\nname = \"air\"\n[[io.inputs]]\nname = \"air\"",
            "io.inputs[1].name",
            "has this name",
        ),
        (
            "[[io.outputs]]\nname = \"air\"\ninverted = true",
            "io.outputs[1].inverted",
            "unknown key",
        ),
        (
            "[[io.outputs]]\nname = \"air\"\njob_only = 1",
            "io.outputs[1].job_only",
            "",
        ),
        (
            "[[io.inputs]]\nname = \"lid\"\nnormally = \"shut\"",
            "io.inputs[1].normally",
            "\"closed\", \"open\"",
        ),
        (
            "[[io.inputs]]\nname = \"lid\"\ndebounce_s = 0.2",
            "io.inputs[1].debounce_s",
            "0.1",
        ),
        (
            &nine("outputs"),
            "io.outputs",
            "at most 8 [[io.outputs]], found 9",
        ),
        (
            &nine("inputs"),
            "io.inputs",
            "at most 8 [[io.inputs]], found 9",
        ),
    ] {
        let found = problems(&with(io));
        let fits = |problem: &&trirrr_scene::Problem| {
            problem.key == key && problem.reason.contains(reason)
        };
        assert!(
            found.iter().any(|problem| fits(&problem)),
            "{io}: {found:?}"
        );
    }
}
