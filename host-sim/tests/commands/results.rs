//! Results of an earlier command in the same folder: none is lost by a refusal, none stands beside those
//! of a command that has begun.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

fn repository(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    fs::read_to_string(path).unwrap()
}

/// Writes `text` as `name` into `folder`.
fn file(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path
}

/// Runs `trirrr COMMAND FILE`, with results in the folder `out`. Returns the exit code.
fn trirrr(folder: &TempDir, arguments: &[&str]) -> i32 {
    let output = Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(arguments)
        .args(["--out", "out"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    output.status.code().unwrap()
}

/// Every file of the folder `out`, by name.
fn results(folder: &TempDir) -> Vec<(String, String)> {
    let files = fs::read_dir(folder.path().join("out")).unwrap();
    let read = |file: fs::DirEntry| {
        let name = file.file_name().into_string().unwrap();
        (name, fs::read_to_string(file.path()).unwrap())
    };
    let mut all: Vec<_> = files.map(|file| read(file.unwrap())).collect();
    all.sort();
    all
}

fn status(folder: &TempDir) -> serde_json::Value {
    let text = fs::read_to_string(folder.path().join("out/result.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_refused_command_loses_nothing() {
    let folder = TempDir::new().unwrap();
    let thesis = repository("scenes/thesis.toml");
    file(&folder, "scene.toml", &thesis);
    file(
        &folder,
        "bad.toml",
        &thesis.replace("mass_kg = 0.5", "mass_kg = -0.5"),
    );
    file(&folder, "note.txt", "of the user");
    assert_eq!(trirrr(&folder, &["run", "scene.toml", "--fast"]), 0);
    fs::copy(
        folder.path().join("note.txt"),
        folder.path().join("out/note.txt"),
    )
    .unwrap();
    assert_eq!(status(&folder)["status"], "complete");
    let before = results(&folder);
    assert!(before.len() > 5);
    // Refused: the scene, the number type, the linkage; and no board at the address.
    for (arguments, code) in [
        (&["run", "bad.toml", "--fast"][..], 2),
        (&["run", "scene.toml", "--scalar", "f16"], 2),
        (&["linkage", "bad.toml"], 2),
        (&["stream", "bad.toml", "--port", "tcp:127.0.0.1:9"], 2),
        (
            &[
                "stream",
                "scene.toml",
                "--port",
                "tcp:127.0.0.1:9",
                "--patience",
                "0.1",
            ],
            1,
        ),
    ] {
        assert_eq!(trirrr(&folder, arguments), code, "{arguments:?}");
        assert!(results(&folder) == before, "{arguments:?}");
    }
}

#[test]
fn a_command_that_has_begun_leaves_nothing_of_its_earlier_run() {
    let folder = TempDir::new().unwrap();
    let four_bar = repository("linkages/four-bar.toml");
    file(&folder, "good.toml", &four_bar);
    // Stops on the way, and cannot be assembled at all.
    file(
        &folder,
        "rocking.toml",
        &four_bar.replace("length_m = 0.1\n", "length_m = 0.3\n"),
    );
    file(
        &folder,
        "none.toml",
        &four_bar.replace("length_m = 0.1\n", "length_m = 30.0\n"),
    );
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/note.txt"), "of the user").unwrap();
    for (name, code, wanted, table) in [
        ("good.toml", 0, "complete", true),
        ("rocking.toml", 1, "partial", true),
        ("none.toml", 1, "partial", false),
    ] {
        assert_eq!(trirrr(&folder, &["linkage", name]), code, "{name}");
        let result = status(&folder);
        assert_eq!(result["status"], wanted, "{name}");
        assert_eq!(result["command"], "linkage");
        assert_eq!(result["reason"] != "", wanted == "partial", "{name}");
        let names: Vec<String> = results(&folder).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names.contains(&"linkage.csv".into()), table, "{names:?}");
        // Those that the result names, the result itself, and what no command wrote.
        let listed = result["files"].as_array().unwrap().len();
        assert_eq!(names.len(), listed + 2, "{names:?}");
        assert!(names.contains(&"note.txt".into()), "{names:?}");
    }
}

#[test]
fn a_refused_table_of_cases_leaves_the_earlier_results() {
    let folder = TempDir::new().unwrap();
    let cases = repository("tests/reference/extreme.csv");
    file(&folder, "cases.csv", &cases);
    file(&folder, "bad.csv", "case,x,y\n");
    assert_eq!(trirrr(&folder, &["eval", "cases.csv"]), 0);
    let read = || fs::read_to_string(folder.path().join("out")).unwrap();
    let before = read();
    assert!(before.lines().count() > 10);
    assert_eq!(trirrr(&folder, &["eval", "bad.csv"]), 2);
    assert_eq!(read(), before);
    let names = fs::read_dir(folder.path()).unwrap();
    // The cases, the bad ones, the results, and the hidden file by which the program knows them.
    assert_eq!(names.count(), 4);
}
