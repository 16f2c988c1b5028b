//! `docs/tutorial.md`, as a reader follows it.

use std::fs;
use std::path::Path;
use std::process::Output;
use std::time::Instant;
use tempfile::TempDir;

/// Commands of the tutorial that go on until a user ends them, or need another compiler.
const NOT_ALONE: [&str; 4] = ["device", "stream", "rustup", "SCENE="];

fn tutorial() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/tutorial.md");
    fs::read_to_string(file).unwrap()
}

/// Contents of the blocks of `text` in `language`, in order.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    let parts = text.split(&fence).skip(1);
    parts
        .map(|part| part.split("```").next().unwrap())
        .collect()
}

fn run(folder: &TempDir, line: &str) -> Output {
    let arguments = line.strip_prefix("cargo run --release -- ").unwrap();
    crate::common::command(folder, &[])
        .args(arguments.split(' '))
        .output()
        .unwrap()
}

#[test]
fn every_step_of_the_tutorial_does_what_it_says() {
    let text = tutorial();
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("my.toml");
    let [machine, drives] = blocks(&text, "toml")[..] else {
        panic!("a scene, and drives for it");
    };
    fs::write(&scene, machine).unwrap();
    let mut runs = 0;
    for line in blocks(&text, "sh").into_iter().flat_map(str::lines) {
        if NOT_ALONE.iter().any(|word| line.contains(word)) {
            continue;
        }
        let begin = Instant::now();
        let output = run(&folder, line);
        // For the table of the page, with `--release -- --nocapture`.
        println!("{:.1} s  {line}", begin.elapsed().as_secs_f64());
        let error = String::from_utf8_lossy(&output.stderr);
        // One command is meant to be refused, and the page says with which words.
        if line.contains("torque_nm=0.5") {
            assert_eq!(output.status.code(), Some(2), "{line}: {error}");
            assert!(error.contains("no duration helps"), "{error}");
            continue;
        }
        assert!(output.status.success(), "{line}: {error}");
        if line.contains("-- run ") {
            runs += 1;
            // The second run has drives and a plant.
            let plant = folder.path().join("out/my-machine/plant.csv");
            assert_eq!(plant.exists(), runs == 2);
            let with_drives = machine.replace("[limits]", &format!("{drives}\n[limits]"));
            fs::write(&scene, with_drives).unwrap();
        }
    }
    assert_eq!(runs, 2);
}

#[test]
fn the_mode_that_the_tutorial_names_has_the_least_torque() {
    let text = tutorial();
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("my.toml"), blocks(&text, "toml")[0]).unwrap();
    let output = run(&folder, "cargo run --release -- design my.toml --json");
    let study: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let modes = study["modes"].as_array().unwrap();
    let torque = |mode: &serde_json::Value| mode["peak_torque_nm"].as_f64();
    let possible = modes.iter().filter_map(|mode| Some((mode, torque(mode)?)));
    let least = possible.min_by(|one, other| one.1.total_cmp(&other.1));
    assert_eq!(least.unwrap().0["elbows"], serde_json::json!([1, -1, 1]));
}
