//! `trirrr run` of a scene with a plant: what it writes, what it says.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use trirrr_plant::table::COLUMNS;

/// The text of a shipped scene.
fn text(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name)
        .with_extension("toml");
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// `text` with each first occurrence replaced.
fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no {from:?}");
        text.replacen(from, to, 1)
    })
}

fn run(scene: &str, folder: &Path) -> Output {
    let file = folder.join("scene.toml");
    fs::write(&file, scene).unwrap();
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .arg("run")
        .arg(&file)
        .args(["--fast", "--out"])
        .arg(folder)
        .output()
        .unwrap()
}

#[test]
fn the_reference_scene_writes_its_table_and_reports() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(&text("plant-reference"), folder.path());
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}");
    for part in [
        "times faster than real time",
        "method",
        "deviation tool: peak",
        "joint 3: peak",
        "torque, N m",
        "energy",
    ] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    let mut table = csv::Reader::from_path(folder.path().join("plant.csv")).unwrap();
    let header: Vec<String> = table.headers().unwrap().iter().map(Into::into).collect();
    assert_eq!(header, COLUMNS);
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 1201);
    assert_eq!((&rows[0][0], &rows[1200][0]), ("0.0", "1.2"));
    for row in &rows {
        assert!(
            row.iter()
                .all(|field| field.parse::<f64>().unwrap().is_finite())
        );
    }
    for figure in ["tracking.svg", "current.svg", "plant_torque.svg"] {
        let svg = fs::read_to_string(folder.path().join(figure)).unwrap();
        assert!(svg.contains("polyline"), "{figure}");
    }
    // Beside the table of the ticks.
    let ticks = fs::read_to_string(folder.path().join("ticks.csv")).unwrap();
    assert_eq!(ticks.lines().count(), 1 + 1001);
}

/// The ticks may be computed in any type that a board has; the drives then compute in f32.
#[test]
fn ticks_of_exact_number_types_can_be_followed() {
    for scalar in ["f64", "f32", "fixed"] {
        let folder = tempfile::tempdir().unwrap();
        let scene = edited(
            &text("plant-thesis"),
            &[("number = \"f64\"", &format!("number = \"{scalar}\""))],
        );
        let output = run(&scene, folder.path());
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{scalar}: {said}{told}");
        assert!(
            said.contains("times faster than real time"),
            "{scalar}: {said}"
        );
    }
}

#[test]
fn gains_that_cannot_be_followed_are_refused_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let edits = [
        ("tick_rate_hz = 10000", "tick_rate_hz = 100"),
        ("rate_hz = 10000", "rate_hz = 100"),
    ];
    let output = run(&edited(&text("plant-reference-zoh"), &edits), folder.path());
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("controller.kp_nm_rad"), "{said}");
    assert!(said.contains("unstable at the start"), "{said}");
}

#[test]
fn a_run_that_the_plant_ends_says_why_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let edits = [("settle_s", "following_error_rad = 1e-5\nsettle_s")];
    let output = run(&edited(&text("plant-reference"), &edits), folder.path());
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("the following error of joint"), "{said}");
    // What came before is written.
    let table = fs::read_to_string(folder.path().join("plant.csv")).unwrap();
    assert!((2..10).contains(&table.lines().count()), "{table}");
}

/// Rows of a table: the columns named, where a cell is not empty.
fn columns<const N: usize>(folder: &Path, table: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let text = fs::read_to_string(folder.join(table)).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let places = names.map(|name| header.iter().position(|each| *each == name).expect(name));
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), header.len(), "{line}");
        places.map(|place| cells[place].parse().unwrap_or(f64::NAN))
    });
    rows.collect()
}

const PUSH: &str =
    "[plant.push]\nat_s = 0.4\nduration_s = 0.3\nforce_n = [6.0, 0.0]\n\n[controller]\nrate_hz";

/// Drives on a bus are heard by the service; what they measure is where the plant is.
#[test]
fn measured_poses_are_those_of_the_plant() {
    let folder = tempfile::tempdir().unwrap();
    // Felt, but not beyond the threshold.
    let edits = [
        ("[controller]\nrate_hz", PUSH),
        ("force_n = 3.0", "force_n = 30.0"),
    ];
    let output = run(&edited(&text("plant-odrive"), &edits), folder.path());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}");
    assert!(said.contains("as estimated"), "{said}");
    let truth = columns(folder.path(), "plant.csv", ["t", "x", "y", "alpha"]);
    let measured = columns(
        folder.path(),
        "drives.csv",
        ["t", "x", "y", "ext_fx", "ext_fy"],
    );
    assert_eq!(measured.len(), 500);
    for [t, x, y, fx, fy] in measured {
        // A reading is up to two ticks old; the platform moves at up to 0.15 m/s.
        let near = truth
            .iter()
            .filter(|row| (0.0..4.1e-3).contains(&(t - row[0])));
        let off = near
            .map(|row| (row[1] - x).hypot(row[2] - y))
            .fold(f64::MAX, f64::min);
        assert!(off < 1e-4, "t = {t}: {off:e} m");
        // The force of the push, and otherwise what friction of the passive joints leaves.
        let expected = match t {
            t if (0.46..0.7).contains(&t) => 6.0,
            t if !(0.4..0.76).contains(&t) => 0.0,
            _ => continue,
        };
        assert!((fx - expected).hypot(fy) < 1.0, "t = {t}: {fx}, {fy} N");
    }
    let svg = fs::read_to_string(folder.path().join("drives.svg")).unwrap();
    assert!(svg.contains("polyline"));
}

/// A push of 6 N against a threshold of 3 N: a fault soon after, and a machine that comes to rest as its scene says.
#[test]
fn a_push_is_a_contact() {
    let back = "retreat_s = 0.1\n";
    for (category, retreat, rests) in [
        ("", "", 0.1),
        ("[faults]\ncontact = 0\n\n", "", 0.0),
        // The stop, and as much back, by 0.1 s of the path at half of normal speed.
        ("", back, 0.34),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let limits = format!("{category}[limits]\n");
        let edits = [
            ("[controller]\nrate_hz", PUSH),
            ("[limits]\n", limits.as_str()),
            (back, retreat),
        ];
        let output = run(&edited(&text("plant-odrive"), &edits), folder.path());
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("contact: a force of"), "{said}");
        let ticks = columns(folder.path(), "ticks.csv", ["t", "vx"]);
        let [end, _] = ticks[ticks.len() - 1];
        assert!(
            (0.4 + rests..0.44 + rests).contains(&end),
            "{category}{retreat}: {end} s"
        );
        let least = ticks.iter().fold(0.0, |least: f64, [_, vx]| least.min(*vx));
        // Half of the speed at the push, 0.1 m/s.
        match retreat.is_empty() {
            true => assert_eq!(least, 0.0),
            false => assert!((-0.053..-0.045).contains(&least), "{least} m/s"),
        }
    }
}
