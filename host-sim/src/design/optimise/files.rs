//! Files of a study, and its summary.

use super::record::StudyRecord;
use super::{DesignArgs, figures, page};
use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::{digits, print};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use trirrr_design::optimise::{Appraisal, Objective, StudyScene, best, front, with_values};
use trirrr_scene::Scene;
use trirrr_scene::read::Setting;

/// Names of the scene of the best candidate, and of its machine where it has a file of its own.
const BEST: &str = "best.toml";
const BEST_MACHINE: &str = "best-machine.toml";

/// Candidates with what follows from them.
pub(super) struct StudyResult {
    pub(super) all: Vec<Appraisal>,
    /// Numbers in `all`, from 0.
    pub(super) front: Vec<usize>,
    pub(super) best: Option<usize>,
}

impl StudyResult {
    fn of(record: &StudyRecord) -> Self {
        let all = record.appraisals();
        let front = front(&all, &record.objectives);
        let best = best(&all, &record.objectives);
        Self { all, front, best }
    }
}

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
    let mut record = record.clone();
    record.result = as_json(study, &result);
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
        let figures = figures::all(study, &record, &result);
        for (name, drawn) in &figures {
            results.write(&format!("{name}.svg"), drawn.as_str())?;
        }
        let html = page::html(args, study, &record, &result, &figures);
        results.write("study.html", html)?;
    }
    let end = match record.partial {
        true => Err("interrupted"),
        false => Ok(()),
    };
    results.end(end)?;
    if result.best.is_none() {
        return Err(CliError::Failed(no_candidate(
            &result,
            &results.path_of("evaluations.csv"),
        )));
    }
    match args.json {
        true => print(&json),
        false => print(&summary(study, &record, &result, &results.files())),
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

/// Arguments that make a candidate of the scene.
pub(super) fn set_arguments(study: &StudyScene, each: &Appraisal) -> Vec<String> {
    let settings = study.space.settings(&each.point);
    let set = |setting: &Setting| format!("{}={}", setting.key(), setting.value());
    settings.iter().map(set).collect()
}

fn as_json(study: &StudyScene, result: &StudyResult) -> Value {
    let of = |index: &usize| {
        let each = &result.all[*index];
        json!({
            "candidate": index + 1,
            "found": each.found.as_ref().ok(),
            "set": set_arguments(study, each),
        })
    };
    let feasible = result.all.iter().filter(|each| each.found.is_ok());
    json!({
        "feasible": feasible.count(),
        "best": result.best.as_ref().map(of),
        "best_is": if study.objectives.len() > 1 { "knee" } else { "optimum" },
        "front": result.front.iter().map(of).collect::<Vec<_>>(),
    })
}

/// Cell of a CSV table.
fn cell(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// Table of all candidates, or of those of the front.
fn table(study: &StudyScene, result: &StudyResult, only: Option<&[usize]>) -> String {
    let mut heads = vec!["candidate".to_owned(), "mode".to_owned()];
    heads.extend(study.space.ranges.iter().map(|range| cell(&range.name())));
    heads.extend(study.objectives.iter().map(|each| each.column().to_owned()));
    heads.extend(["shortfall".into(), "reason".into(), "best".into()]);
    let mut text = heads.join(",") + "\n";
    let every: Vec<usize> = (0..result.all.len()).collect();
    for &index in only.unwrap_or(&every) {
        let Appraisal { point, found } = &result.all[index];
        let mode = point.mode.map_or(String::new(), |mode| mode.to_string());
        let mut cells = vec![(index + 1).to_string(), mode];
        cells.extend(point.values.iter().map(|value| format!("{value:?}")));
        match found {
            Ok(found) => {
                cells.extend(found.iter().map(|value| format!("{value:?}")));
                cells.extend([String::new(), String::new()]);
            }
            Err(fault) => {
                cells.extend(study.objectives.iter().map(|_| String::new()));
                cells.extend([format!("{:?}", fault.shortfall), cell(&fault.reason)]);
            }
        }
        let is_best = Some(index) == result.best;
        cells.push(if is_best { "1".into() } else { String::new() });
        text += &(cells.join(",") + "\n");
    }
    text
}

/// A value and its unit.
pub(super) fn value_in_words(objective: Objective, value: f64) -> String {
    let [_, unit] = objective.words();
    format!("{} {unit}", digits(value))
}

fn summary(
    study: &StudyScene,
    record: &StudyRecord,
    result: &StudyResult,
    files: &[PathBuf],
) -> String {
    let feasible = result.all.iter().filter(|each| each.found.is_ok()).count();
    let mut text = format!(
        "{}: {} candidates, {feasible} of them do the job{}\n",
        record.scene,
        result.all.len(),
        match record.partial {
            true => "; interrupted, so the best one so far",
            false => "",
        }
    );
    let best = result.best.map(|index| &result.all[index]);
    for (index, objective) in study.objectives.iter().enumerate() {
        let [words, _] = objective.words();
        let before = match &record.own.found {
            Some(found) => value_in_words(*objective, found[index]),
            None => "none".into(),
        };
        let after = best.and_then(|each| Some(each.found.as_ref().ok()?[index]));
        let after = after.map_or("none".into(), |value| value_in_words(*objective, value));
        let _ = writeln!(text, "{words:<30} {before:>14} -> {after}");
    }
    if let Some(reason) = &record.own.reason {
        let _ = writeln!(text, "the scene itself: {reason}");
    }
    if study.objectives.len() > 1 {
        let _ = writeln!(
            text,
            "front: {} candidates that no other one beats; the best is its knee",
            result.front.len()
        );
    }
    if let Some(each) = best {
        if let Some(mode) = each.point.mode {
            let _ = writeln!(text, "working mode {mode}");
        }
        for (range, value) in study.space.ranges.iter().zip(&each.point.values) {
            let at = match *value {
                value if value == range.low => "  (its least)",
                value if value == range.high => "  (its greatest)",
                _ => "",
            };
            let _ = writeln!(text, "{} = {value}{at}", range.name());
        }
    }
    for file in files {
        let _ = writeln!(text, "wrote {}", file.display());
    }
    text
}
