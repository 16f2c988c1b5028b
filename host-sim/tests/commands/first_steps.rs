//! First steps far from the repository: the scenes that are built in.

use crate::common::trirrr;
use std::fs;
use std::process::Output;
use tempfile::TempDir;

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_default_scene_runs_in_any_folder() {
    let folder = TempDir::new().unwrap();
    for command in [&["run", "--fast"][..], &["check"]] {
        let output = trirrr(&folder, command);
        // `check` has no default.
        let is_check = command == ["check"];
        assert_eq!(
            output.status.code(),
            Some(if is_check { 2 } else { 0 }),
            "{}",
            error(&output)
        );
    }
    assert!(folder.path().join("out/thesis/ticks.csv").exists());
    let output = trirrr(
        &folder,
        &["run", "--fast", "--set", "limits.rate_rad_s=0.01"],
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("built in"), "{}", error(&output));
    // Any other file has to be there.
    assert_eq!(
        trirrr(&folder, &["run", "scenes/vertical.toml"])
            .status
            .code(),
        Some(2)
    );
}

#[test]
fn a_first_scene_is_written_once_and_is_good() {
    let folder = TempDir::new().unwrap();
    for (file, from) in [
        ("a.toml", "thesis"),
        ("b.toml", "vertical"),
        ("c.toml", "pick-stepper"),
        ("d.toml", "engraving"),
    ] {
        let output = trirrr(&folder, &["init", file, "--from", from]);
        assert!(output.status.success(), "{}", error(&output));
        assert!(trirrr(&folder, &["check", file]).status.success(), "{from}");
    }
    let output = trirrr(&folder, &["init"]);
    assert!(output.status.success());
    fs::write(folder.path().join("machine.toml"), "mine").unwrap();
    let output = trirrr(&folder, &["init"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("machine.toml: is there already"));
    assert_eq!(
        fs::read_to_string(folder.path().join("machine.toml")).unwrap(),
        "mine"
    );
    assert_eq!(
        trirrr(&folder, &["init", "e.toml", "--from", "none"])
            .status
            .code(),
        Some(2)
    );
    assert_eq!(
        trirrr(&folder, &["init", "no/e.toml"]).status.code(),
        Some(1)
    );
}
