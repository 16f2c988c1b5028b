//! `trirrr design`: where a machine can work, in which working mode, with which motors and bearings.

mod args;
mod document;
mod field;
mod figures;
mod motor_figures;
mod optimise;
mod study;

pub use args::{DesignArgs, StudyArgs};

use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::print;
use document::{document, map_table};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::Study;

/// Studies the machine of a scene, writes the report, and prints a summary; or looks for a better one, until `stop`. True: to the end.
///
/// # Errors
/// Refused: the scene, in all working modes; a range or the parts of a study. Failed: a file cannot be written.
pub fn command(args: &DesignArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    match args.vary.vary.is_empty() && args.vary.merge.is_empty() {
        true => report(args).map(|()| true),
        false => optimise::command(args, stop),
    }
}

fn report(args: &DesignArgs) -> Result<(), CliError> {
    let study = Study::of(args)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-design", study.scene.name)),
    };
    let mut results =
        ResultFolder::for_command(&folder, "design")?.with_pictures(args.pictures.png);
    let mut figures: Vec<(&'static str, String)> = Vec::new();
    for (name, drawn) in figures::all(&study) {
        let drawn = drawn.map_err(|error| {
            CliError::Failed(format!("{}: {name}.svg: {error}", folder.display()))
        })?;
        figures.push((name, drawn));
    }
    figures.extend(motor_figures::all(&study));
    for (name, drawn) in &figures {
        results.write(&format!("{name}.svg"), drawn.as_str())?;
    }
    results.pictures()?;
    let mut document = document(&study, args, &figures);
    let json = format!("{:#}\n", document.json());
    results.write("design.json", json.as_str())?;
    results.write("map.csv", map_table(&study))?;
    results.write("animation.html", study.animation.page(&study.scene.name))?;
    let title = format!("{}: design report", study.scene.name);
    results.write("report.html", document.page(&title))?;
    results.end(None)?;
    match args.json {
        true => print(&json),
        false => print(&document.files(results.files()).text()),
    }
}
