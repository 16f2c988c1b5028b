//! Figures, pictures and the tables of the documents, against what the program writes.

use crate::common::trirrr;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;
use trirrr_client::drive_records::DriveRecord;
use trirrr_plant::table::COLUMNS;
use trirrr_scene::record::tick_columns;

fn repository(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

fn scene(name: &str) -> String {
    let file = repository(&format!("scenes/{name}.toml"));
    file.display().to_string()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Columns in the first cells of the table `name` of `docs/tables.md`.
fn documented(name: &str) -> Vec<String> {
    let text = fs::read_to_string(repository("docs/tables.md")).unwrap();
    let (_, table) = text
        .split_once(&format!("<!-- columns: {name} -->"))
        .unwrap();
    let (table, _) = table.split_once("<!-- columns -->").unwrap();
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.map(|row| row.split('|').nth(1).unwrap());
    let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    names.map(str::to_owned).collect()
}

#[test]
fn every_column_is_documented() {
    let ticks: Vec<&str> = tick_columns(true).collect();
    assert_eq!(documented("ticks"), ticks);
    assert_eq!(documented("plant"), COLUMNS);
    let drives: Vec<&str> = DriveRecord::COLUMNS.split(',').collect();
    assert_eq!(documented("drives"), drives);
}

/// `TRIRRR_BLESS=1 cargo test -p trirrr-host-sim --test commands figures` writes them.
#[test]
fn figures_in_the_documents_are_those_of_the_program() {
    let folder = TempDir::new().unwrap();
    let thesis = scene("thesis");
    let run = trirrr(&folder, &["run", "--fast", &thesis]);
    assert!(run.status.success(), "{}", stderr(&run));
    let design = ["design", &scene("vertical"), "--cells", "16"];
    let design = trirrr(&folder, &design);
    assert!(design.status.success(), "{}", stderr(&design));
    let out = folder.path().join("out");
    for (figure, image) in [
        ("thesis/machine.svg", "thesis-machine.svg"),
        ("thesis/torque.svg", "thesis-torques.svg"),
        ("vertical-design/geometry.svg", "geometry.svg"),
    ] {
        let drawn = fs::read_to_string(out.join(figure)).unwrap();
        let image = repository("docs/images").join(image);
        if std::env::var_os("TRIRRR_BLESS").is_some() {
            fs::write(&image, &drawn).unwrap();
        }
        assert_eq!(fs::read_to_string(&image).unwrap(), drawn, "{figure}");
    }
    let animation = fs::read_to_string(out.join("thesis/animation.html")).unwrap();
    assert!(animation.len() < 100_000 && animation.contains("\"torque\":true"));
    assert!(!animation.contains("src=") && !animation.contains("http"));
}

#[test]
fn each_figure_has_a_picture_where_it_is_asked_for() {
    let folder = TempDir::new().unwrap();
    let linkage = repository("linkages/four-bar.toml").display().to_string();
    let arguments = ["linkage", &linkage, "--steps", "24", "--out", "o"];
    let drawn = trirrr(&folder, &[&arguments[..], &["--png"]].concat());
    assert!(drawn.status.success(), "{}", stderr(&drawn));
    let written = |kind: &str| -> Vec<String> {
        let files = fs::read_dir(folder.path().join("o")).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.ends_with(kind)).collect();
        names.sort();
        names
    };
    let figures = written(".svg");
    assert!(figures.len() > 2);
    let expected: Vec<String> = figures
        .iter()
        .map(|name| name.replace(".svg", ".png"))
        .collect();
    assert_eq!(written(".png"), expected);
    for picture in &expected {
        let bytes = fs::read(folder.path().join("o").join(picture)).unwrap();
        assert!(
            bytes.starts_with(b"\x89PNG") && bytes.len() > 5_000,
            "{picture}"
        );
    }
    let result: Value =
        serde_json::from_slice(&fs::read(folder.path().join("o/result.json")).unwrap()).unwrap();
    let files = result["files"].as_array().unwrap();
    assert!(
        expected
            .iter()
            .all(|name| files.iter().any(|file| file == name))
    );
    // The pictures of an earlier command go with its results.
    assert!(trirrr(&folder, &arguments).status.success());
    assert!(written(".png").is_empty() && written(".svg") == figures);
}

#[test]
fn a_job_that_is_refused_is_drawn_and_the_results_before_it_stay() {
    let folder = TempDir::new().unwrap();
    let thesis = scene("thesis");
    let tight = ["--set", "limits.torque_nm=0.02"];
    assert!(
        trirrr(&folder, &["run", "--fast", &thesis])
            .status
            .success()
    );
    let ticks = folder.path().join("out/thesis/ticks.csv");
    let before = fs::read(&ticks).unwrap();
    let refused = trirrr(&folder, &[&["run", "--fast", &thesis][..], &tight].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(fs::read(&ticks).unwrap(), before);
    let check =
        |arguments: &[&str]| trirrr(&folder, &[&["check", &thesis][..], arguments].concat());
    let drawn = check(&[&tight[..], &["--figure", "why.svg"]].concat());
    assert_eq!(drawn.status.code(), Some(2));
    assert!(
        stderr(&drawn).contains("torque of motor"),
        "{}",
        stderr(&drawn)
    );
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let curves = read("why.svg");
    assert!(curves.contains("refused") && curves.contains("limit \u{b1}0.02"));
    // The pale crimson of a breach.
    assert!(curves.contains("#F5D6DE"), "no breach");
    assert!(read("why-machine.svg").contains("limit broken"));
    // A job that is good has the same figure without a breach.
    let drawn = check(&["--figure", "good.svg"]);
    assert!(drawn.status.success(), "{}", stderr(&drawn));
    assert!(!read("good.svg").contains("#F5D6DE") && !read("good.svg").contains("refused"));
    // Where the machine cannot follow, the curves end.
    let far = ["--set", "job.move[1].to.x_m=0.9", "--figure", "far.svg"];
    let drawn = check(&far);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(
        read("far.svg").contains("refused: unreachable"),
        "{}",
        stderr(&drawn)
    );
    // A scene that is wrong in itself has nothing to draw.
    let drawn = check(&["--set", "tick_rate_hz=-1", "--figure", "none.svg"]);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(!folder.path().join("none.svg").exists());
}

#[test]
fn a_path_of_a_scene_that_is_refused_is_drawn_with_the_place() {
    let folder = TempDir::new().unwrap();
    let arguments = [
        "check",
        &scene("engraving"),
        "--set",
        "limits.parallel_distance_min=0.9",
        "--figure",
        "path.svg",
    ];
    let drawn = trirrr(&folder, &arguments);
    assert_eq!(drawn.status.code(), Some(2), "{}", stderr(&drawn));
    let figure = fs::read_to_string(folder.path().join("path.svg"));
    assert!(figure.unwrap().contains("here the path is refused"));
}
