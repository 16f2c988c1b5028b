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
