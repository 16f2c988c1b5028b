//! Scenes that the tests simulate.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use trirrr_drives::stepper::Line;
use trirrr_plant::table::Row;
use trirrr_plant::{Outcome, PlantRun, Refusal, job};
use trirrr_scene::Scene;

/// The text of a shipped scene.
pub(crate) fn text(name: &str) -> String {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenes")
        .join(name)
        .with_extension("toml");
    std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// A shipped scene.
pub(crate) fn shipped(name: &str) -> Scene {
    parse(&text(name))
}

/// The scene in `text`.
pub(crate) fn parse(text: &str) -> Scene {
    Scene::parse(text, "test.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The machine of a shipped scene with ideal sources of torque in place of its drives; the rotors
/// stay where they are.
pub(crate) fn without_drives(name: &str) -> Scene {
    Scene {
        drives: None,
        plant: None,
        ..shipped(name)
    }
}

/// `text` with each first occurrence replaced.
pub(crate) fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no {from:?}");
        text.replacen(from, to, 1)
    })
}

/// Runs the plant of `scene` on the ticks of its job, as a service gives them.
pub(crate) fn attempt(scene: &Scene) -> Result<(Outcome, Vec<Row>), Refusal> {
    let line = Line::new();
    let mut run = PlantRun::<f64>::build(scene, &line)?;
    let mut rows = Vec::new();
    let mut sink = |row: &Row| rows.push(*row);
    for output in job::outputs(scene)? {
        run.tick(&output, &mut sink);
    }
    let outcome = run.finish(&AtomicBool::new(false), &mut sink);
    Ok((outcome, rows))
}
