//! `trirrr plan` prints the figures of docs/planning.md.

use crate::common::{json, trirrr};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Most of the reference that a plan takes.
const MOST: f64 = 1.02;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rows of the table of the manual that begins with `head`: their fields.
fn rows(head: &str) -> Vec<Vec<String>> {
    let manual = std::fs::read_to_string(repository().join("docs/planning.md")).expect("a manual");
    let table = manual.split_once(head).expect("a table").1;
    let lines = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let fields = |line: &str| {
        let fields = line.trim_matches('|').split('|');
        fields
            .map(|field| field.trim().trim_matches('`').to_owned())
            .collect()
    };
    lines.map(fields).collect()
}

fn plan(scene: &str) -> Value {
    let out = TempDir::new().expect("a folder");
    let scene = repository()
        .join("scenes")
        .join(scene)
        .with_extension("toml");
    let [scene, out] = [scene.as_path(), out.path()].map(|path| path.to_str().expect("a name"));
    json(&trirrr(
        repository(),
        &["plan", scene, "--json", "--out", out],
    ))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key}: {value}"))
}

/// Problems whose least times are known: what the manual says of them is what the command prints, and no plan is further off than it may be.
#[test]
fn problems_with_known_least_times_are_planned_as_the_manual_says() {
    let rows = rows("| scene in `planning/` |");
    assert_eq!(rows.len(), 8);
    for row in rows {
        let planned = plan(&format!("planning/{}", row[0]));
        let reference: f64 = row[2].parse().expect("a reference");
        let [bound, time, played] =
            ["lower_bound_s", "duration_s", "time_s"].map(|key| number(&planned, key));
        assert!(
            bound < reference && reference < time && time < played,
            "{planned}"
        );
        assert!(
            played <= MOST * reference,
            "{}: {played} of {reference}",
            row[0]
        );
        let printed = [
            format!("{bound:.5}"),
            format!("{time:.5}"),
            format!("{played:.3}"),
            planned["moves"].to_string(),
            format!("{:.4}", played / reference),
        ];
        assert_eq!(row[3..], printed, "{}", row[0]);
    }
}

#[test]
fn shipped_paths_take_as_long_as_the_manual_says() {
    let rows = rows("| scene | job | played, s (`trirrr plan`) |");
    assert!(rows.len() > 4);
    for row in rows {
        assert_eq!(
            format!("{:.3}", number(&plan(&row[0]), "time_s")),
            row[2],
            "{}",
            row[0]
        );
    }
}

/// A machine with one limit that acts is told so, whatever the others are: by the summary, and in each row of plan.csv.
#[test]
fn the_limit_that_acts_is_named() {
    let machine = repository().join("scenes/thesis-links.toml");
    let cases = [
        (
            "rate_rad_s = [1e3, 0.5, 1e3]",
            "",
            1000,
            "the rate of motor 2",
        ),
        (
            "acceleration_rad_s2 = [1e5, 1e5, 2.0]",
            "",
            1000,
            "the acceleration of motor 3",
        ),
        (
            "torque_nm = [0.5, 1e3, 1e3]",
            "",
            1000,
            "the torque of motor 1",
        ),
        (
            "torque_nm = 1e3\npower_w = [1e3, 1e3, 0.3]",
            "",
            1000,
            "the power of motor 3",
        ),
        (
            "acceleration_rad_s2 = 1e4\njerk_rad_s3 = [20, 1e6, 1e6]",
            "",
            1000,
            "the jerk of motor 1",
        ),
        ("torque_nm = 50", "feed_m_s = 0.1", 1000, "the feed"),
        // Moves of two ticks leave the path.
        ("torque_nm = 5", "tolerance_m = 1e-8", 100, "the tolerance"),
    ];
    let folder = TempDir::new().expect("a folder");
    for (limits, job, rate, name) in cases {
        let text = format!(
            "name = \"one\"\nmachine = {machine:?}\ntick_rate_hz = {rate}\nnumber = \"f64\"\n\
             [limits]\n{limits}\nserial_distance_min = 0.01\nparallel_distance_min = 0.01\n\
             [job]\nstart = {{ x_m = 0.3, y_m = 0.29, alpha_rad = 0.4 }}\ntiming = \"shortest\"\n{job}\n\
             [[job.path]]\narc = {{ centre_m = [0.25, 0.29], turn_rad = 0.5 }}\n"
        );
        let scene = folder.path().join("one.toml");
        std::fs::write(&scene, text).expect("a scene");
        let out = folder.path().join("out");
        let [scene, out] = [&scene, &out].map(|path| path.to_str().expect("a name"));
        let planned = json(&trirrr(
            repository(),
            &["plan", scene, "--json", "--out", out],
        ));
        let most = &planned["limits"][0];
        assert_eq!(most["limit"], name, "{planned}");
        let part = number(most, "time_s") / number(&planned, "duration_s");
        assert!(part > 0.95, "{name}: {part}");
        let table = std::fs::read_to_string(Path::new(out).join("plan.csv")).expect("a table");
        let rows = table.lines().skip(1).count();
        let named = table.lines().filter(|row| row.ends_with(name)).count();
        assert!(10 * named > 8 * rows, "{name}: {named} of {rows}");
    }
}
