//! `trirrr design`: what its report says, against what other commands say.

use crate::common::{json, keeps_schema, trirrr};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn repository(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

fn scene(name: &str) -> String {
    repository(&format!("scenes/{name}.toml"))
        .display()
        .to_string()
}

#[test]
fn the_mode_of_the_scene_is_as_it_is_run_and_planned() {
    let folder = TempDir::new().unwrap();
    let engraving = scene("engraving");
    let design = json(&trirrr(
        &folder,
        &["design", &engraving, "--json", "--cells", "64"],
    ));
    keeps_schema("design", std::slice::from_ref(&design));
    let run = json(&trirrr(
        &folder,
        &["run", "--fast", "--json", "--scalar", "f64", &engraving],
    ));
    let modes = design["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 8);
    let own = modes
        .iter()
        .find(|mode| mode["elbows"] == design["elbows"])
        .unwrap();
    assert_eq!(own["feasible"], true);
    assert_eq!(own["duration_s"], run["duration_s"]);
    for motor in 0..3 {
        let peak = own["figures"]["torque_peak_nm"][motor].as_f64().unwrap();
        let played = run["motors"][motor]["peak_torque_nm"]["value"]
            .as_f64()
            .unwrap()
            .abs();
        assert!((peak / played - 1.0).abs() < 1e-9, "{peak} {played}");
    }
    // As with the elbows set by hand.
    for mode in modes {
        let set: Vec<String> = (0..3)
            .map(|leg| format!("machine.leg[{}].elbow={}", leg + 1, mode["elbows"][leg]))
            .collect();
        let checked = trirrr(
            &folder,
            &[
                "check", &engraving, "--set", &set[0], "--set", &set[1], "--set", &set[2],
            ],
        );
        assert_eq!(checked.status.success(), mode["feasible"] == true, "{mode}");
        assert_eq!(mode["reason"].is_null(), mode["feasible"] == true);
    }
    for file in [
        "report.html",
        "workspace.svg",
        "geometry.svg",
        "map.csv",
        "result.json",
    ] {
        let text =
            fs::read_to_string(folder.path().join("out/engraving-design").join(file)).unwrap();
        assert!(text.len() > 100, "{file}");
    }
    let motors = design["motors"].as_array().unwrap();
    assert_eq!(motors.len(), 26);
    // Motors without an inertia of their rotor come behind the others.
    let (known, unknown): (Vec<&serde_json::Value>, Vec<&serde_json::Value>) = motors
        .iter()
        .partition(|motor| motor["inertia_ratio"].is_number());
    assert!(known.len() >= 5 && unknown.len() >= 5);
    assert_eq!(
        motors.iter().collect::<Vec<_>>(),
        [known.clone(), unknown.clone()].concat()
    );
    for each in [known, unknown] {
        let margins = each.iter().map(|motor| motor["margin"].as_f64().unwrap());
        assert!(margins.rev().is_sorted());
    }
    let page = fs::read_to_string(folder.path().join("out/engraving-design/report.html")).unwrap();
    let files = fs::read_dir(folder.path().join("out/engraving-design")).unwrap();
    let names = files.map(|file| file.unwrap().path());
    let figures = names.filter(|path| path.extension().is_some_and(|kind| kind == "svg"));
    // The scene gives no stiffness and no tolerances.
    assert_eq!(figures.count(), 19);
    assert_eq!(page.matches("<svg").count(), 19);
    for missing in ["compliance needs", "offset within tolerances needs"] {
        assert!(page.contains(missing), "{missing}");
    }
    // Nothing comes from elsewhere; the links are those of the motors' sources.
    assert!(!page.contains("src=") && page.matches("<script").count() == 1);
    assert_eq!(page.matches("href=").count(), motors.len());
}

#[test]
fn a_scene_that_is_wrong_in_its_mode_is_studied_in_another() {
    let folder = TempDir::new().unwrap();
    let thesis = scene("thesis");
    let wrong = ["--set", "machine.leg[1].elbow=-1"];
    let checked = trirrr(&folder, &[&["check", &thesis][..], &wrong].concat());
    assert_eq!(checked.status.code(), Some(2));
    let design = trirrr(
        &folder,
        &[&["design", &thesis, "--json", "--cells", "32"][..], &wrong].concat(),
    );
    let design = json(&design);
    assert_ne!(design["elbows"], serde_json::json!([-1, 1, 1]));
    let output = trirrr(&folder, &["design", &thesis, "--set", "job.start.x_m=3"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("leg"));
    fs::write(folder.path().join("own.toml"), "[[motor]]\nname = 'a'\n").unwrap();
    for file in ["own.toml", "none.toml"] {
        let output = trirrr(&folder, &["design", &thesis, "--motors", file]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(file));
    }
    for wrong in [["--alpha", "x"], ["--turn", "-1"], ["--cells", "3"]] {
        let output = trirrr(&folder, &[&["design", &thesis][..], &wrong].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
}

/// A platform that has to turn has less room; how much is bounded on both sides.
#[test]
fn a_turn_leaves_less_room() {
    let folder = TempDir::new().unwrap();
    let thesis = scene("thesis");
    let area = |turn: &str| {
        let arguments = ["design", &thesis, "--json", "--cells", "64", "--turn", turn];
        let design = json(&trirrr(&folder, &arguments));
        let bounds = ["area_lower_m2", "area_upper_m2"];
        bounds.map(|bound| design["workspace"][bound].as_f64().unwrap())
    };
    let (none, little, much) = (area("0"), area("10"), area("40"));
    assert!(
        none[0] > little[0] && none[1] > little[1],
        "{none:?} {little:?}"
    );
    assert!(little[0] > much[1] && much[0] > 0.0, "{little:?} {much:?}");
    for [low, high] in [none, little, much] {
        assert!(low < high && high - low < 0.01);
    }
}
