//! Files that a command reads, and files that it did not write itself, are there byte for byte afterwards.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Content of all files below a folder, by their paths in it.
type Files = BTreeMap<String, Vec<u8>>;

/// Commands that write, with results in OUT.
const COMMANDS: [&[&str]; 15] = [
    &["run", "--fast", "thesis.toml", "--out", "OUT"],
    &["run", "--fast", "plant.toml", "--png", "--out", "OUT"],
    &["run", "--fast", "redundant.toml", "--out", "OUT"],
    &["plan", "engraving.toml", "--out", "OUT"],
    &[
        "assemble",
        "thesis.toml",
        "--angles-deg=63.4,167.8,-94.2",
        "--out",
        "OUT",
    ],
    &["linkage", "four-bar.toml", "--out", "OUT"],
    &["calibrate", "thesis.toml", "thesis.csv", "--out", "OUT"],
    &["calibrate", "thesis.toml", "--propose", "4", "--out", "OUT"],
    &["identify", "plant.toml", "drives.csv", "--out", "OUT"],
    &["design", "thesis.toml", "--cells", "24", "--out", "OUT"],
    &["check", "thesis.toml", "--figure", "OUT/path.svg"],
    &["eval", "cases.csv", "--out", "OUT/drives.csv"],
    &[
        "export",
        "thesis.toml",
        "--format",
        "urdf",
        "--out",
        "OUT/machine.svg",
    ],
    &["init", "OUT/thesis.toml"],
    &["key", "OUT/plan.csv"],
];

/// Commands of [`COMMANDS`] that take a second at most.
const SHORT: [usize; 13] = [0, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13, 14];

fn repository(file: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    fs::read(path).unwrap()
}

/// A folder with inputs of all commands, and in `out` strangers of no command.
fn inputs() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, from) in [
        ("thesis.toml", "scenes/thesis.toml"),
        ("plant.toml", "scenes/plant-vertical.toml"),
        ("redundant.toml", "scenes/redundant/4rrr.toml"),
        ("engraving.toml", "scenes/engraving.toml"),
        ("four-bar.toml", "linkages/four-bar.toml"),
        ("thesis.csv", "scenes/measurements/thesis.csv"),
        ("cases.csv", "tests/reference/extreme.csv"),
    ] {
        fs::write(folder.path().join(name), repository(from)).unwrap();
    }
    folder
}

fn trirrr(folder: &Path, command: &[&str], out: &str) -> Output {
    let arguments = command.iter().map(|word| word.replace("OUT", out));
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn files(folder: &Path) -> Files {
    let mut all = Files::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_symlink() {
                // Links lead to files that are looked at, or nowhere.
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(path).unwrap());
            }
        }
    }
    all
}

/// Runs a command, and checks that every file of `before` that is not its own is as it was. Returns the files afterwards.
fn check(folder: &Path, index: usize, out: &str, own: &Files, before: &Files) -> Files {
    let command = COMMANDS[index];
    let output = trirrr(folder, command, out);
    let after = files(folder);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{command:?}: {said}");
    for (name, content) in before {
        let is_hidden = name.ends_with(".trirrr.json");
        if !is_hidden && own.get(name) != Some(content) {
            assert!(
                after.get(name) == Some(content),
                "{command:?} in {out}: {name}: {said}"
            );
        }
    }
    after
}

/// Files that are new or other than before.
fn written(before: &Files, after: &Files) -> Files {
    let new = after
        .iter()
        .filter(|(name, content)| before.get(*name) != Some(content));
    new.map(|(name, content)| (name.clone(), content.clone()))
        .collect()
}

/// One command after the other in one folder, to the end and back: each pair in both orders.
fn all_in_one_folder(indices: &[usize], out: &str) {
    let folder = inputs();
    let path = folder.path();
    fs::create_dir_all(path.join(out)).unwrap();
    // The same command with other inputs replaces its earlier results.
    let mut own: BTreeMap<&str, Files> = BTreeMap::new();
    let mut before = files(path);
    for &index in indices.iter().chain(indices.iter().rev()) {
        let own = own.entry(COMMANDS[index][0]).or_default();
        let after = check(path, index, out, own, &before);
        own.extend(written(&before, &after));
        before = after;
    }
}

#[test]
fn short_commands_in_one_folder_lose_nothing_of_each_other() {
    all_in_one_folder(&SHORT, "out");
}

#[test]
fn short_commands_in_the_folder_of_their_inputs_lose_nothing() {
    all_in_one_folder(&SHORT, ".");
}

