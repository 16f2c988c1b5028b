//! Scenes that are refused: each with the key, the value and the reason.

use super::{parsed, text};
use trirrr_scene::{Problem, SceneError};

fn problems(text: &str) -> Vec<Problem> {
    match parsed(text) {
        Err(SceneError::Refused { problems, .. }) => problems,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// Replaces the first `from` in the scene of `kind`, and demands one problem with this key, value and reason.
fn refused(kind: &str, from: &str, to: &str, [key, value, reason]: [&str; 3]) {
    let good = text(kind);
    assert!(good.contains(from), "no {from:?} in {kind}");
    let found = problems(&good.replacen(from, to, 1));
    let label = format!("{kind}: {from:?} -> {to:?}: {found:#?}");
    let [only] = found.as_slice() else {
        panic!("one problem expected, {label}");
    };
    assert_eq!(only.key, key, "{label}");
    assert_eq!(only.value.as_deref().unwrap_or(""), value, "{label}");
    assert!(only.reason.contains(reason), "{reason:?} in {label}");
    assert!(only.line > 0, "{label}");
}

#[test]
fn kinds_and_counts_that_do_not_go_together() {
    let other = "must be one of \"3rrr\", \"4rrr\"";
    refused(
        "4rrr",
        "kind = \"4rrr\"",
        "kind = \"5rrr\"",
        ["kind", "\"5rrr\"", other],
    );
    refused(
        "4rrr",
        "kind = \"4rrr\"",
        "kind = 4",
        ["kind", "4", "expected a string"],
    );
    let legs = "expected six [[machine.leg]], found 4";
    refused(
        "4rrr",
        "kind = \"4rrr\"",
        "kind = \"6rrr\"",
        ["machine.leg", "", legs],
    );
    let one = "has one leg with a slider, found 2";
    let kind = "kind = \"2prrr-rrr\"";
    refused(
        "2prrr-rrr",
        kind,
        "kind = \"prrr-2rrr\"",
        ["kind", "\"prrr-2rrr\"", one],
    );
    let three = "has 3 legs with a slider, found 2";
    refused(
        "2prrr-rrr",
        kind,
        "kind = \"3prrr\"",
        ["kind", "\"3prrr\"", three],
    );
}

#[test]
fn keys_that_are_unknown_or_of_a_3_rrr() {
    let leg = "machine.leg[1]";
    refused(
        "4rrr",
        "preload_nm = 0.3",
        "prelaod_nm = 0.3",
        [
            &format!("{leg}.prelaod_nm"),
            "0.3",
            "did you mean `preload_nm`?",
        ],
    );
    refused(
        "3prrr",
        "direction_rad = 0.0\n",
        "",
        [
            &format!("{leg}.slider.direction_rad"),
            "",
            "missing, expected a number in rad",
        ],
    );
    refused(
        "4rrr",
        "kp_nm_rad",
        "kp",
        ["plant.kp", "60.0", "did you mean"],
    );
    refused(
        "4rrr",
        "torque_nm = 3.0",
        "jerk_rad_s3 = 1.0",
        ["limits.jerk_rad_s3", "1.0", "unknown key"],
    );
    for (table, reason) in [
        ("[controller]\nrate_hz = 1000\n", "stand in [plant]"),
        ("[service]\nbatches = true\n", "no service on a board"),
        ("[homing]\n", "no service on a board"),
        ("[[drive]]\nkind = \"stepper\"\n", "no board drives"),
    ] {
        let key = table.trim_start_matches('[').split(']').next().unwrap();
        let text = format!("{}\n{table}", text("4rrr"));
        let found = problems(&text);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].key, key);
        assert!(found[0].reason.contains(reason), "{found:#?}");
    }
    refused(
        "4rrr",
        "name = ",
        "number = \"f32\"\nname = ",
        ["number", "", "computed in f64"],
    );
}

