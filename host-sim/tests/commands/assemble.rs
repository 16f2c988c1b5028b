//! `trirrr assemble`: printed text, files, exit codes.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.toml"))
}

fn assemble(folder: &TempDir, scene: &Path, more: &[&str]) -> Output {
    crate::common::command(folder, &[])
        .arg("assemble")
        .arg(scene)
        .args(more)
        .args(["--out", "here"])
        .output()
        .unwrap()
}

fn refusal(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|each| each.as_f64().unwrap())
        .collect()
}

#[test]
fn the_start_of_the_job_is_among_the_modes_and_is_marked() {
    let folder = TempDir::new().unwrap();
    let output = assemble(&folder, &scene("thesis"), &["--json"]);
    assert!(output.status.success());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["completeness"], "complete");
    let modes = found["assembly_modes"].as_array().unwrap();
    let own: Vec<&Value> = modes.iter().filter(|mode| mode["scene"] == true).collect();
    // The thesis's move begins at 0.21 m, 0.22 m, 9 degrees.
    let [mode] = own[..] else { panic!("{own:?}") };
    for (value, expected) in numbers(&mode["pose"])
        .iter()
        .zip([0.21, 0.22, 9f64.to_radians()])
    {
        assert!((value - expected).abs() < 1e-14, "{value}");
    }
    // Two modes that meet have opposite signs of det A: they come in pairs.
    let positive = modes
        .iter()
        .filter(|mode| mode["det_a"].as_f64().unwrap() > 0.0)
        .count();
    assert_eq!(2 * positive, modes.len());
    let working = found["working_modes"].as_array().unwrap();
    assert_eq!(working.len(), 8);
    let own = working.iter().find(|mode| mode["scene"] == true).unwrap();
    assert_eq!(own["motor_angles_rad"], found["motor_angles_rad"]);

    for file in ["assemblies.csv", "working_modes.csv"] {
        let text = std::fs::read_to_string(folder.path().join("here").join(file)).unwrap();
        let rows = if file == "assemblies.csv" {
            modes.len()
        } else {
            8
        };
        assert_eq!(text.lines().count(), 1 + rows);
        let widths: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
        assert!(widths.iter().all(|width| *width == widths[0]));
    }
    for (file, panels) in [("assemblies.svg", modes.len()), ("working_modes.svg", 8)] {
        let svg = std::fs::read_to_string(folder.path().join("here").join(file)).unwrap();
        assert_eq!(svg.matches("elbows ").count(), panels, "{file}");
    }
}

#[test]
fn degrees_radians_and_a_pose_lead_to_the_same_modes() {
    let folder = TempDir::new().unwrap();
    let list = |more: &[&str]| -> Vec<Vec<f64>> {
        let output = assemble(&folder, &scene("thesis"), &[more, &["--json"]].concat());
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        found["assembly_modes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|mode| numbers(&mode["pose"]))
            .collect()
    };
    let start = list(&[]);
    let near = |other: &[Vec<f64>]| {
        assert_eq!(start.len(), other.len());
        for (one, other) in start.iter().flatten().zip(other.iter().flatten()) {
            assert!((one - other).abs() < 1e-9, "{one} {other}");
        }
    };
    near(&list(&["--at-deg", "0.21,0.22,9"]));
    near(&list(&["--at-rad", "0.21,0.22,0.15707963267948966"]));
    near(&list(&[
        "--angles-rad",
        "-0.030088606128222874,-1.955310057191133,2.7896240217328057",
    ]));
    near(&list(&[
        "--angles-deg",
        "-1.7239501401,-112.0310140109,159.8336829497",
    ]));
}

#[test]
fn what_has_no_modes_is_refused_in_words_and_writes_nothing() {
    let folder = TempDir::new().unwrap();
    let refused = |scene: &Path, more: &[&str], expected: &str| {
        let said = refusal(&assemble(&folder, scene, more));
        assert!(said.contains(expected), "{expected} in\n{said}");
        assert!(!folder.path().join("here").exists());
    };
    let thesis = scene("thesis");
    refused(
        &thesis,
        &["--angles-deg", "100,200,300"],
        "no assembly: at the motor angles 100.0000, 200.0000, 300.0000 deg",
    );
    refused(
        &thesis,
        &["--angles-rad", "1,x,3"],
        "TH2 = `x` is no number",
    );
    refused(&thesis, &["--angles-deg", "1,2"], "expected three numbers");
    refused(
        &thesis,
        &["--angles-deg", "1,2,3", "--at-deg", "0,0,0"],
        "cannot be used with",
    );
    // 0.9 m is more than both links and the platform's radius from the base at x = 0.
    refused(
        &thesis,
        &["--at-deg", "0.9,0.2,0"],
        "leg 1 is 0.510413 m short of its platform joint",
    );
    refused(
        &folder.path().join("none.toml"),
        &[],
        "none.toml: cannot be read",
    );

    // Bases and platform are the same triangle: with equal angles the distal links stay parallel.
    let text = std::fs::read_to_string(&thesis).unwrap();
    let corners = [90f64, 210.0, 330.0];
    let mut changed: Vec<String> = Vec::new();
    let (mut base, mut joint) = (corners.iter(), corners.iter());
    for line in text.lines() {
        changed.push(match line.split_once(" = ") {
            Some(("base_m", _)) => {
                let (sin, cos) = base.next().unwrap().to_radians().sin_cos();
                format!("base_m = [{:?}, {:?}]", 0.1 * cos, 0.1 * sin)
            }
            Some(("joint_radius_m", _)) => "joint_radius_m = 0.1".into(),
            Some(("joint_angle_rad", _)) => {
                format!("joint_angle_rad = {:?}", joint.next().unwrap().to_radians())
            }
            _ => line.into(),
        });
    }
    let (head, _) = text.split_once("[job]").unwrap();
    let machine = changed.join("\n");
    let (machine, _) = machine.split_once("[job]").unwrap();
    assert!(head.contains("base_m"));
    let job = "[job]\nstart = { x_m = 0.05, y_m = 0.02, alpha_rad = 0.6 }\n[[job.move]]\nduration_s = 1.0\nto = { x_m = 0.05, y_m = 0.03, alpha_rad = 0.6 }\n";
    let file = folder.path().join("parallelogram.toml");
    std::fs::write(&file, format!("{machine}{job}")).unwrap();
    refused(
        &file,
        &["--angles-deg", "40,40,40"],
        "the platform is loose: infinitely many poses",
    );
}
