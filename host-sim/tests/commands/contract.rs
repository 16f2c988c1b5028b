//! Objects for programs, whose keys others rely on.

use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// Object that `trirrr COMMAND scenes/SCENE --json` prints.
fn object(command: &str, scene: &str) -> Value {
    let folder = TempDir::new().unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let output = crate::common::command(&folder, &[command, "--json"])
        .arg(scenes.join(scene))
        .output()
        .unwrap();
    assert!(output.status.success(), "{command} {scene}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} is {}", value[key]))
}

#[test]
fn a_plan_has_its_time_its_bound_and_its_moves() {
    let plan = object("plan", "engraving.toml");
    let [time, bound] = ["time_s", "lower_bound_s"].map(|key| number(&plan, key));
    assert!(0.0 < bound && bound <= time && time < 1.1 * bound);
    // The scene has 1,000 ticks a second.
    assert!((1e3 * time - number(&plan, "ticks")).abs() < 1e-6);
    assert!(number(&plan, "moves") > 1.0);
    let runs = plan["runs"].as_array().unwrap();
    let bounds: f64 = runs.iter().map(|run| number(run, "lower_bound_s")).sum();
    assert!((bounds + number(&plan, "dwells_s") - bound).abs() < 1e-9);
}

/// The area is an estimate of others, with a grid: 711 cm^2.
#[test]
fn a_design_has_eight_modes_and_a_workspace_with_two_bounds() {
    let design = object("design", "thesis.toml");
    let modes = design["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 8);
    for mode in modes {
        let elbows = mode["elbows"].as_array().unwrap();
        assert!(elbows.len() == 3 && elbows.iter().all(|sign| sign == 1 || sign == -1));
        assert_eq!(mode["feasible"] == true, mode["peak_torque_nm"].is_number());
    }
    // 25 digits: `tests/reference/true_massless.csv`.
    let own = modes
        .iter()
        .find(|mode| mode["elbows"] == serde_json::json!([1, 1, 1]))
        .unwrap();
    assert!((number(own, "peak_torque_nm") - 0.039_628_158).abs() < 1e-8);
    let rms = number(own, "rms_torque_nm");
    assert!(0.0 < rms && rms < number(own, "peak_torque_nm"));
    let workspace = &design["workspace"];
    let [lower, upper] = ["area_lower_m2", "area_upper_m2"].map(|key| number(workspace, key));
    assert!((number(workspace, "alpha_rad") - std::f64::consts::PI / 20.0).abs() < 1e-12);
    assert!(lower <= 711e-4 && 711e-4 <= upper && upper - lower < 0.01 * upper);
}

/// An argument that can have no effect is refused, not left out.
#[test]
fn a_device_whose_motors_stand_where_they_are_commanded_takes_no_offset() {
    let folder = TempDir::new().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/thesis.toml");
    let output = crate::common::command(&folder, &["device", "--listen", "tcp:127.0.0.1:0"])
        .arg(scene)
        .args(["--offset-rad", "-0.1", "0", "0.1"])
        .output()
        .unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("--offset-rad has nothing to move"), "{told}");
}

/// Times that are whole ticks are told with their digits alone.
#[test]
fn a_check_tells_the_duration_without_rounding() {
    let folder = TempDir::new().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/pick-stepper.toml");
    let output = crate::common::command(&folder, &["check"])
        .arg(scene)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let line = "4 moves, 1.4 s: 700 ticks at 500 Hz in fixed";
    assert!(said.lines().any(|each| each == line), "{said}");
    assert_eq!(
        number(&object("check", "pick-stepper.toml"), "duration_s"),
        1.4
    );
}
