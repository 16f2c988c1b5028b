//! `trirrr design --vary`: the machine that does a job best, against loops over `trirrr run`.

use crate::common::{json, keeps_schema};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

fn scene(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name);
    file.display().to_string()
}

fn trirrr(folder: &TempDir, threads: &str, arguments: &[&str]) -> Output {
    crate::common::command(folder, arguments)
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .unwrap()
}

fn refusal(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn study(folder: &TempDir, arguments: &[&str]) -> Value {
    let all = [&["design", "--json", "--cells", "32"], arguments].concat();
    json(&trirrr(folder, "2", &all))
}

/// Largest peak torque that `trirrr run` plays; none: the scene is refused.
fn run_peak(folder: &TempDir, scene: &str, set: &[String]) -> Option<f64> {
    let mut arguments = vec!["run", "--fast", "--json", "--scalar", "f64", scene];
    for each in set {
        arguments.extend(["--set", each]);
    }
    let output = trirrr(folder, "2", &arguments);
    if output.status.code() == Some(2) {
        return None;
    }
    let run = json(&output);
    let peak = |motor: usize| {
        let value = &run["motors"][motor]["peak_torque_nm"]["value"];
        value.as_f64().unwrap().abs()
    };
    Some((0..3).map(peak).fold(0.0, f64::max))
}

#[test]
fn the_working_mode_is_found_and_halves_the_peak_torque() {
    let folder = TempDir::new().unwrap();
    let lift = scene("design/lift.toml");
    let found = study(&folder, &[&lift, "--vary", "mode", "--for", "torque"]);
    keeps_schema("design-vary", std::slice::from_ref(&found));
    // By hand: each mode played as a scene of its own.
    let mut peaks = Vec::new();
    for mode in 0..8 {
        let sign = |leg: usize| if mode >> leg & 1 == 0 { 1 } else { -1 };
        let set: Vec<String> = (0..3)
            .map(|leg| format!("machine.leg[{}].elbow={}", leg + 1, sign(leg)))
            .collect();
        peaks.extend(run_peak(&folder, &lift, &set).map(|peak| (peak, set)));
    }
    peaks.sort_by(|one, other| one.0.total_cmp(&other.0));
    let own = run_peak(&folder, &lift, &[]).unwrap();
    let (least, set) = &peaks[0];
    assert!(2.0 * least <= own, "{least} {own}");
    let best = &found["result"]["best"];
    assert_eq!(best["set"], serde_json::json!(set));
    assert!((best["found"][0].as_f64().unwrap() / least - 1.0).abs() < 1e-9);
    assert!((found["own"]["found"][0].as_f64().unwrap() / own - 1.0).abs() < 1e-9);
    // As many modes do the job as the loop found.
    assert_eq!(found["result"]["feasible"], peaks.len());
    // The file that is written runs, and needs as much.
    let file = folder.path().join("out/lift-study/best.toml");
    let played = run_peak(&folder, &file.display().to_string(), &[]).unwrap();
    assert!((played / least - 1.0).abs() < 1e-9);
    let text = fs::read_to_string(&file).unwrap();
    let own = fs::read_to_string(&lift).unwrap();
    let changed = own
        .lines()
        .zip(text.lines())
        .filter(|(one, two)| one != two);
    assert!(changed.clone().count() > 0 && changed.clone().all(|(one, _)| one.contains("elbow")));
    for name in [
        "study.html",
        "evaluations.csv",
        "study.json",
        "progress.svg",
    ] {
        assert!(
            folder.path().join("out/lift-study").join(name).is_file(),
            "{name}"
        );
    }
}

const LENGTHS: [&str; 4] = [
    "--vary",
    "machine.leg[*].distal_m=0.12..0.16",
    "--vary",
    "machine.leg[1].proximal_m,machine.leg[2].proximal_m=0.1..0.13",
];

#[test]
fn the_same_seed_gives_the_same_files_on_any_number_of_threads() {
    let lift = scene("design/lift.toml");
    let text = |threads: &str, seed: &str| {
        let folder = TempDir::new().unwrap();
        let rest = [
            "--vary",
            "mode",
            "--for",
            "torque",
            "--evaluations",
            "60",
            "--cells",
            "16",
        ];
        let all = [&["design", &lift, "--seed", seed][..], &LENGTHS, &rest].concat();
        let output = trirrr(&folder, threads, &all);
        assert!(output.status.success(), "{output:?}");
        ["study.json", "evaluations.csv", "best.toml"].map(|name| {
            fs::read_to_string(folder.path().join("out/lift-study").join(name)).unwrap()
        })
    };
    let one = text("1", "5");
    assert_eq!(one, text("2", "5"));
    assert_ne!(one[1], text("2", "6")[1]);
}

fn shard(folder: &TempDir, part: &str, more: &[&str]) -> PathBuf {
    let lift = scene("design/lift.toml");
    let out = folder.path().join(part.replace('/', "-"));
    let name = out.display().to_string();
    let rest = [
        "--for",
        "torque,workspace",
        "--evaluations",
        "90",
        "--cells",
        "64",
    ];
    let vary = [
        "--vary",
        "mode=+++,---,-++",
        "--shard",
        part,
        "--out",
        &name,
    ];
    let all = [&["design", &lift][..], &LENGTHS, &rest, &vary, more].concat();
    let output = trirrr(folder, "2", &all);
    // A part may have no candidate that does the job.
    assert_ne!(output.status.code(), Some(2), "{output:?}");
    out.join("study.json")
}

/// A candidate is on the merged front if no other candidate of all parts beats it: looked at pair by pair.
#[test]
fn merged_parts_follow_the_rules_of_one_study_in_whatever_order() {
    let folder = TempDir::new().unwrap();
    let files = ["1/3", "2/3", "3/3"].map(|part| shard(&folder, part, &[]));
    let lift = scene("design/lift.toml");
    let merged = |order: [usize; 3]| {
        let names = order.map(|index| files[index].display().to_string());
        let [one, two, three] = names.each_ref().map(String::as_str);
        study(&folder, &[&lift, "--merge", one, two, three])
    };
    let whole = merged([0, 1, 2]);
    assert_eq!(whole, merged([2, 0, 1]));
    let parts: Vec<Value> = files
        .iter()
        .map(|file| serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap())
        .collect();
    let counts = parts
        .iter()
        .map(|part| part["candidates"].as_array().unwrap().len());
    let candidates = whole["candidates"].as_array().unwrap();
    assert_eq!(candidates.len(), counts.sum::<usize>());
    let costs: Vec<Option<[f64; 2]>> = candidates
        .iter()
        .map(|each| {
            let found = each["found"].as_array()?;
            // Less torque and more workspace.
            Some([found[0].as_f64()?, -found[1].as_f64()?])
        })
        .collect();
    let mut expected = Vec::new();
    for (index, own) in costs.iter().enumerate() {
        let Some(own) = own else { continue };
        let beats = |(place, other): (usize, &Option<[f64; 2]>)| {
            let Some(other) = other else { return false };
            let is_same = other == own;
            other[0] <= own[0] && other[1] <= own[1] && (!is_same || place < index)
        };
        let others = costs
            .iter()
            .enumerate()
            .filter(|(place, _)| *place != index);
        if !others.into_iter().any(beats) {
            expected.push(index + 1);
        }
    }
    let mut front: Vec<usize> = whole["result"]["front"]
        .as_array()
        .unwrap()
        .iter()
        .map(|each| each["candidate"].as_u64().unwrap() as usize)
        .collect();
    front.sort_unstable();
    assert!(front.len() > 1, "{front:?}");
    assert_eq!(front, expected);
    let knee = whole["result"]["best"]["candidate"].as_u64().unwrap() as usize;
    assert!(front.contains(&knee) && whole["result"]["best_is"] == "knee");
    let out = folder.path().join("out/lift-study");
    let rows = fs::read_to_string(out.join("front.csv")).unwrap();
    assert_eq!(rows.lines().count(), front.len() + 1);
    assert!(out.join("front.svg").is_file());

    // What does not belong together is named.
    let name = |index: usize| files[index].display().to_string();
    let other = shard(&folder, "2/3", &["--seed", "9"]);
    let other = other.display().to_string();
    let first = name(0);
    for (given, parts) in [
        (vec![&name(0)[..], &name(2)], ["missing", "2"]),
        (
            vec![&name(0), &name(0), &name(2)],
            ["part 1 of 3", "stands in"],
        ),
        (
            vec![&first, &other, &name(2)],
            ["another study", "seed = 9"],
        ),
        (vec!["none.json"], ["none.json", "cannot be read"]),
        (vec![&lift[..]], ["lift.toml", "no study.json"]),
    ] {
        let all = [&["design", &lift, "--merge"][..], &given].concat();
        let said = refusal(&trirrr(&folder, "2", &all));
        for part in parts {
            assert!(said.contains(part), "{part:?} of {given:?} in {said}");
        }
    }
    let thesis = scene("thesis.toml");
    let all = ["design", &thesis, "--merge", &name(0), &name(2)];
    assert!(refusal(&trirrr(&folder, "2", &all)).contains("missing"));
}

#[test]
fn wrong_bounds_are_refused_with_key_and_reason() {
    let folder = TempDir::new().unwrap();
    let lift = scene("design/lift.toml");
    for (vary, parts) in [
        (
            "machine.leg[1].distal_m=0.2..0.1",
            ["machine.leg[1].distal_m", "less than HIGH"],
        ),
        (
            "machine.leg[1].distal_m=0.2..0.2",
            ["machine.leg[1].distal_m", "less than HIGH"],
        ),
        (
            "machine.leg[1].distal_m=a..0.2",
            ["machine.leg[1].distal_m: LOW = `a`", "number"],
        ),
        (
            "machine.leg[1].distl_m=0.1..0.2",
            ["machine.leg[1].distl_m", "did you mean `distal_m`"],
        ),
        (
            "machine.leg[4].distal_m=0.1..0.2",
            ["machine.leg[4].distal_m", "3 elements"],
        ),
        (
            "machine.leg[*].distal_m=-0.1..0.2",
            ["distal_m = -0.1", "greater than 0"],
        ),
        (
            "platfrm.mass_kg=0.1..0.2",
            ["platfrm", "did you mean `platform`"],
        ),
        ("machine.leg[1].elbow=-1..1", ["elbow", "1 or -1"]),
        ("service.telemetry_ticks=1..9", ["telemetry_ticks", "whole"]),
        ("name=1..2", ["name", "string"]),
        ("machine.leg[1].base_m[3]=0..1", ["base_m[3]", "2 elements"]),
        ("mode=+-", ["mode", "+-"]),
    ] {
        let all = [
            "design",
            &lift,
            "--vary",
            vary,
            "--for",
            "torque",
            "--evaluations",
            "10",
        ];
        let said = refusal(&trirrr(&folder, "2", &all));
        for part in parts {
            assert!(said.contains(part), "{part:?} of {vary} in {said}");
        }
    }
    for (arguments, part) in [
        (&["--vary", "mode"][..], "--for"),
        (&["--for", "torque"], "--vary"),
        (&["--vary", "mode", "--for", "speed"], "rectangle"),
        (
            &["--vary", "mode", "--for", "torque,rms,time"],
            "one quantity or two",
        ),
        (
            &["--vary", "mode", "--for", "torque,torque"],
            "stands twice",
        ),
        (
            &["--vary", "mode", "--vary", "mode", "--for", "torque"],
            "stands twice",
        ),
        (
            &["--vary", "mode", "--for", "torque", "--shard", "3/2"],
            "I/N",
        ),
        (
            &["--vary", "mode", "--for", "torque", "--evaluations", "0"],
            "0",
        ),
    ] {
        let said = refusal(&trirrr(
            &folder,
            "2",
            &[&["design", &lift], arguments].concat(),
        ));
        assert!(said.contains(part), "{part:?} of {arguments:?} in {said}");
    }
    // Moves without limits have no least time.
    let bare = fs::read_to_string(&lift).unwrap();
    let (before, rest) = bare.split_once("rate_rad_s").unwrap();
    let (_, after) = rest.split_once("serial_distance_min").unwrap();
    let file = folder.path().join("bare.toml");
    fs::write(&file, format!("{before}serial_distance_min{after}")).unwrap();
    let all = ["design", "bare.toml", "--vary", "mode", "--for", "time"];
    assert!(refusal(&trirrr(&folder, "2", &all)).contains("[limits]"));
    // Nothing was written.
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_study_without_a_machine_that_does_the_job_says_how_near_it_came() {
    let folder = TempDir::new().unwrap();
    let lift = scene("design/lift.toml");
    let short = "machine.leg[*].distal_m=0.01..0.02";
    let all = [
        "design",
        &lift,
        "--vary",
        short,
        "--for",
        "workspace",
        "--evaluations",
        "12",
        "--cells",
        "16",
    ];
    let output = trirrr(&folder, "2", &all);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("none of 12") && said.contains("unreachable"),
        "{said}"
    );
    let rows = fs::read_to_string(folder.path().join("out/lift-study/evaluations.csv")).unwrap();
    assert_eq!(rows.lines().count(), 13);
}

/// The machine of another file, and values of `--set`, are in the file of the best machine.
#[test]
fn a_machine_in_a_file_of_its_own_is_written_beside_the_scene() {
    let folder = TempDir::new().unwrap();
    let text = fs::read_to_string(scene("design/lift.toml")).unwrap();
    fs::write(folder.path().join("machine.toml"), &text).unwrap();
    let (_, job) = text.split_once("[job]").unwrap();
    let own = format!("name = \"own\"\ntick_rate_hz = 500\nmachine = \"machine.toml\"\n[job]{job}");
    fs::write(folder.path().join("own.toml"), own).unwrap();
    let arguments = [
        "own.toml",
        "--vary",
        "platform.mass_kg=0.5..0.9",
        "--for",
        "rms,time",
        "--evaluations",
        "12",
        "--set",
        "links.distal.mass_kg=0.02",
    ];
    let found = study(&folder, &arguments);
    let out = folder.path().join("out/own-study");
    let machine = fs::read_to_string(out.join("best-machine.toml")).unwrap();
    assert!(machine.contains("distal = { mass_kg = 0.02 }"), "{machine}");
    let best = out.join("best.toml").display().to_string();
    // Less mass needs less torque, and is moved faster: both objectives have one optimum, at the bound.
    assert!(machine.contains("mass_kg = 0.5\n"), "{machine}");
    assert_eq!(found["result"]["front"].as_array().unwrap().len(), 1);
    assert!(run_peak(&folder, &best, &[]).is_some());
}
