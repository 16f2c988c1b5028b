//! `[io]`: spare outputs and inputs, read, and refused with key and reason.

use crate::common::problems;
use trirrr_scene::{NormalContact, OutputBits, Scene, SpareInput, SpareOutput, SparePins};

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

const VALVES: &str = "[[io.outputs]]\nname = \"air\"\n[[io.outputs]]\nname = \"vacuum\"\n";

/// The thesis machine with both valves, and a job of these tables.
fn with_job(job: &str) -> String {
    let text = with(VALVES);
    let (machine, _) = text.split_once("[job]").expect("a job");
    format!("{machine}[job]\nstart = {{ x_m = 0.21, y_m = 0.22, alpha_rad = 0.1 }}\n{job}")
}

/// A move to this x in 0.8 s.
fn move_to(x_m: f64, more: &str) -> String {
    format!(
        "[[job.move]]\nto = {{ x_m = {x_m}, y_m = 0.22, alpha_rad = 0.1 }}\ncurve = \"quintic\"\nduration_s = 0.8\n{more}\n"
    )
}

const ON: OutputBits = OutputBits {
    on: 0b10,
    off: 0b01,
};
const OFF: OutputBits = OutputBits { on: 0, off: 0b10 };

#[test]
fn outputs_change_with_the_moves_of_a_job() {
    let job = [
        move_to(0.25, "outputs = { air = false, vacuum = true }"),
        move_to(0.23, ""),
        move_to(0.21, "outputs.vacuum = false"),
    ];
    let scene = Scene::parse(&with_job(&job.concat()), "scene.toml");
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.job.outputs.changes(), [(0, ON), (2, OFF)]);
}

/// Along a line that the machine passes without a stop, in a dwell, and by themselves.
#[test]
fn outputs_change_along_a_path() {
    let line = |x_m: f64, more: &str| {
        format!("[[job.path]]\nline = {{ x_m = {x_m}, y_m = 0.22 }}\n{more}\n")
    };
    let job = [
        "timing = \"shortest\"\n".to_owned(),
        line(0.23, ""),
        line(0.25, "outputs = { air = false, vacuum = true }"),
        line(0.27, ""),
        "[[job.path]]\ndwell_s = 0.2\noutputs.vacuum = false\n".to_owned(),
        "[[job.path]]\noutputs = { air = false, vacuum = true }\n".to_owned(),
        line(0.21, "outputs.vacuum = false"),
    ];
    let scene = Scene::parse(&with_job(&job.concat()), "scene.toml");
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let changes = scene.job.outputs.changes();
    let bits: Vec<OutputBits> = changes.iter().map(|(_, bits)| *bits).collect();
    assert_eq!(bits, [ON, OFF, ON, OFF]);
    let moves: Vec<_> = changes
        .iter()
        .map(|(index, _)| scene.job.moves[*index as usize])
        .collect();
    assert!((moves[0].from.position.x - 0.23).abs() < 1e-3, "{moves:?}");
    assert!(moves[0].start_velocity.x > 0.01, "it does not stop there");
    assert_eq!((moves[1].from, moves[1].duration_ticks), (moves[1].to, 200));
    assert_eq!((moves[2].from, moves[2].duration_ticks), (moves[2].to, 1));
    assert_eq!(moves[3].start_velocity.amax(), 0.0);
    assert!(moves[3].from != moves[3].to);
    // Without the changes the moves are those of one straight line: a change parts them, and nothing else.
    let plain = job.concat().replace("outputs.vacuum = false", "");
    let plain = plain.replace("outputs = { air = false, vacuum = true }", "");
    let plain = plain.replace("[[job.path]]\n\n", "");
    let plain = Scene::parse(&with_job(&plain), "scene.toml");
    let plain = plain.unwrap_or_else(|error| panic!("{error}"));
    assert!(plain.job.outputs.is_empty());
    assert!(plain.ticks().abs_diff(scene.ticks()) < 20);
}

#[test]
fn outputs_of_a_job_are_refused_with_their_key() {
    let dwell = "timing = \"shortest\"\n[[job.path]]\n";
    for (job, key, reason) in [
        (
            move_to(0.25, "outputs = { vent = true }"),
            "job.move[1].outputs.vent",
            "those of [[io.outputs]] are air, vacuum",
        ),
        (
            move_to(0.25, "outputs = { air = 1 }"),
            "job.move[1].outputs.air",
            "expected true or false",
        ),
        (
            move_to(0.25, "outputs = {}"),
            "job.move[1].outputs",
            "names no output",
        ),
        (
            move_to(0.25, "outputs = true"),
            "job.move[1].outputs",
            "a table",
        ),
        (
            format!("{dwell}outputs = {{ vent = true }}"),
            "job.path[1].outputs.vent",
            "has this name",
        ),
        (
            format!("{dwell}outputs = {{ air = true }}"),
            "job.path",
            "only stands",
        ),
        (
            format!("{dwell}outputs = {{ air = true }}\nfeed_m_s = 1.0"),
            "job.path[1].feed_m_s",
            "a change of outputs",
        ),
    ] {
        let found = problems(&with_job(&job));
        let fits =
            |problem: &trirrr_scene::Problem| problem.key == key && problem.reason.contains(reason);
        assert!(found.iter().any(fits), "{job}: {found:?}");
    }
    let found = problems(&with_job(&move_to(0.25, "outputs.air = true")).replace(VALVES, ""));
    let reason = "the scene names no spare outputs";
    assert!(found[0].reason.contains(reason), "{found:?}");
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
