//! Files of a study, and its summary.

use super::record::{StudyRecord, StudyResult};
use super::{
    DesignArgs,
    document::{add_machines, document},
    figures,
};
use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::print;
use std::path::Path;
use trirrr_design::optimise::{Appraisal, StudyScene, with_values};
use trirrr_figures::document::{Facts, csv};
use trirrr_scene::Scene;
use trirrr_scene::read::Setting;

/// Names of the scene of the best candidate, and of its machine where it has a file of its own.
const BEST: &str = "best.toml";
const BEST_MACHINE: &str = "best-machine.toml";

/// Names of the tables and scenes of a study.
const FILES: [&str; 6] = [
    "study.json",
    "evaluations.csv",
    BEST,
    BEST_MACHINE,
    "front.csv",
    "study.html",
];

/// Takes `folder` for the results of a study.
///
/// # Errors
/// Refused: as [`ResultFolder`] refuses it.
pub(super) fn results(folder: &Path) -> Result<ResultFolder, CliError> {
    let mut results = ResultFolder::for_command(folder, "design --vary")?;
    results.claim(FILES)?;
    Ok(results)
}

/// Writes the files of a study into `results` and prints its summary.
///
/// # Errors
/// Failed: no candidate does the job, or a file cannot be written.
pub(super) fn write(
    args: &DesignArgs,
    study: &StudyScene,
    record: &StudyRecord,
    mut results: ResultFolder,
) -> Result<(), CliError> {
    let result = StudyResult::of(record);
    let figures = match result.best {
        Some(_) => figures::all(study, record, &result),
        None => Vec::new(),
    };
    let mut document = document(study, record, &result, &figures);
    let mut record = record.clone();
    record.result = document.json();
    let json = serde_json::to_string_pretty(&record)
        .map_err(|error| CliError::Failed(error.to_string()))?;
    let json = format!("{json}\n");
    results.write("study.json", json.as_str())?;
    results.write("evaluations.csv", table(study, &result, None))?;
    if let Some(index) = result.best {
        write_best(study, &result.all[index], &mut results)?;
        if study.objectives.len() > 1 {
            let rows = table(study, &result, Some(&result.front));
            results.write("front.csv", rows)?;
        }
        for (name, drawn) in &figures {
            results.write(&format!("{name}.svg"), drawn.as_str())?;
        }
        add_machines(&mut document, args, study, &record, &result);
        let title = format!("{}: study", record.scene);
        results.write("study.html", document.page(&title))?;
    }
    results.end(record.partial.then_some("interrupted"))?;
    if result.best.is_none() {
        return Err(CliError::Failed(no_candidate(
            &result,
            &results.path_of("evaluations.csv"),
        )));
    }
    match args.json {
        true => print(&json),
        false => print(&document.files(results.files()).text()),
    }
}

/// Message where no candidate does the job.
fn no_candidate(result: &StudyResult, table: &Path) -> String {
    let faults = result
        .all
        .iter()
        .filter_map(|each| Some((each, each.found.as_ref().err()?)));
    let nearest = faults.min_by(|one, other| one.1.shortfall.total_cmp(&other.1.shortfall));
    let nearest = nearest.map_or(String::new(), |(_, fault)| {
        format!("; the nearest one: {}", fault.reason)
    });
    format!(
        "none of {} candidates does the job{nearest}; see {}",
        result.all.len(),
        table.display()
    )
}

/// Writes the scene of the best candidate, and checks that it reads as what was looked at.
fn write_best(
    study: &StudyScene,
    best: &Appraisal,
    results: &mut ResultFolder,
) -> Result<(), CliError> {
    let failed = CliError::Failed;
    let own = study.settings.iter().cloned();
    let settings: Vec<Setting> = own.chain(study.space.settings(&best.point)).collect();
    let edited = with_values(&study.text, &study.file, &settings, BEST_MACHINE).map_err(failed)?;
    let machine = edited.machine.clone();
    let machines = |_: &Path| machine.clone().ok_or_else(|| "no machine".to_owned());
    let (written, _) = Scene::parse_shown(&edited.scene, BEST, &[], &machines);
    let written = written.map_err(|error| failed(error.to_string()))?;
    let meant = Scene::parse_set(&study.text, &study.file, &settings)
        .map_err(|error| failed(error.to_string()))?;
    if written.parameters != meant.parameters || written.job != meant.job {
        return Err(failed(format!("{BEST}: is not the best candidate")));
    }
    if let Some(machine) = edited.machine {
        results.write(BEST_MACHINE, machine)?;
    }
    results.write(BEST, edited.scene).map(drop)
}

/// Table of all candidates, or of those of the front.
fn table(study: &StudyScene, result: &StudyResult, only: Option<&[usize]>) -> String {
    let every: Vec<usize> = (0..result.all.len()).collect();
    let row = |&index: &usize| {
        let Appraisal { point, found } = &result.all[index];
        let mut row = Facts::new().data("candidate", index + 1);
        row = row.data("mode", point.mode.map(|mode| mode.to_string()));
        for (range, value) in study.space.ranges.iter().zip(&point.values) {
            row = row.data(range.name(), value);
        }
        for (place, objective) in study.objectives.iter().enumerate() {
            row = row.data(
                objective.column(),
                found.as_ref().ok().map(|found| found[place]),
            );
        }
        let fault = found.as_ref().err();
        row.data("shortfall", fault.map(|fault| fault.shortfall))
            .data("reason", fault.map(|fault| &fault.reason))
            .data("best", (Some(index) == result.best).then_some(1))
    };
    csv(&only.unwrap_or(&every).iter().map(row).collect::<Vec<_>>())
}
