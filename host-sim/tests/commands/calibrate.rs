//! `trirrr calibrate` and `trirrr identify`: results, files and refusals.

use crate::common::{json, keeps_schema, trirrr};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

fn repository(file: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    path.display().to_string()
}

fn refused(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    said
}

#[test]
fn the_example_of_the_manual_is_calibrated_and_its_scene_runs() {
    let folder = TempDir::new().unwrap();
    let (thesis, table) = (
        repository("scenes/thesis.toml"),
        repository("scenes/measurements/thesis.csv"),
    );
    let found = json(&trirrr(
        &folder,
        &["calibrate", &thesis, &table, "--json", "--propose", "4"],
    ));
    let calibration = &found["calibration"];
    assert_eq!(calibration["directions"]["seen"], 21);
    let outliers = calibration["outliers"].as_array().unwrap();
    assert_eq!(
        (outliers.len(), &outliers[0]["line"]),
        (1, &Value::from(15))
    );
    let after = calibration["workspace"]["after"]["worst_m"]
        .as_f64()
        .unwrap();
    let before = calibration["workspace"]["before"]["rms_m"]
        .as_f64()
        .unwrap();
    assert!(before > 300e-6 && after < 30e-6, "{before} {after}");
    assert!(calibration["refusal"].is_null(), "{calibration}");
    // The thesis scene has no drives that know their zero.
    assert!(calibration["offsets_in"].is_null());
    let out = folder.path().join("out/thesis-calibration");
    let text = fs::read_to_string(out.join("thesis.toml")).unwrap();
    assert!(
        text.contains("# was 0.2\n") && text.contains("# Encoder offsets have no key"),
        "{text}"
    );
    assert!(text.contains("# 150 degrees") && text.contains("[job]"));
    for file in [
        "residuals.svg",
        "vectors.svg",
        "residuals.csv",
        "calibration.json",
        "measurements-next.csv",
    ] {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 100, "{file}");
    }
    let again = trirrr(
        &folder,
        &["run", "--fast", "out/thesis-calibration/thesis.toml"],
    );
    assert!(
        again.status.success(),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    // The proposed poses are a job for the machine.
    let poses = "out/thesis-calibration/poses.csv";
    let run = trirrr(&folder, &["run", "--fast", poses, "--machine", &thesis]);
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    // A refusal leaves the results as they are.
    fs::write(folder.path().join("bad.csv"), "th1_1;th1_2\n").unwrap();
    let said = refused(&trirrr(&folder, &["calibrate", &thesis, "bad.csv"]));
    assert!(
        said.contains("bad.csv:1: the columns are separated by semicolons"),
        "{said}"
    );
    assert!(out.join("calibration.json").exists());
}

#[test]
fn offsets_go_where_the_scene_has_a_place_for_them() {
    let folder = TempDir::new().unwrap();
    let table = repository("scenes/measurements/thesis.csv");
    let odrive = repository("scenes/plant-odrive.toml");
    let found = json(&trirrr(&folder, &["calibrate", &odrive, &table, "--json"]));
    let calibration = &found["calibration"];
    assert_eq!(calibration["offsets_in"], "drive.zero_rad");
    let text = fs::read_to_string(
        folder
            .path()
            .join("out/plant-odrive-calibration/plant-odrive.toml"),
    )
    .unwrap();
    let zeros: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("zero_rad = ")?.parse().ok())
        .collect();
    for (zero, offset) in zeros
        .iter()
        .zip(calibration["offsets_rad"].as_array().unwrap())
    {
        assert!(
            (zero - offset.as_f64().unwrap()).abs() < 1e-9,
            "{zero} {offset}"
        );
    }
    assert_eq!(zeros.len(), 3);
    // A scene whose machine stands in another file gets copies of both.
    let own = format!(
        "name = 'own'\nmachine = '{}'\n\n[job]\nstart = {{ x_m = 0.21, y_m = 0.22, alpha_rad = 0.157 }}\n\n[[job.move]]\nto = {{ x_m = 0.25, y_m = 0.25, alpha_rad = 0.1 }}\nduration_s = 2.0\n",
        repository("scenes/thesis.toml")
    );
    fs::write(folder.path().join("own.toml"), own).unwrap();
    let found = json(&trirrr(
        &folder,
        &[
            "calibrate",
            "own.toml",
            &table,
            "--json",
            "--hold",
            "offset",
            "--expected-m",
            "0.005",
        ],
    ));
    assert!(found["calibration"]["refusal"].is_null(), "{found}");
    let out = folder.path().join("out/own-calibration");
    assert!(
        fs::read_to_string(out.join("own.toml"))
            .unwrap()
            .contains("machine = \"thesis.toml\"")
    );
    assert!(out.join("thesis.toml").exists());
}

