//! `[tool]`: read, refused with key and reason, and waited for.

use crate::common::problems;
use trirrr_scene::{EnableLevel, JobMove, Scene, ToolKind, ToolPort};

const STEPPER: &str = include_str!("../../../../scenes/pick-stepper.toml");
const PLOTTER: &str = include_str!("../../../../scenes/plotter.toml");

/// `scene` with `tool` in place of its own.
fn with(scene: &str, tool: &str) -> String {
    let mut lines = Vec::new();
    let mut skips = false;
    for line in scene.lines() {
        if line.starts_with('[') {
            skips = line.starts_with("[tool]");
        }
        if line.starts_with("[limits]") {
            lines.push(tool);
        }
        if !skips {
            lines.push(line);
        }
    }
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/thesis.toml");
    lines
        .join("\n")
        .replace("\"thesis.toml\"", &format!("{machine:?}"))
}

fn scene(text: &str) -> Scene {
    Scene::parse(text, "scene.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn read(tool: &str) -> ToolPort {
    // Without the work of its job, which is that of a gripper.
    let text = with(STEPPER, tool).replace("tool = { power = 1.0 }", "");
    scene(&text).tool.expect("a tool")
}

const LASER: &str = "[tool]\nkind = \"pwm\"\nfrequency_hz = 5000\n";
const LIFTER: &str =
    "[tool]\nkind = \"servo\"\npulse_up_s = 0.0012\npulse_down_s = 0.0018\ntravel_s = 0.1\n";

#[test]
fn a_tool_is_read_with_its_defaults() {
    let laser = read(LASER);
    let kind = ToolKind::Pwm {
        frequency_hz: 5000,
        duty: [0.0, 1.0],
        enable: None,
    };
    // A stepper is where it was commanded a tick later, and so is the power.
    let expected = ToolPort {
        kind,
        inverted: false,
        delay_ticks: 1,
        travel_ticks: 0,
    };
    assert_eq!(laser, expected);
    let all = read(&format!(
        "{LASER}duty_min = 0.05\nduty_max = 0.9\nenable = \"low\"\ninverted = true\nlead_s = 0.002\n"
    ));
    let kind = ToolKind::Pwm {
        frequency_hz: 5000,
        duty: [0.05, 0.9],
        enable: Some(EnableLevel::Low),
    };
    assert_eq!((all.kind, all.inverted, all.delay_ticks), (kind, true, 0));
    assert_eq!(read(&format!("{LASER}lead_s = -0.01\n")).delay_ticks, 6);
    let lifter = read(LIFTER);
    assert_eq!((lifter.travel_ticks, lifter.delay_ticks), (50, 1));
    let gripper = read("[tool]\nkind = \"digital\"\nholds = true\n");
    assert_eq!(gripper.kind, ToolKind::Digital { holds: true });
    assert_eq!(gripper.travel_ticks, 0);
}

#[test]
fn what_no_board_puts_out_is_refused_with_its_key() {
    for (tool, key, reason) in [
        ("[tool]\nkind = \"laser\"\n", "tool.kind", "digital"),
        ("[tool]\nkind = \"pwm\"\n", "tool.frequency_hz", "missing"),
        (
            "[tool]\nkind = \"pwm\"\nfrequency_hz = 5\n",
            "tool.frequency_hz",
            "10 to 100000",
        ),
        (
            &format!("{LASER}duty_min = 0.9\nduty_max = 0.1\n"),
            "tool.duty_min",
            "inverted = true",
        ),
        (
            &format!("{LASER}lead_s = 0.01\n"),
            "tool.lead_s",
            "at most 0.002 (s)",
        ),
        (
            &format!("{LASER}lead_s = -1.0\n"),
            "tool.lead_s",
            "at least -0.126 (s)",
        ),
        (
            &format!("{LASER}travel_s = 0.1\n"),
            "tool.travel_s",
            "unknown key",
        ),
        (
            &LIFTER.replace("0.0018", "0.0012"),
            "tool.pulse_down_s",
            "must differ",
        ),
        (
            &format!("{LIFTER}frequency_hz = 400\npulse_x = 1\n").replace("0.0018", "0.0026"),
            "tool.pulse_down_s",
            "less than a period",
        ),
        (
            &LIFTER.replace("travel_s = 0.1", ""),
            "tool.travel_s",
            "missing",
        ),
        (
            &LIFTER.replace("= 0.1", "= 0.1234"),
            "tool.travel_s",
            "whole number of ticks",
        ),
    ] {
        let text = with(STEPPER, tool).replace("tool = { power = 1.0 }", "");
        let found = problems(&text);
        assert!(
            found
                .iter()
                .any(|problem| problem.key == key && problem.reason.contains(reason)),
            "{tool}: {found:?}"
        );
    }
}

/// Moves of a path and what the tool does in them, a letter each: stands and motions, on in capitals.
fn acts(moves: &[JobMove]) -> String {
    let act = |each: &JobMove| match (each.from == each.to, each.tool.is_some()) {
        (true, true) => 'S',
        (true, false) => 's',
        (false, true) => 'M',
        (false, false) => 'm',
    };
    let mut acts: Vec<char> = moves.iter().map(act).collect();
    acts.dedup();
    acts.into_iter().collect()
}

/// A path: there, two lines behind `before`, and back.
fn plotted_behind(before: &str, tool: &str, work: &str) -> String {
    let (head, _) = PLOTTER.split_once("[[job.path]]").expect("a path");
    let to =
        |x: f64, work: &str| format!("[[job.path]]\nline = {{ x_m = {x}, y_m = 0.24 }}\n{work}\n");
    let path = to(0.23, "") + before + &to(0.25, work) + &to(0.27, work) + &to(0.22, "");
    with(head, tool) + "\n" + &path
}

/// The same without a dwell.
fn plotted(tool: &str, work: &str) -> String {
    plotted_behind("", tool, work)
}

#[test]
fn the_machine_stands_while_a_pen_goes_down_and_up() {
    let down = "tool = { power = 1.0 }";
    let with_pen = scene(&plotted(LIFTER, down));
    let moves = &with_pen.job.moves;
    assert_eq!(acts(moves), "mSMsm");
    let stands: Vec<u32> = moves
        .iter()
        .filter(|each| each.from == each.to)
        .map(|each| each.duration_ticks)
        .collect();
    assert_eq!(stands, [100, 100]);
    // A tool that takes no time is not waited for, and neither is one of which the scene says nothing.
    let relay = scene(&plotted("[tool]\nkind = \"digital\"\n", down));
    assert_eq!(acts(&relay.job.moves), "mMm");
    assert_eq!(acts(&scene(&plotted("", down)).job.moves), "mMm");
    // Planned again, the path has the stands that it has.
    let mut again = with_pen.clone();
    let path = with_pen.job.path.clone().expect("a path");
    again.take_path(&path).expect("it has a plan");
    assert_eq!(&again.job.moves, moves);
}

#[test]
fn a_dwell_of_the_file_is_long_enough_for_the_pen() {
    let down = "tool = { power = 1.0 }";
    for (dwell, expected) in [("0.05", [100, 100]), ("0.2", [200, 100])] {
        let dwell = format!("[[job.path]]\ndwell_s = {dwell}\n{down}\n");
        let scene = scene(&plotted_behind(&dwell, LIFTER, down));
        let stands = scene.job.moves.iter().filter(|each| each.from == each.to);
        let ticks: Vec<u32> = stands.map(|each| each.duration_ticks).collect();
        assert_eq!(ticks, expected);
    }
}

#[test]
fn a_pen_does_not_follow_the_speed() {
    let follows = "tool = { power = 1.0, speed_m_s = 0.1 }";
    let found = problems(&plotted(LIFTER, follows));
    assert_eq!(found[0].key, "job.path[2]");
    assert!(found[0].reason.contains("follows no speed"), "{found:?}");
}

#[test]
fn a_move_that_does_not_wait_for_the_gripper_is_refused() {
    let gripper = "[tool]\nkind = \"digital\"\nholds = true\ntravel_s = 0.1\n";
    let whole = with(STEPPER, gripper);
    assert!(whole.contains("tool = { power = 1.0 }"), "the job grips");
    scene(&whole);
    let slow = with(STEPPER, &gripper.replace("0.1", "0.12"));
    let found = problems(&slow);
    assert_eq!(found[0].key, "job.move[3]");
    assert!(
        found[0].reason.contains("goes on here, and takes 0.12 s"),
        "{found:?}"
    );
}