#[test]
fn values_out_of_their_bounds() {
    let slider = "machine.leg[1].slider";
    for (from, to, key, value, reason) in [
        (
            "mass_kg = 0.4",
            "mass_kg = -0.4",
            "mass_kg",
            "-0.4",
            "must not be negative (kg)",
        ),
        (
            "mass_kg = 0.4",
            "mass_kg = nan",
            "mass_kg",
            "nan",
            "must be a finite number",
        ),
        (
            "direction_rad = 0.0",
            "direction_rad = inf",
            "direction_rad",
            "inf",
            "must be a finite number",
        ),
        (
            "travel_m = [-0.1, 0.1]",
            "travel_m = [0.1, -0.1]",
            "travel_m",
            "[0.1, -0.1]",
            "then a higher one",
        ),
        (
            "travel_m = [-0.1, 0.1]",
            "travel_m = [0.1]",
            "travel_m",
            "[0.1]",
            "expected 2 numbers, found 1",
        ),
        (
            "place = \"best\"",
            "place = \"good\"",
            "place",
            "\"good\"",
            "must be one of",
        ),
        (
            "place = \"best\"",
            "place = \"best\"\nposition_m = 0.0",
            "position_m",
            "0.0",
            "leave one of them out",
        ),
        (
            "place = \"best\"",
            "position_m = 0.2",
            "position_m",
            "0.2",
            "outside of the travel from -0.1 to 0.1",
        ),
        (
            "force_n = 20.0",
            "force_n = 0",
            "limits.force_n",
            "0",
            "must be greater than 0",
        ),
        (
            "velocity_m_s = 0.5",
            "rate_m_s = 0.5",
            "limits.rate_m_s",
            "0.5",
            "unknown key",
        ),
    ] {
        refused(
            "2prrr-rrr",
            from,
            to,
            [&format!("{slider}.{key}"), value, reason],
        );
    }
    refused(
        "4rrr",
        "preload_nm = 0.3",
        "preload_nm = nan",
        ["machine.leg[1].preload_nm", "nan", "finite"],
    );
    refused(
        "4rrr",
        "rotor_inertia_kgm2 = 1e-4",
        "rotor_inertia_kgm2 = -1e-4",
        [
            "machine.leg[1].rotor_inertia_kgm2",
            "-1e-4",
            "must not be negative",
        ],
    );
    refused(
        "4rrr",
        "torque_nm = 3.0",
        "torque_nm = [3.0, 3.0, 3.0]",
        [
            "limits.torque_nm",
            "[3.0, 3.0, 3.0]",
            "or 4 of them, found 3 values",
        ],
    );
    refused(
        "6rrr",
        "torque_nm = 3.0",
        "torque_nm = [3.0, 3.0, 3.0, -1, 3.0, 3.0]",
        ["limits.torque_nm[4]", "-1", "must be greater than 0 (N m)"],
    );
    refused(
        "4rrr",
        "parallel_distance_min = 0.1",
        "parallel_distance_min = 1.0",
        ["limits.parallel_distance_min", "1.0", "less than 1"],
    );
    for key in [
        "kp_nm_rad",
        "kd_nm_s_rad",
        "friction_nm_s_rad",
        "extra_mass_kg",
    ] {
        let good = text("4rrr");
        let line = good.lines().find(|line| line.starts_with(key)).unwrap();
        let reason = "must not be negative";
        refused(
            "4rrr",
            line,
            &format!("{key} = -1"),
            [&format!("plant.{key}"), "-1", reason],
        );
    }
}