#[test]
fn bad_measurements_are_refused_with_file_line_and_column() {
    let folder = TempDir::new().unwrap();
    let thesis = repository("scenes/thesis.toml");
    let good = fs::read_to_string(repository("scenes/measurements/thesis.csv")).unwrap();
    let first = good.lines().nth(3).unwrap().to_owned();
    let cases = [
        (good.replace("x_m", "x"), "bad.csv:1: x: not known"),
        (good.replace("0.", "0,"), "decimal points"),
        (
            good.replace(&first, "nan,0,0,0.2,0.2,0,"),
            "bad.csv:4: th1_1: \"nan\" is no finite number",
        ),
        (
            good.lines().take(8).collect::<Vec<_>>().join("\n"),
            "nothing is left to check",
        ),
        (good.replace("th1_1,", "th1_1_deg,"), "bad.csv"),
    ];
    for (text, word) in cases {
        fs::write(folder.path().join("bad.csv"), text).unwrap();
        let said = refused(&trirrr(&folder, &["calibrate", &thesis, "bad.csv"]));
        assert!(said.contains(word), "{word}: {said}");
        assert!(!folder.path().join("out").exists());
    }
    fs::write(folder.path().join("bad.csv"), [0xff, 0xfe, 0x00]).unwrap();
    let said = refused(&trirrr(&folder, &["calibrate", &thesis, "bad.csv"]));
    assert!(said.contains("UTF-8"), "{said}");
    for wrong in [
        &["calibrate", &thesis][..],
        &["calibrate", &thesis, "none.csv"],
        &["calibrate", &thesis, "bad.csv", "--free", "moon"],
    ] {
        refused(&trirrr(&folder, wrong));
    }
}

/// Vertical machine of the shipped scenes with ideal motors that rub, under a controller that is continuous in time.
fn rubbing(folder: &TempDir) -> String {
    let text = fs::read_to_string(repository("scenes/plant-vertical.toml")).unwrap();
    let (head, rest) = text.split_once("[[drive]]").unwrap();
    let (_, tail) = rest.split_once("[limits]").unwrap();
    let plant = "[plant]\ntolerance = 1e-7\n\n[controller]\ntiming = \"continuous\"\nkp_nm_rad = 300.0\nkd_nm_s_rad = 12.0\n\n\
        [plant.friction]\nmotor = { viscous_nm_s_rad = 0.05, coulomb_nm = 0.15, stick_rad_s = 0.01 }\n\n[limits]";
    let own = format!("{head}{plant}{tail}").replace("\"plant-vertical\"", "\"rubbing\"");
    fs::write(folder.path().join("rubbing.toml"), own).unwrap();
    "rubbing.toml".into()
}