/// Every pair of commands in a folder of its own, every name of a result taken by a stranger, and every result changed by its user.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn all_pairs_of_commands_lose_nothing() {
    let telemetry = inputs();
    good(
        telemetry.path(),
        &["run", "--fast", "plant.toml", "--out", "out"],
    );
    let telemetry = fs::read(telemetry.path().join("out/plant.csv")).unwrap();
    let fresh = |out: &str| {
        let folder = inputs();
        fs::write(folder.path().join("drives.csv"), &telemetry).unwrap();
        fs::create_dir_all(folder.path().join(out)).unwrap();
        folder
    };
    let (mut pairs, mut names) = (0, 0);
    for out in ["out", "."] {
        for (index, first) in COMMANDS.iter().enumerate() {
            let alone = fresh(out);
            let before = files(alone.path());
            let after = check(alone.path(), index, out, &Files::new(), &before);
            let own = written(&before, &after);
            for (second, command) in COMMANDS.iter().enumerate() {
                let own = match command[0] == first[0] {
                    true => own.clone(),
                    false => Files::new(),
                };
                let folder = fresh(out);
                restore(folder.path(), &after);
                check(folder.path(), second, out, &own, &after);
                pairs += 1;
            }
            for name in own.keys() {
                // A stranger in the place of one result.
                let folder = fresh(out);
                fs::write(folder.path().join(name), "of the user").unwrap();
                let before = files(folder.path());
                check(folder.path(), index, out, &Files::new(), &before);
                // One result that the user has changed.
                let folder = fresh(out);
                restore(folder.path(), &after);
                let mut changed = after[name].clone();
                changed.push(b' ');
                fs::write(folder.path().join(name), changed).unwrap();
                let before = files(folder.path());
                check(folder.path(), index, out, &own, &before);
                names += 2;
            }
        }
    }
    println!("{pairs} pairs of commands, {names} results of users in the way: no file lost");
}

fn restore(folder: &Path, all: &Files) {
    for (name, content) in all {
        fs::write(folder.join(name), content).unwrap();
    }
}

fn refused(folder: &Path, command: &[&str], said: &[&str]) {
    let before = files(folder);
    let output = trirrr(folder, command, "");
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{command:?}: {error}");
    for words in said {
        assert!(error.contains(words), "{command:?}: {error}");
    }
    assert!(files(folder) == before, "{command:?}");
}

