//! The simulated machine of a redundant scene: `plant.csv` and its figures.

use crate::failure::CliError;
use crate::figures::RedundantPlantTraces;
use crate::recording::table_line;
use crate::results::{ResultFolder, unwritable};
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::redundant::{RedundantOutcome, RedundantRow, simulate};

/// Outcome of the plant, and the files.
pub(super) struct SimulatedMachine {
    pub(super) outcome: RedundantOutcome,
    pub(super) files: Vec<PathBuf>,
}

fn names(scene: &RedundantScene) -> Vec<String> {
    let stems = ["t", "x", "y", "alpha", "x_error", "y_error", "alpha_error"];
    let mut names: Vec<String> = stems.map(str::to_owned).into();
    let legs = 1..=scene.legs.len();
    names.extend(legs.clone().map(|leg| format!("th1_error{leg}")));
    names.extend(legs.clone().map(|leg| format!("tau{leg}")));
    for stem in ["s_error", "Fs"] {
        let sliders = legs.clone().filter(|leg| scene.sliders[leg - 1].is_some());
        names.extend(sliders.map(|leg| format!("{stem}{leg}")));
    }
    names
}

fn values(row: &RedundantRow) -> impl Iterator<Item = f64> {
    let first = std::iter::once(row.t).chain(row.pose).chain(row.error);
    let motors = row.joint_errors.iter().chain(&row.torques);
    let sliders = row.slider_errors.iter().chain(&row.forces);
    first
        .chain(motors.copied())
        .chain(sliders.copied().flatten())
}

/// Table of the plant.
const TABLE: &str = "plant.csv";

/// Claims the files of the plant, before the job is played.
///
/// # Errors
/// Refused: as [`ResultFolder::claim`].
pub(super) fn claim_plant(
    scene: &RedundantScene,
    results: &mut ResultFolder,
) -> Result<(), CliError> {
    match &scene.plant {
        Some(_) => {
            let figures = RedundantPlantTraces::new(scene);
            results.claim(figures.names().chain([TABLE]))
        }
        None => Ok(()),
    }
}

/// Simulates the plant of `scene`, and writes its table and figures.
///
/// # Errors
/// Refused: the machine. Failed: something cannot be written.
pub(super) fn simulate_plant(
    scene: &RedundantScene,
    results: &mut ResultFolder,
    stop: &AtomicBool,
) -> Result<SimulatedMachine, CliError> {
    let (path, file) = results.table(TABLE)?;
    let mut table = BufWriter::new(file);
    let mut written = writeln!(table, "{}", names(scene).join(","));
    let mut traces = RedundantPlantTraces::new(scene);
    let mut line = String::new();
    let mut sink = |row: &RedundantRow| {
        table_line(&mut line, values(row));
        if written.is_ok() {
            written = table.write_all(line.as_bytes());
        }
        traces.push(row);
    };
    let outcome =
        simulate(scene, stop, &mut sink).map_err(|error| CliError::Refused(error.to_string()))?;
    let written = written.and_then(|()| table.flush());
    written.map_err(|error| unwritable(&path, &error))?;
    let figures = traces.write(results, &scene.name)?;
    Ok(SimulatedMachine {
        outcome,
        files: std::iter::once(path).chain(figures).collect(),
    })
}
