//! `trirrr check` for a redundant machine.

use super::{kind_text, placement_text, read, slider_texts};
use crate::check::CheckArgs;
use crate::failure::CliError;
use crate::terminal::print;
use serde_json::json;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_scene::words::tick_time;

/// Checks the scene, and prints what it asks for.
///
/// # Errors
/// Refused: everything that is found wrong, each with its line; a figure, which draws a path.
pub fn check(args: &CheckArgs) -> Result<(), CliError> {
    if args.figure.is_some() {
        return Err(CliError::Refused(format!(
            "{}: --figure draws a path, and the job of a redundant machine has moves; `trirrr run --fast` draws them",
            args.scene.display()
        )));
    }
    let scene = read(&args.scene, &args.job)?;
    match args.json {
        true => print(&format!("{}\n", as_json(&scene))),
        false => print(&as_text(&scene)),
    }
}

fn as_text(scene: &RedundantScene) -> String {
    let moves = scene.job.moves.len();
    let mut text = format!(
        "{}: good\n{}\n{moves} {}, {} s: {} ticks at {} Hz in f64\n",
        scene.name,
        kind_text(scene.kind),
        if moves == 1 { "move" } else { "moves" },
        tick_time(scene.duration_s()),
        scene.ticks(),
        scene.tick_rate_hz,
    );
    for line in slider_texts(scene).into_iter().chain(placement_text(scene)) {
        text += &format!("{line}\n");
    }
    text
}

fn as_json(scene: &RedundantScene) -> serde_json::Value {
    json!({
        "scene": scene.name,
        "description": scene.description,
        "kind": scene.kind.name(),
        "tick_rate_hz": scene.tick_rate_hz,
        "moves": scene.job.moves.len(),
        "ticks": scene.ticks(),
        "duration_s": scene.duration_s(),
        "sliders": super::json::sliders(scene),
        "placement": super::json::placement(scene),
    })
}