fn good(folder: &Path, command: &[&str]) {
    let output = trirrr(folder, command, "");
    assert!(
        output.status.success(),
        "{command:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The table that a proposal gives to be filled in is filled in where it is, and stays, and so do the poses.
#[test]
fn a_proposal_that_is_filled_in_stays() {
    let folder = inputs();
    let at = |name: &str| folder.path().join("out/thesis-calibration").join(name);
    good(
        folder.path(),
        &["calibrate", "thesis.toml", "--propose", "4"],
    );
    let poses = fs::read(at("poses.csv")).unwrap();
    let filled = repository("scenes/measurements/thesis.csv");
    fs::write(at("measurements-next.csv"), &filled).unwrap();
    let form = "out/thesis-calibration/measurements-next.csv";
    good(folder.path(), &["calibrate", "thesis.toml", form]);
    assert_eq!(fs::read(at("measurements-next.csv")).unwrap(), filled);
    assert_eq!(fs::read(at("poses.csv")).unwrap(), poses);
    // From the result on: it is read, so it is not replaced.
    let result = "out/thesis-calibration/thesis.toml";
    let said = [
        "thesis-calibration/thesis.toml: this command reads it",
        "--out",
    ];
    refused(folder.path(), &["calibrate", result, "thesis.csv"], &said);
    good(
        folder.path(),
        &["calibrate", result, "thesis.csv", "--out", "second"],
    );
    // Another proposal would take the place of what the user has filled in.
    let said = ["measurements-next.csv: was changed since `trirrr calibrate` wrote it"];
    refused(
        folder.path(),
        &["calibrate", "thesis.toml", "--propose", "4"],
        &said,
    );
    // Results that nobody has changed are replaced.
    good(folder.path(), &["calibrate", "thesis.toml", "thesis.csv"]);
}

#[test]
fn inputs_are_not_replaced_by_any_of_their_names() {
    let folder = inputs();
    let path = folder.path();
    let calibrate = ["calibrate", "thesis.toml", "thesis.csv", "--out"];
    fs::create_dir(path.join("out")).unwrap();
    for out in [".", "out/..", "./", "out/../out/.."] {
        refused(
            path,
            &[&calibrate[..], &[out]].concat(),
            &["thesis.toml: this command reads it"],
        );
    }
    refused(
        path,
        &["check", "thesis.toml", "--figure", "./thesis.toml"],
        &["this command reads it"],
    );
    refused(
        path,
        &["eval", "cases.csv", "--out", "out/../cases.csv"],
        &["this command reads it"],
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../thesis.toml", path.join("out/thesis.toml")).unwrap();
        std::os::unix::fs::symlink("out", path.join("link")).unwrap();
        fs::hard_link(path.join("cases.csv"), path.join("out/cases.csv")).unwrap();
        refused(
            path,
            &[&calibrate[..], &["link"]].concat(),
            &["link/thesis.toml: this command reads it"],
        );
        refused(
            path,
            &["eval", "cases.csv", "--out", "link/cases.csv"],
            &["this command reads it"],
        );
        // A link to what nobody has made yet is no free name.
        std::os::unix::fs::symlink("nothing.svg", path.join("dangling.svg")).unwrap();
        refused(
            path,
            &["check", "thesis.toml", "--figure", "dangling.svg"],
            &["is there already"],
        );
    }
}

#[test]
fn what_stands_in_the_way_is_named_before_anything_is_touched() {
    let folder = inputs();
    let path = folder.path();
    fs::write(path.join("ticks.csv"), "measured").unwrap();
    fs::write(path.join("torque.svg"), "drawn").unwrap();
    let run = ["run", "--fast", "thesis.toml", "--out"];
    let said = ["ticks.csv: is there already, and not from `trirrr run`"];
    refused(path, &[&run[..], &["."]].concat(), &said);
    fs::remove_file(path.join("ticks.csv")).unwrap();
    refused(
        path,
        &[&run[..], &["."]].concat(),
        &["torque.svg: is there already"],
    );
    good(path, &[&run[..], &["out"]].concat());
    refused(
        path,
        &["plan", "engraving.toml", "--out", "out"],
        &[
            "out/result.json: the folder has the results of `trirrr run`",
            "--out",
        ],
    );
    // Changed by the user: named, and kept.
    fs::write(path.join("out/pose.svg"), "drawn better").unwrap();
    refused(
        path,
        &[&run[..], &["out"]].concat(),
        &["out/pose.svg: was changed since `trirrr run` wrote it"],
    );
    fs::remove_file(path.join("out/pose.svg")).unwrap();
    good(path, &[&run[..], &["out"]].concat());
    // A record that does not tell which files may go, as those of older versions.
    fs::write(
        path.join("out/result.json"),
        "{\"command\": \"run\", \"files\": [\"ticks.csv\"]}",
    )
    .unwrap();
    refused(
        path,
        &[&run[..], &["out"]].concat(),
        &["out/result.json: is changed, or of an older version"],
    );
}

/// Both have a folder of their own where none is named.
#[test]
fn a_plan_and_a_run_of_a_scene_keep_each_other() {
    let folder = inputs();
    let (plan, run) = (
        ["plan", "engraving.toml"],
        ["run", "--fast", "engraving.toml"],
    );
    good(folder.path(), &plan);
    let planned = files(folder.path());
    good(folder.path(), &run);
    good(folder.path(), &run);
    let both = files(folder.path());
    assert!(
        planned
            .iter()
            .all(|(name, content)| both.get(name) == Some(content))
    );
    assert!(both.contains_key("out/engraving/ticks.csv"));
    assert!(both.contains_key("out/engraving-plan/plan.csv"));
}

#[test]
fn a_named_file_is_replaced_by_the_command_that_wrote_it_alone() {
    let folder = inputs();
    let path = folder.path();
    let check = ["check", "thesis.toml", "--figure", "a.svg"];
    good(path, &check);
    good(path, &check);
    refused(
        path,
        &["eval", "cases.csv", "--out", "a.svg"],
        &["a.svg: is there already"],
    );
    fs::write(path.join("a-machine.svg"), "drawn better").unwrap();
    refused(path, &check, &["a-machine.svg: was changed"]);
    let eval = ["eval", "cases.csv", "--out", "results.csv"];
    // As `mktemp` makes it.
    fs::write(path.join("results.csv"), "").unwrap();
    good(path, &eval);
    good(path, &eval);
    fs::write(path.join("results.csv"), "measured").unwrap();
    refused(
        path,
        &eval,
        &["results.csv: was changed since `trirrr eval` wrote it"],
    );
}

/// A program that is killed leaves a table without an end, of which nobody knows whether it was changed since.
#[test]
fn the_table_of_a_killed_program_is_put_aside() {
    let folder = inputs();
    let path = folder.path();
    let thesis = String::from_utf8(repository("scenes/thesis.toml")).unwrap();
    let long = thesis.replace("duration_s = 1.0", "duration_s = 600.0");
    fs::write(path.join("long.toml"), long).unwrap();
    let mut killed = Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(["run", "long.toml", "--out", "out"])
        .current_dir(path)
        .spawn()
        .unwrap();
    let table = path.join("out/ticks.csv");
    while !table.exists() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    fs::write(&table, "t\n0.0\n").unwrap();
    // Not even by a command that reads it.
    let job = [
        "run",
        "--fast",
        "out/ticks.csv",
        "--machine",
        "thesis.toml",
        "--out",
        "out",
    ];
    let output = trirrr(path, &job, "");
    assert!(!output.status.success());
    assert_eq!(fs::read(&table).unwrap(), b"t\n0.0\n");
    good(path, &["run", "--fast", "thesis.toml", "--out", "out"]);
    let all = files(path);
    let aside = all
        .iter()
        .find(|(name, _)| name.contains("ticks.csv.unfinished"));
    assert_eq!(aside.unwrap().1, b"t\n0.0\n");
    assert!(all["out/ticks.csv"].len() > 1000);
    // From now on it is a file of the user.
    good(path, &["run", "--fast", "thesis.toml", "--out", "out"]);
    assert!(files(path).keys().any(|name| name.contains("unfinished")));
}
