//! `trirrr run` and `trirrr check` of redundant machines, and what the other commands say of them; torques by Lagrange.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

const KINDS: [&str; 5] = ["4rrr", "6rrr", "prrr-2rrr", "2prrr-rrr", "3prrr"];

fn scene_file(name: &str) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    scenes.join(name).with_extension("toml")
}

fn trirrr(args: &[&str]) -> Output {
    let mut command = crate::common::command(".", &[]);
    command.args(args).output().expect("trirrr starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// A table by columns.
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Columns {
    fn read(file: &Path) -> Self {
        let mut reader = csv::Reader::from_path(file).expect("a table");
        let names = reader.headers().unwrap().iter().map(String::from).collect();
        let rows = reader.records().map(|row| {
            let row = row.unwrap();
            let values = row.iter().map(|field| field.parse::<f64>().unwrap());
            let values: Vec<f64> = values.collect();
            assert!(values.iter().all(|value| value.is_finite()), "{row:?}");
            values
        });
        let rows = rows.collect();
        Self { names, rows }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let column = self.names.iter().position(|it| it == name);
        let column = column.unwrap_or_else(|| panic!("no {name} in {:?}", self.names));
        self.rows.iter().map(|row| row[column]).collect()
    }

    /// Largest difference of two columns.
    fn off(&self, a: &str, b: &str) -> f64 {
        let pairs = self.column(a).into_iter().zip(self.column(b));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

#[test]
fn every_kind_runs_to_the_end_with_table_figures_plant_and_lagrange() {
    for kind in KINDS {
        let folder = TempDir::new().unwrap();
        let file = scene_file(&format!("redundant/{kind}"));
        let (file, out) = (file.to_str().unwrap(), folder.path().to_str().unwrap());
        let args = [
            "run",
            file,
            "--fast",
            "--out",
            out,
            "--lagrange",
            "--every",
            "25",
            "--json",
        ];
        let output = trirrr(&args);
        assert!(output.status.success(), "{kind}: {}", text(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(summary["end"], "complete");
        assert_eq!(summary["kind"], kind);
        for written in summary["files"].as_array().unwrap() {
            let written = Path::new(written.as_str().unwrap());
            assert!(fs::metadata(written).unwrap().len() > 100, "{written:?}");
        }
        let ticks = Columns::read(&folder.path().join("ticks.csv"));
        let legs = summary["motors"].as_array().unwrap().len();
        let greatest = summary["lagrange"]["greatest_torque_nm"].as_f64().unwrap();
        for leg in 1..=legs {
            let off = ticks.off(&format!("tau{leg}"), &format!("tau_lagrange{leg}"));
            assert!(off <= 1e-12 * greatest, "{kind}: {off:e} of {greatest}");
        }
        let sliders = summary["sliders"].as_array().unwrap();
        for slider in sliders {
            let leg = &slider["leg"];
            let off = ticks.off(&format!("Fs{leg}"), &format!("Fs_lagrange{leg}"));
            assert!(off <= 1e-12, "{kind}: {off:e} N");
        }
        assert_eq!(
            folder.path().join("slider.svg").exists(),
            !sliders.is_empty()
        );
        // The power of motors and sliders is what the table says of rates, torques and forces.
        for leg in 1..=legs {
            let torque = ticks.column(&format!("tau{leg}"));
            let rate = ticks.column(&format!("dth1_{leg}"));
            let power = ticks.column(&format!("P{leg}"));
            for ((torque, rate), power) in torque.iter().zip(rate).zip(power) {
                assert!((torque * rate - power).abs() < 1e-14);
            }
        }
        let plant = Columns::read(&folder.path().join("plant.csv"));
        assert_eq!(plant.rows.len(), 501);
        let peak = summary["plant"]["path_error_m"]["peak"].as_f64().unwrap();
        let [x, y] = ["x_error", "y_error"].map(|name| plant.column(name));
        let found = x.iter().zip(y).map(|(x, y)| x.hypot(y)).fold(0.0, f64::max);
        assert_eq!(found, peak);
        let work = summary["plant"]["work_j"].as_f64().unwrap();
        let missing = summary["plant"]["balance_error_j"].as_f64().unwrap();
        assert!(
            missing.abs() < 1e-9 * (1.0 + work.abs()),
            "{kind}: {missing:e}"
        );
    }
}

#[test]
fn the_summary_says_where_the_sliders_go_and_what_preload_costs() {
    let folder = TempDir::new().unwrap();
    let run = |kind: &str| {
        let file = scene_file(&format!("redundant/{kind}"));
        let out = folder.path().join(kind);
        let args = [
            "run",
            file.to_str().unwrap(),
            "--fast",
            "--out",
            out.to_str().unwrap(),
        ];
        let output = trirrr(&args);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let placed = run("2prrr-rrr");
    for words in [
        "slider 1 at ",
        "placed for the job",
        "least distance to a singularity 0.",
        "  path      peak ",
    ] {
        assert!(placed.contains(words), "{words:?} in {placed}");
    }
    let preloaded = run("4rrr");
    for words in [
        "torque norm",
        "without preload",
        "motor 4",
        "4 legs, 0 sliders",
    ] {
        assert!(preloaded.contains(words), "{words:?} in {preloaded}");
    }
}

#[test]
fn a_check_says_what_is_good_and_what_is_wrong() {
    let file = scene_file("redundant/3prrr");
    let file = file.to_str().unwrap();
    let good = trirrr(&["check", file]);
    assert!(good.status.success());
    assert!(text(&good.stdout).contains("3prrr: good\n3prrr, 3 legs, 3 sliders"));
    let bad = trirrr(&["check", file, "--set", "machine.leg[2].slider.mass_kg=-1"]);
    assert_eq!(bad.status.code(), Some(2));
    let said = text(&bad.stderr);
    let expected = "--set: machine.leg[2].slider.mass_kg = -1: must not be negative (kg)";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn arguments_and_commands_for_a_3_rrr_say_so() {
    let folder = TempDir::new().unwrap();
    let file = scene_file("redundant/4rrr");
    let (file, out) = (file.to_str().unwrap(), folder.path().join("out"));
    let out = out.to_str().unwrap();
    for (args, reason) in [
        (
            vec!["run", file, "--scalar", "f32", "--out", out],
            "computed in f64",
        ),
        (
            vec!["run", file, "--tolerances", "--out", out],
            "bounds a 3-RRR alone",
        ),
        (vec!["run", file, file, "--out", out], "one scene at a time"),
        (
            vec!["plan", file, "--out", out],
            "boards, streams, planning, designs, calibration and identification are for a 3-RRR",
        ),
        (
            vec!["stream", file, "--port", "127.0.0.1:1"],
            "are for a 3-RRR",
        ),
        (vec!["design", file, "--out", out], "are for a 3-RRR"),
        (
            vec!["check", file, "--figure", "x.svg"],
            "--figure draws a path",
        ),
    ] {
        let output = trirrr(&args);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(reason), "{args:?}: {said}");
    }
    assert!(!Path::new(out).exists(), "a refused command leaves nothing");
}

#[test]
fn a_3_rrr_has_columns_of_lagrange_too() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().to_str().unwrap();
    let file = scene_file("thesis-links");
    let file = file.to_str().unwrap();
    let output = trirrr(&[
        "run",
        file,
        "--fast",
        "--out",
        out,
        "--lagrange",
        "--every",
        "10",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("lagrange    largest difference "));
    let ticks = Columns::read(&folder.path().join("ticks.csv"));
    assert_eq!(ticks.rows.len(), 11);
    for leg in 1..=3 {
        let (own, other) = (format!("tau{leg}"), format!("tau_lagrange{leg}"));
        let greatest = ticks
            .column(&own)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(greatest > 0.0 && ticks.off(&own, &other) <= 1e-12 * greatest);
    }
    let plotter = scene_file("plotter");
    let output = trirrr(&["run", plotter.to_str().unwrap(), "--fast", "--lagrange"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--lagrange compares torques"));
}