#[test]
fn jobs_that_cannot_be_played() {
    let job = "[[job.move]]";
    let path =
        "timing = \"shortest\"\n[[job.path]]\nline = { x_m = 0.3, y_m = 0.3 }\n[[job.ignored]]";
    refused(
        "4rrr",
        job,
        path,
        ["job.timing", "", "paths are planned for a 3-RRR alone"],
    );
    refused(
        "4rrr",
        "duration_s = 1.0",
        "duration_s = 1.0\ntool = { power = 0.5 }",
        ["job.move[1].tool", "{ power = 0.5 }", "no service"],
    );
    refused(
        "4rrr",
        "duration_s = 1.0",
        "duration_s = 1.0\nsliders_m = 0.1",
        ["job.move[1].sliders_m", "0.1", "has no sliders"],
    );
    refused(
        "prrr-2rrr",
        "sliders_m = 0.04",
        "sliders_m = 0.14",
        [
            "job.move[1].sliders_m",
            "0.14",
            "slider of leg 3: is outside of the travel",
        ],
    );
    refused(
        "2prrr-rrr",
        "duration_s = 1.0",
        "duration_s = 1.0\nsliders_m = 0.05",
        [
            "job.move[1].sliders_m",
            "0.05",
            "holds the slider over the whole job",
        ],
    );
    refused(
        "2prrr-rrr",
        "duration_s = 1.0",
        "duration_s = 1.0\nsliders_m = [0.05, 0.0, 0.0]",
        [
            "job.move[1].sliders_m",
            "[0.05, 0.0, 0.0]",
            "or 2 of them, found 3 values",
        ],
    );
    refused(
        "4rrr",
        "duration_s = 1.0",
        "duration_s = 1.001",
        ["job.move[1].duration_s", "1.001", "whole number of ticks"],
    );
    refused(
        "prrr-2rrr",
        "duration_s = 1.0",
        "duration_s = 10001.0",
        ["job", "", "at most 1000000 are allowed"],
    );
}

#[test]
fn moves_that_break_a_limit_say_when_what_and_by_how_much() {
    for (kind, from, to, reasons) in [
        (
            "4rrr",
            "torque_nm = 3.0",
            "torque_nm = 0.5",
            ["torque of motor", "the most allowed is 0.5 N m"],
        ),
        (
            "4rrr",
            "rate_rad_s = 3.0",
            "rate_rad_s = 0.2",
            ["rate of motor", "; at worst"],
        ),
        (
            "4rrr",
            "parallel_distance_min = 0.1",
            "parallel_distance_min = 0.9",
            ["parallel singularity", "the least allowed is 0.9"],
        ),
        (
            "4rrr",
            "serial_distance_min = 0.2",
            "serial_distance_min = 0.99",
            ["serial singularity of leg", "the least allowed"],
        ),
        (
            "4rrr",
            "x_m = 0.33",
            "x_m = 0.73",
            ["at t = ", "unreachable"],
        ),
        (
            "prrr-2rrr",
            "force_n = 20.0",
            "force_n = 0.1",
            ["force of the slider of leg 3", "the most allowed is 0.1 N"],
        ),
        (
            "prrr-2rrr",
            "velocity_m_s = 0.5",
            "velocity_m_s = 0.05",
            ["velocity of the slider of leg 3", "0.05 m/s"],
        ),
        (
            "prrr-2rrr",
            "power_w = 5.0",
            "power_w = 0.001",
            ["power of the slider of leg 3", "0.001 W"],
        ),
    ] {
        let good = text(kind);
        assert!(good.contains(from), "{kind}: {from}");
        let found = problems(&good.replacen(from, to, 1));
        let [only] = found.as_slice() else {
            panic!("{found:#?}");
        };
        assert_eq!(only.key, "job.move[1]");
        assert!(
            only.reason.contains("s of the move, x = "),
            "{}",
            only.reason
        );
        for reason in reasons {
            assert!(
                only.reason.contains(reason),
                "{reason:?} in {}",
                only.reason
            );
        }
    }
}

#[test]
fn a_machine_without_a_good_place_for_its_sliders() {
    // The middle leg is out of the way of the whole travel.
    refused(
        "2prrr-rrr",
        "x_m = 0.21, y_m = 0.22",
        "x_m = 0.21, y_m = 0.92",
        ["machine", "", "place = \"best\": none of"],
    );
}

#[test]
fn a_file_that_is_no_toml_is_refused_with_the_line() {
    let found = problems(&text("4rrr").replace("name = \"4rrr\"", "name = "));
    assert!(
        found[0].reason.contains("not TOML") && found[0].line == 4,
        "{found:#?}"
    );
}
