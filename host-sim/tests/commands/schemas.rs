//! Schemas of what commands print with `--json`: `docs/schemas` has them, and these tests keep them true.

use crate::common::{json, keeps_schema, trirrr};
use serde_json::Value;
use tempfile::TempDir;

/// A scene, a table or a linkage of the repository.
fn shipped(name: &str) -> String {
    format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"))
}

fn scene(name: &str) -> String {
    shipped(&format!("scenes/{name}.toml"))
}

/// Objects that `commands` print.
fn printed(commands: &[&[&str]]) -> Vec<Value> {
    let folder = TempDir::new().unwrap();
    let printed = commands
        .iter()
        .map(|command| json(&trirrr(&folder, &[command, &["--json"][..]].concat())));
    printed.collect()
}

#[test]
fn runs_of_all_machines_keep_one_schema() {
    let scenes = [
        "thesis",
        "thesis-links",
        "plant-reference",
        "redundant/4rrr",
        "redundant/2prrr-rrr",
        "vertical",
    ];
    let [thesis, links, plant, four, sliders, vertical] = scenes.map(scene);
    let commands: [&[&str]; 6] = [
        &["run", &thesis],
        &["run", &links, "--fast", "--lagrange"],
        &["run", &plant, "--fast"],
        &["run", &four, "--fast"],
        &["run", &sliders, "--fast", "--lagrange"],
        &["run", &vertical, "--fast", "--tolerances"],
    ];
    keeps_schema("run", &printed(&commands));
}

#[test]
fn checks_and_plans_keep_their_schemas() {
    let [thesis, engraving, sliders] = ["thesis", "engraving", "redundant/2prrr-rrr"].map(scene);
    keeps_schema(
        "check",
        &printed(&[
            &["check", &thesis],
            &["check", &engraving],
            &["check", &sliders],
        ]),
    );
    keeps_schema("plan", &printed(&[&["plan", &engraving]]));
}

#[test]
fn machines_and_linkages_keep_their_schemas() {
    let thesis = scene("thesis");
    keeps_schema("assemble", &printed(&[&["assemble", &thesis]]));
    let measured = shipped("scenes/measurements/thesis.csv");
    let calibrated: &[&str] = &["calibrate", &thesis, &measured];
    let proposed = ["calibrate", &thesis, "--propose", "4"];
    keeps_schema("calibrate", &printed(&[calibrated, &proposed]));
    let linkage = |name: &str| shipped(&format!("linkages/{name}.toml"));
    let [two_loop, shaper, tetrad, arm] =
        ["two-loop", "shaper", "tetrad", "serial-arm"].map(linkage);
    let commands: [&[&str]; 3] = [
        &["linkage", &two_loop],
        &["linkage", &shaper],
        &["linkage", &tetrad],
    ];
    keeps_schema("linkage", &printed(&commands));
    let inverse: &[&str] = &["linkage", &arm, "--inverse-deg", "0.5,0.2,45"];
    keeps_schema("linkage-inverse", &printed(&[inverse]));
}