#[test]
fn masses_and_friction_of_a_simulated_machine_are_found() {
    let folder = TempDir::new().unwrap();
    let scene = rubbing(&folder);
    let run = trirrr(&folder, &["run", "--fast", &scene]);
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    let table = "out/rubbing/plant.csv";
    // The scene that is asked has another platform.
    let wrong = [
        "--set",
        "platform.mass_kg=0.9",
        "--set",
        "platform.com_m=[0.0, 0.0]",
        "--set",
        "platform.inertia_kgm2=0.01",
    ];
    let arguments = [
        &["identify", &scene, table, "--json", "--free", "links"][..],
        &wrong,
    ]
    .concat();
    let found = json(&trirrr(&folder, &arguments));
    let platform = [
        1.2,
        1.2 * 0.01,
        1.2 * 0.03,
        0.006 + 1.2 * (0.01 * 0.01 + 0.03 * 0.03),
    ];
    let parameters = found["parameters"].as_array().unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let mut compared = 0;
    for parameter in parameters.iter().filter(|it| number(&it["seen"]) >= 0.005) {
        let name = parameter["name"].as_str().unwrap();
        let (value, deviation) = (number(&parameter["value"]), number(&parameter["deviation"]));
        let real = match name {
            _ if name.starts_with("viscous") => 0.05,
            _ if name.starts_with("Coulomb") => 0.15,
            _ => continue,
        };
        compared += 1;
        assert!(
            (value - real).abs() < 4.0 * deviation + 1e-3 * real,
            "{name}: {value} +- {deviation}, {real}"
        );
        assert!(deviation < 0.1 * real, "{name}: {deviation}");
    }
    assert_eq!(compared, 6);
    // With the links held at what they are, nothing else explains the platform.
    let arguments = [
        &["identify", &scene, table, "--json", "--hold", "links"][..],
        &wrong,
    ]
    .concat();
    let found = json(&trirrr(&folder, &arguments));
    keeps_schema("identify", std::slice::from_ref(&found));
    let parameters = found["parameters"].as_array().unwrap();
    for (parameter, real) in parameters.iter().zip(platform) {
        let (value, deviation) = (number(&parameter["value"]), number(&parameter["deviation"]));
        assert!(
            (value - real).abs() < 4.0 * deviation + 1e-3 * real,
            "{parameter}: {real}"
        );
        assert!(number(&parameter["seen"]) > 0.99, "{parameter}");
    }
    let residuals = [0, 1].map(|index| number(&found["check_nm"][index]));
    assert!(residuals[1] < 0.05 * residuals[0], "{residuals:?}");
    assert_eq!(found["impossible"], Value::Array(Vec::new()));
    let out = folder.path().join("out/rubbing-identification");
    let text = fs::read_to_string(out.join("rubbing.toml")).unwrap();
    assert!(text.contains("# was 1.2"), "{text}");
    assert!(fs::metadata(out.join("torques.svg")).unwrap().len() > 1000);
}

/// Drives that hold a position from tick to tick tell a torque that depends on the place in the tick, in proportion to the rate.
#[test]
fn friction_behind_drives_that_hold_a_position_is_found_but_for_the_viscous_part() {
    let folder = TempDir::new().unwrap();
    let scene = repository("scenes/plant-odrive.toml");
    let job = repository("scenes/jobs/friction.csv");
    let run = ["run", "--fast", &job, "--machine", &scene, "--out", "out"];
    let run = trirrr(&folder, &run);
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    let asked = ["identify", &scene, "out/drives.csv", "--free", "joints"];
    let identified = |more: &[&str]| json(&trirrr(&folder, &[&asked[..], more].concat()));
    let found = identified(&["--json"]);
    let number = |value: &Value| value.as_f64().unwrap();
    let parameters = found["parameters"].as_array().unwrap();
    let of = |name: &str| -> Vec<[f64; 2]> {
        let named = parameters
            .iter()
            .filter(|parameter| parameter["name"].as_str().unwrap().starts_with(name));
        named
            .map(|parameter| [number(&parameter["value"]), number(&parameter["deviation"])])
            .collect()
    };
    // The simulated joints rub with that.
    let real = [0.02, 0.02, 0.02, 0.002, 0.002];
    let coulomb = of("Coulomb");
    assert_eq!(coulomb.len(), real.len());
    for ([value, deviation], real) in coulomb.into_iter().zip(real) {
        assert!(
            (value - real).abs() < 4.0 * deviation,
            "{value} +- {deviation}, {real}"
        );
        assert!(deviation < 0.002, "{deviation}");
    }
    // Stiffness of 300 N m/rad and ticks of 2 ms: half a tick is 0.3 N m s/rad.
    let readings = of("rate in the told torque");
    assert_eq!(readings.len(), 3);
    for [value, deviation] in readings {
        assert!(
            (10.0 * deviation..0.3).contains(&value.abs()),
            "{value} +- {deviation}"
        );
    }
    assert_eq!(of("viscous friction of motor").len(), 0);
    let blind = found["directions"]["blind"].to_string();
    assert!(
        blind.contains("viscous friction of motor 3: the place in the tick"),
        "{blind}"
    );
    // Without them nothing fits: the friction would drive.
    let bare = identified(&["--json", "--hold", "readings"]);
    let residual = |found: &Value| number(&found["residual_nm"][1]);
    assert!(residual(&found) < 0.3 * residual(&bare), "{found}");
}

