//! The simulated machine of a redundant scene: `plant.csv` and its figures.

use crate::failure::CliError;
use crate::figures::{DrawnJob, MotorCurves, PlantTraces};
use crate::player::STOPPED;
use crate::results::ResultFolder;
use crate::run::{PlantTable, Simulated};
use std::sync::atomic::AtomicBool;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::redundant::{RedundantOutcome, RedundantRow, simulate};

fn columns(scene: &RedundantScene) -> Vec<String> {
    let stems = ["t", "x", "y", "alpha", "x_error", "y_error", "alpha_error"];
    let mut names: Vec<String> = stems.map(str::to_owned).into();
    let legs = 1..=scene.legs.len();
    names.extend(legs.clone().map(|leg| format!("th1_error{leg}")));
    names.extend(legs.map(|leg| format!("tau{leg}")));
    for stem in ["s_error", "Fs"] {
        let sliders = scene.slider_legs().into_iter();
        names.extend(sliders.map(|leg| format!("{stem}{}", leg + 1)));
    }
    names
}

/// Prepares the table and the figures of the plant of `scene`, if it has one, before the job is played.
///
/// # Errors
/// Refused: a file that is in the way. Failed: the table cannot be written.
pub(super) fn plant_table(
    scene: &RedundantScene,
    results: &mut ResultFolder,
) -> Result<Option<PlantTable<RedundantRow>>, CliError> {
    let traces = || {
        let rows = u64::from(scene.ticks()) + 1;
        PlantTraces::redundant(rows, DrawnJob::of_redundant(scene))
    };
    let plant = scene.plant.as_ref();
    let table = plant.map(|_| PlantTable::create(results, &columns(scene), traces()));
    table.transpose()
}

/// Simulates the plant of `scene` into its `table`. `asked` are the torques and powers of the job.
///
/// # Errors
/// Refused: the machine. Failed: something cannot be written.
pub(super) fn simulate_plant(
    scene: &RedundantScene,
    mut table: PlantTable<RedundantRow>,
    results: &mut ResultFolder,
    asked: &MotorCurves,
    stop: &AtomicBool,
) -> Result<Simulated<RedundantOutcome>, CliError> {
    let outcome = simulate(scene, stop, &mut |row| table.push(row))
        .map_err(|error| CliError::Refused(error.to_string()))?;
    let failure = outcome.failure.as_ref();
    Ok(Simulated {
        is_stopped: outcome.is_stopped,
        reason: match outcome.is_stopped {
            true => Some(STOPPED.into()),
            false => failure.map(|why| format!("the plant: {why}")),
        },
        outcome,
        files: table.finish(results, &scene.name, asked)?,
    })
}
