//! `trirrr run --tolerances`: what it prints and writes, and whom it refuses.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;
use trirrr_scene::Scene;

fn scene_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name)
}

fn run(scene: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .arg("run")
        .arg(scene)
        .args(["--fast", "--tolerances", "--out"])
        .arg(out)
        .output()
        .expect("trirrr starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The columns and the rows of a table; an empty field is `None`.
fn table(file: &Path) -> (Vec<String>, Vec<Vec<Option<f64>>>) {
    let table = fs::read_to_string(file).expect("a table");
    let mut lines = table.lines();
    let columns: Vec<String> = lines.next().unwrap().split(',').map(String::from).collect();
    let number = |field: &str| {
        (!field.is_empty()).then(|| {
            let value: f64 = field.parse().unwrap_or_else(|_| panic!("{field}"));
            assert!(value.is_finite());
            value
        })
    };
    let rows: Vec<Vec<Option<f64>>> = lines
        .map(|row| row.split(',').map(number).collect())
        .collect();
    assert!(rows.iter().all(|row| row.len() == columns.len()));
    (columns, rows)
}

/// The values of a column.
fn column(columns: &[String], rows: &[Vec<Option<f64>>], name: &str) -> Vec<f64> {
    let index = columns
        .iter()
        .position(|column| column == name)
        .expect(name);
    rows.iter().filter_map(|row| row[index]).collect()
}

/// The thesis machine on a slow move, with the given tables.
fn scene(folder: &Path, tables: &str) -> PathBuf {
    let thesis = fs::read_to_string(scene_file("thesis.toml")).unwrap();
    let file = folder.join("own.toml");
    fs::write(&file, format!("{thesis}\n{tables}\n")).unwrap();
    file
}

#[test]
fn the_shipped_scene_has_errors_torques_and_margins() {
    let folder = TempDir::new().unwrap();
    let output = run(&scene_file("vertical.toml"), folder.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    for part in [
        "tolerances  whole job in",
        "distal length             +- 5.000e-5 m",
        "motor angle               +- 0.0004713 rad",
        "deviation tool: at most",
        " um at t = ",
        " mrad at t = ",
        "leg 2 motor angle + 0.0004713 rad",
        "others, sum of the sizes",
        "torque at most",
        "most of its band by ",
        "margin",
        "tolerance_budget.csv",
        "torque_band.svg",
    ] {
        assert!(summary.contains(part), "{part} in\n{summary}");
    }
    for file in ["tolerances.svg", "torque_band.svg"] {
        let figure = fs::read_to_string(folder.path().join(file)).expect(file);
        assert!(figure.ends_with("</svg>\n") && figure.contains("vertical"));
    }
    let (columns, rows) = table(&folder.path().join("tolerances.csv"));
    let at = |row: &[Option<f64>], name: &str| {
        let index = columns.iter().position(|column| column == name);
        row[index.expect(name)].expect("bounded")
    };
    let (ticks, records) = table(&folder.path().join("ticks.csv"));
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!((at(first, "t"), at(last, "t_end")), (0.0, 2.5));
    for pair in rows.windows(2) {
        assert_eq!(at(&pair[0], "t_end"), at(&pair[1], "t"));
    }
    // The nominal machine is one of those that the bounds are about.
    let of_tick = |record: &[Option<f64>], name: &str| {
        record[ticks.iter().position(|column| column == name).expect(name)].unwrap()
    };
    for record in &records {
        let t = of_tick(record, "t");
        // At the end of a move the acceleration may jump: the tick belongs to one of two intervals.
        let is_held = |row: &Vec<Option<f64>>| {
            at(row, "t") <= t
                && t <= at(row, "t_end")
                && (1..=3).all(|motor| {
                    let tau = of_tick(record, &format!("tau{motor}"));
                    let rate = of_tick(record, &format!("dth1_{motor}"));
                    let bound = |name: &str| at(row, &name.replace('#', &motor.to_string()));
                    // The run is in f32.
                    bound("tau#_min") - 1e-4 < tau
                        && tau < bound("tau#_max") + 1e-4
                        && bound("dth1_#_min") - 1e-5 < rate
                        && rate < bound("dth1_#_max") + 1e-5
                })
        };
        assert!(rows.iter().any(is_held), "t = {t}");
    }
    let bounds = rows;
    for row in &bounds {
        for motor in ["1", "2", "3"] {
            let bound = |name: &str| at(row, &name.replace('#', motor));
            let size = bound("tau#_min").abs().max(bound("tau#_max").abs());
            assert_eq!(bound("margin#"), 9.0 - size);
        }
        let (dx, dy, distance) = (at(row, "dx"), at(row, "dy"), at(row, "distance"));
        assert!(dx.max(dy) <= distance * (1.0 + 1e-12) && distance <= 1.0013 * dx.hypot(dy));
    }
    let budget = fs::read_to_string(folder.path().join("tolerance_budget.csv")).unwrap();
    // 14 parameters of each leg, 7 of the platform. The 7 lengths and angles of each leg move the tool and come first.
    let rows: Vec<Vec<&str>> = budget.lines().map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 3 * 14 + 7);
    assert_eq!(
        rows[0].join(","),
        "parameter,unit,half_width,dx,dy,dalpha,along,tau1,tau2,tau3"
    );
    assert_eq!(
        rows[1][..3],
        ["leg 2 motor angle", "rad", "0.00047130528872063387"]
    );
    let field = |row: &[&str], column: usize| -> f64 { row[column].parse().expect("a number") };
    let size = |row: &[&str]| field(row, 6).abs();
    assert!(
        rows[1..22]
            .windows(2)
            .all(|pair| size(&pair[0]) >= size(&pair[1]))
    );
    assert!(rows[22..].iter().all(|row| size(row) == 0.0));
    // The shares add up to the bounds, but for what is not linear and the change within an interval.
    let sum = |column: usize| -> f64 { rows[1..].iter().map(|row| field(row, column).abs()).sum() };
    let table_of = |name: &str| column(&columns, &bounds, name);
    let distance = table_of("distance").into_iter().fold(0.0, f64::max);
    assert!(
        (0.9..=1.0).contains(&(sum(6) / distance)),
        "{} {distance}",
        sum(6)
    );
    for (motor, column) in (1..=3).zip(7..) {
        let [least, greatest] = ["min", "max"].map(|end| table_of(&format!("tau{motor}_{end}")));
        let range = least.iter().zip(&greatest).max_by(|a, b| {
            let size = |(least, greatest): &(&f64, &f64)| least.abs().max(greatest.abs());
            size(a).total_cmp(&size(b))
        });
        let (least, greatest) = range.expect("a row");
        let part = 2.0 * sum(column) / (greatest - least);
        assert!((0.7..=1.0).contains(&part), "motor {motor}: {part}");
    }
}

#[test]
fn a_scene_without_torques_has_no_torque_columns() {
    let folder = TempDir::new().unwrap();
    let plotter = scene_file("plotter.toml");
    let output = run(&plotter, folder.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    let (_, bounds) = summary.split_once("tolerances  ").expect("the part");
    assert!(
        !bounds.contains("torque") && bounds.contains("rate at most"),
        "{bounds}"
    );
    let (columns, rows) = table(&folder.path().join("tolerances.csv"));
    assert!(columns.iter().all(|column| !column.starts_with("tau")));
    let moves = Scene::read(&plotter).unwrap().job.moves.len();
    assert!(
        rows.len() >= moves * 8,
        "8 intervals for each of {moves} moves"
    );
    assert!(!folder.path().join("torque_band.svg").exists());
    let manual = include_str!("../../../docs/tolerances.md");
    let (_, shown) = manual.split_once("```text\n").expect("an example");
    let (shown, _) = shown.split_once("```").expect("an end");
    assert!(
        summary.contains(shown),
        "the manual shows\n{shown}but\n{summary}"
    );
    // Half a microstep is added to the backlash.
    assert!(
        summary.contains("motor angle               +- 0.001096 rad"),
        "{summary}"
    );
}

#[test]
fn exact_machines_and_hopeless_ones_are_told_as_such() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let output = run(&scene(folder.path(), "[tolerances]"), &out);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    assert!(summary.contains("deviation tool: at most"), "{summary}");
    assert!(
        !summary.contains("budget  ") && !summary.contains("+-"),
        "{summary}"
    );

    let output = run(&scene(folder.path(), "[tolerances]\njoint_m = 0.015"), &out);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    assert!(
        summary.contains("unbounded no bound of the error is proven at t = "),
        "{summary}"
    );
    assert!(!summary.contains("tool off"), "{summary}");
    let (columns, rows) = table(&out.join("tolerances.csv"));
    let distance = columns
        .iter()
        .position(|column| column == "distance")
        .unwrap();
    assert!(rows.iter().all(|row| row[distance].is_none()));
    for file in ["tolerances.svg", "torque_band.svg"] {
        let figure = fs::read_to_string(out.join(file)).unwrap();
        assert!(figure.contains("no bound is proven"), "{file}");
    }
}

#[test]
fn a_scene_without_tolerances_is_refused_with_what_to_add() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let output = run(&scene_file("thesis.toml"), &out);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(
        message.contains("thesis.toml: --tolerances: the scene has no [tolerances]: add"),
        "{message}"
    );
    assert!(!out.exists(), "nothing was run");
}
