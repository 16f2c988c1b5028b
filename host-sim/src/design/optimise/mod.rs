//! `trirrr design --vary`: looks for the machine that does a job best.

mod document;
mod figures;
mod files;
mod record;

use super::DesignArgs;
use crate::arguments::scene_text;
use crate::failure::CliError;
use crate::terminal::bar;
use record::StudyRecord;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_design::optimise::{
    DesignSpace, MapSettings, SearchPlan, SearchWatch, StudyScene, VariedKey, own_value, search,
};
use trirrr_scene::Scene;
use trirrr_scene::read::Setting;

/// Cells of the report for one of the maps of candidates, and the fewest of those.
const COARSER: usize = 4;
const CELLS_MIN: usize = 16;

/// Most quantities of a study.
const OBJECTIVES: usize = 2;

/// Carries out a study, or a part of one, or puts parts together. True: to the end; false: `stop` ended it.
///
/// # Errors
/// Refused: a range, a quantity, the scene or parts. Failed: no candidate does the job, or a file cannot be written.
pub(super) fn command(args: &DesignArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    let (text, file) = scene_text(&args.scene)?;
    // What stands in the way is said before hours of search.
    let (study, record, results) = match args.vary.merge.is_empty() {
        true => {
            let study = asked_for(args, text, file)?;
            let results = files::results(&folder_of(args, &draft_of(&study)?.name))?;
            let record = carried_out(args, &study, stop)?;
            (study, record, results)
        }
        false => {
            let (study, record) = record::merged(args, text, file)?;
            let results = files::results(&folder_of(args, &record.scene))?;
            (study, record, results)
        }
    };
    files::write(args, &study, &record, results)?;
    Ok(!record.partial)
}

/// The study that arguments ask for.
fn asked_for(args: &DesignArgs, text: String, file: String) -> Result<StudyScene, CliError> {
    let refused = CliError::Refused;
    let objectives = args.vary.objectives.clone();
    if objectives.len() > OBJECTIVES {
        return Err(refused("--for: takes one quantity or two".into()));
    }
    if objectives.len() == OBJECTIVES && objectives[0] == objectives[1] {
        return Err(refused(format!("--for: {} stands twice", objectives[0])));
    }
    let study = StudyScene {
        text,
        file,
        settings: args.set.set.clone(),
        space: DesignSpace::of(&args.vary.vary).map_err(refused)?,
        objectives,
        maps: MapSettings {
            alpha_rad: args.alpha.map(f64::to_radians),
            turn_rad: args.turn.to_radians(),
            cells: (args.cells as usize / COARSER).max(CELLS_MIN),
        },
    };
    study.check().map_err(refused)?;
    Ok(study)
}

/// Looks at the candidates of a study.
fn carried_out(
    args: &DesignArgs,
    study: &StudyScene,
    stop: &AtomicBool,
) -> Result<StudyRecord, CliError> {
    let draft = draft_of(study)?;
    let modes = study.space.modes.iter().copied().map(Some);
    let mut plan = SearchPlan {
        space: &study.space,
        modes: match study.space.modes.is_empty() {
            true => vec![None],
            false => modes.collect(),
        },
        own: own_values(study)?,
        objectives: &study.objectives,
        evaluations: args.vary.evaluations as usize,
        seed: args.vary.seed,
    };
    if let Some([part, count]) = args.vary.shard {
        plan.take_part(part as usize - 1, count as usize);
        if plan.evaluations == 0 {
            let reason = format!("--shard {part}/{count}: has no evaluation of --evaluations");
            return Err(CliError::Refused(reason));
        }
    }
    let own = study.own();
    let template = "{elapsed_precise} {wide_bar} {pos} of {len} candidates, {eta} left";
    let bar = bar(plan.evaluations as u64, template);
    let watch = SearchWatch {
        stop,
        told: &|| bar.inc(1),
    };
    let found = search(&plan, &|point| study.appraise(point), &watch);
    bar.finish_and_clear();
    Ok(StudyRecord::new(
        args,
        study,
        &draft,
        (own, found),
        stop.load(Ordering::Relaxed),
    ))
}

fn draft_of(study: &StudyScene) -> Result<Scene, CliError> {
    study
        .draft()
        .map_err(|error| CliError::Refused(error.to_string()))
}

/// Values of the scene itself under the varied keys; the middle, where it has none.
fn own_values(study: &StudyScene) -> Result<Vec<f64>, CliError> {
    let mut values = Vec::new();
    for range in &study.space.ranges {
        let [key] = &range.settings(range.low)[..1] else {
            return Err(CliError::Refused(format!("--vary {range}: no key")));
        };
        let is_same = |setting: &&Setting| setting.key() == key.key();
        let set = study.settings.iter().rev().find(is_same);
        let own = match set.and_then(|setting| setting.value().parse().ok()) {
            Some(value) => Some(value),
            None => own_value(&study.text, &study.file, key).map_err(CliError::Refused)?,
        };
        values.push(own.unwrap_or(range.at(0.5)));
    }
    Ok(values)
}

/// The study of a record, with the scene that arguments name.
fn study_of(
    args: &DesignArgs,
    record: &StudyRecord,
    text: String,
    file: String,
) -> Result<StudyScene, String> {
    let varied: Result<Vec<VariedKey>, String> =
        record.vary.iter().map(|text| text.parse()).collect();
    Ok(StudyScene {
        text,
        file,
        settings: args.set.set.clone(),
        space: DesignSpace::of(&varied?)?,
        objectives: record.objectives.clone(),
        maps: record.maps,
    })
}

/// Folder of a study, or of one part of it.
fn folder_of(args: &DesignArgs, scene: &str) -> std::path::PathBuf {
    let part = |[part, count]: [u32; 2]| format!("-{part}-of-{count}");
    let part = args.vary.shard.map_or(String::new(), part);
    match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{scene}-study{part}")),
    }
}