#[test]
fn bad_telemetry_is_refused_with_file_line_and_column() {
    let folder = TempDir::new().unwrap();
    let thesis = repository("scenes/thesis.toml");
    let run = trirrr(&folder, &["run", "--fast", &thesis, "--out", "out"]);
    assert!(run.status.success());
    let good = fs::read_to_string(folder.path().join("out/ticks.csv")).unwrap();
    let lines: Vec<&str> = good.lines().collect();
    let spoilt = |line: usize, cell: usize, by: &str| {
        let mut lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        let mut cells: Vec<&str> = lines[line].split(',').collect();
        cells[cell] = by;
        lines[line] = cells.join(",");
        lines.join("\n")
    };
    let place = |name: &str| {
        lines[0]
            .split(',')
            .position(|column| column == name)
            .unwrap()
    };
    let cases = [
        (good.replace("tau1", "t1"), "bad.csv:1: tau1: missing"),
        (spoilt(7, place("tau2"), "nan"), "bad.csv:8: tau2: \"nan\""),
        (spoilt(7, place("th1_3"), ""), "bad.csv:8: th1_3: empty"),
        (
            spoilt(7, 0, "0.01"),
            "bad.csv:8: t: 0.01 s does not come after",
        ),
        (
            spoilt(7, place("th1_1"), "1.5"),
            "bad.csv:8: the scene's machine has no pose near",
        ),
        (lines[..30].join("\n"), "at least 50 samples"),
        (
            good.replace(',', ";"),
            "bad.csv:1: the columns are separated by semicolons",
        ),
    ];
    // A flat machine shows nothing of first moments of proximal links: the motion says nothing of what it does not see.
    let asked = [
        "identify",
        &thesis,
        "out/ticks.csv",
        "--free",
        "links",
        "--out",
        "seen",
        "--json",
    ];
    let found = json(&trirrr(&folder, &asked));
    let parameters = found["parameters"].as_array().unwrap();
    let unseen = |it: &&Value| it["seen"].as_f64().unwrap() < 0.005;
    assert!(
        parameters.iter().filter(unseen).count() >= 3,
        "{parameters:?}"
    );
    for parameter in parameters {
        assert_eq!(
            parameter["deviation"].is_null(),
            unseen(&parameter),
            "{parameter}"
        );
    }
    let times = |factor: f64| {
        let torques = ["tau1", "tau2", "tau3"].map(place);
        let scaled = |line: &&str| {
            let cells =
                line.split(',')
                    .enumerate()
                    .map(|(cell, text)| match torques.contains(&cell) {
                        true => format!("{}", factor * text.parse::<f64>().unwrap()),
                        false => text.into(),
                    });
            cells.collect::<Vec<_>>().join(",")
        };
        let rows: Vec<String> = lines[1..].iter().map(scaled).collect();
        format!("{}\n{}", lines[0], rows.join("\n"))
    };
    // N mm, before a gear of 50, and the other sign.
    let units = [
        (times(1000.0), "divide torques in N mm by 1000"),
        (times(0.02), "of motors in front of a gear"),
        (times(-1.0), "turn their sign"),
    ];
    for (text, word) in cases.into_iter().chain(units) {
        fs::write(folder.path().join("bad.csv"), text).unwrap();
        let said = refused(&trirrr(
            &folder,
            &["identify", &thesis, "bad.csv", "--out", "found"],
        ));
        assert!(said.contains(word), "{word}: {said}");
        assert!(!folder.path().join("found").exists());
    }
}
