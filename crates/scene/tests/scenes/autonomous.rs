//! `[service] autonomous`: read, and refused with key and reason where a board without a host cannot have it.

use crate::common::problems;
use trirrr_core::number::Fixed;
use trirrr_scene::{Autonomous, Scene};
use trirrr_service::features::{ButtonInput, FOREVER, JobStart};

const ALONE: &str = include_str!("../../../../scenes/autonomous/thesis-alone.toml");
const THESIS: &str = include_str!("../../../../scenes/thesis.toml");

/// The scene with the machine in its own text.
fn scene() -> String {
    let [machine, _] = THESIS.split("[limits]").collect::<Vec<_>>()[..] else {
        panic!("the thesis has limits");
    };
    let tables = machine.split_once("[[machine.leg]]").map(|(_, legs)| legs);
    let tables = format!("[[machine.leg]]{}[limits]", tables.expect("legs"));
    ALONE
        .replace("machine = \"../thesis.toml\"\n", "")
        .replace("[limits]", &tables)
}

fn changed(from: &str, to: &str) -> String {
    let text = scene();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

fn read(text: &str) -> Scene {
    Scene::parse(text, "alone.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn start_and_repeat_are_read_with_their_defaults() {
    let alone = read(&scene());
    let autonomous = Autonomous {
        begins: JobStart::Button,
        passes: 1,
    };
    assert_eq!(alone.service.autonomous, Some(autonomous));
    assert_eq!(alone.inputs.button, Some(ButtonInput { debounce_ticks: 2 }));
    assert!(!alone.may_slow_down());
    let start = "start = \"button\"";
    for (repeat, passes) in [("12", 12), ("\"forever\"", FOREVER)] {
        let text = changed(start, &format!("start = \"power\"\nrepeat = {repeat}"));
        let expected = Autonomous {
            begins: JobStart::Power,
            passes,
        };
        assert_eq!(read(&text).service.autonomous, Some(expected));
    }
    assert_eq!(read(THESIS).service.autonomous, None);
}

/// A stop that begins late in a pass goes on into the next one, as it does in the same moves written out.
#[test]
fn the_longest_stop_is_that_of_all_passes() {
    let start = "start = \"button\"";
    let with_ramp = |repeat: &str| changed(start, &format!("{start}\nhold_ramp_s = 5.0{repeat}"));
    let (head, moves) = ALONE.split_at(ALONE.find("[[job.move]]").expect("a move"));
    assert!(head.contains("[job]"));
    let longest = |text: &str| read(text).longest_stop().expect("a good job");
    let four = longest(&format!("{}\n{}", with_ramp(""), moves.repeat(3)));
    let once = longest(&with_ramp(""));
    assert!(
        once.time_s < four.time_s && once.way_m < four.way_m,
        "{once:?} {four:?}"
    );
    assert_eq!(longest(&with_ramp("\nrepeat = 4")), four);
    let forever = longest(&with_ramp("\nrepeat = \"forever\""));
    assert!(
        forever.time_s >= four.time_s && forever.way_m >= four.way_m,
        "{forever:?}"
    );
}

#[test]
fn passes_stand_one_behind_another_where_there_is_an_end_of_them() {
    let start = "start = \"button\"";
    for (repeat, passes) in [("1", 1), ("5", 5), ("\"forever\"", 1), ("999999999", 1)] {
        let mut scene = read(&changed(start, &format!("{start}\nrepeat = {repeat}")));
        assert_eq!(scene.unroll(), passes);
        assert_eq!(scene.job.moves.len(), 2 * passes as usize);
        assert_eq!(scene.ticks(), 200 * passes);
        for pair in scene.job.moves.windows(2) {
            assert_eq!(pair[0].to, pair[1].from);
        }
    }
}

#[test]
fn each_move_is_proven_in_the_number_type_of_the_image() {
    let scene = read(&scene());
    assert_eq!(scene.own_moves::<f32>().map(|moves| moves.len()), Ok(2));
    assert_eq!(scene.own_moves::<f64>().map(|moves| moves.len()), Ok(2));
    assert!(scene.own_moves::<Fixed>().is_ok());
    let fast = Scene {
        limits: trirrr_core::limits::LimitParameters {
            rate_rad_s: Some([0.3; 3]),
            ..scene.limits
        },
        ..scene
    };
    let refused = fast.own_moves::<f32>().expect_err("faster than that");
    assert!(
        refused.contains("job.move[1]") && refused.contains("Rate"),
        "{refused}"
    );
}

/// The only problem of `text`: key, part of the reason.
#[track_caller]
fn refused(text: &str, key: &str, reason: &str) {
    let problems = problems(text);
    let [problem] = &problems[..] else {
        panic!("{problems:?}");
    };
    let said = problem.to_string();
    assert!(said.contains(key) && said.contains(reason), "{said}");
}

#[test]
fn keys_of_a_line_are_refused() {
    for (key, value) in [
        ("silence_timeout_s", "2.0"),
        ("telemetry_ticks", "5"),
        ("batches", "true"),
        ("plans_paths", "true"),
        ("power_lists", "256"),
        ("adjustable", "true"),
        ("update", "true"),
    ] {
        let text = changed(
            "autonomous = true",
            &format!("autonomous = true\n{key} = {value}"),
        );
        refused(&text, &format!("service.{key}"), "has no line to a host");
    }
}

#[test]
fn what_needs_a_host_is_refused_by_its_table() {
    let with = |table: &str| changed("[limits]", &format!("{table}\n\n[limits]"));
    refused(&with("[inputs.probe]"), "inputs", "names a probe");
    refused(
        &with("[io]\noutputs = [{ name = \"valve\" }]"),
        "io",
        "spare outputs or inputs",
    );
    let odrive = include_str!("../../../../scenes/odrive.toml");
    let tables = odrive.split_inclusive("\n\n");
    let drives: String = tables.filter(|table| table.contains("[[drive]]")).collect();
    let problems = problems(&with(&drives));
    assert!(
        problems
            .iter()
            .any(|problem| problem.to_string().contains("has steppers or no drives")),
        "{problems:?}"
    );
}

#[test]
fn what_begins_the_job_is_there_and_its_job_begins_again_where_it_ends() {
    let button = "[inputs.button]\ndebounce_s = 0.02\n";
    refused(&changed(button, ""), "service", "add [inputs.button]");
    refused(
        &changed("[inputs.button]", "[inputs.button]\nnormally = \"closed\""),
        "inputs.button.normally",
        "must be \"open\"",
    );
    refused(
        &changed("autonomous = true\nstart = \"button\"", ""),
        "inputs",
        "put autonomous = true into [service]",
    );
    refused(
        &changed("autonomous = true\n", "").replace(button, ""),
        "service.start",
        "put autonomous = true beside it",
    );
    refused(
        &changed("start = \"button\"", "start = \"button\"\nrepeat = 0"),
        "service.repeat",
        "1",
    );
    refused(
        &changed(
            "start = \"button\"",
            "start = \"button\"\nrepeat = \"always\"",
        ),
        "service.repeat",
        "\"forever\"",
    );
    let back = "to = { x_m = 0.21, y_m = 0.22, alpha_rad = 0.15707963267948966 }";
    let elsewhere = changed(
        back,
        "to = { x_m = 0.22, y_m = 0.22, alpha_rad = 0.15707963267948966 }",
    );
    refused(&elsewhere, "job", "ends elsewhere than it starts");
    // Played once, it may end anywhere.
    let once = elsewhere.replace("start = \"button\"", "start = \"power\"");
    read(&once.replace(button, ""));
    refused(
        &once
            .replace(button, "")
            .replace("start = \"power\"", "start = \"power\"\nrepeat = 2"),
        "job",
        "ends elsewhere than it starts",
    );
}
