//! `study.json`: all that a study looked at, and parts of studies that are put together.

use super::{DesignArgs, draft_of, study_of};
use crate::failure::CliError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;
use trirrr_design::optimise::{
    Appraisal, CandidateFault, DesignPoint, MapSettings, Objective, StudyMode, StudyScene, best,
    front,
};
use trirrr_scene::Scene;
use trirrr_scene::read::Setting;
use trirrr_scene::read::files::{self, LONGEST_TABLE};

/// Version of the file.
const FORMAT: u32 = 1;

/// A study, or a part of one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StudyRecord {
    format: u32,
    /// Name of the scene.
    pub(super) scene: String,
    /// Key of the scene with the values of `--set`: parts of one study have the same.
    key: u32,
    pub(super) vary: Vec<String>,
    #[serde(rename = "for")]
    pub(super) objectives: Vec<Objective>,
    pub(super) maps: MapSettings,
    evaluations: u32,
    pub(super) seed: u64,
    /// Part and count of parts, from 1; none: the whole.
    pub(super) shard: Option<[u32; 2]>,
    /// The study was ended before it was complete.
    pub(super) partial: bool,
    /// The scene without other values.
    pub(super) own: FoundValues,
    pub(super) candidates: Vec<CandidateRecord>,
    /// Numbers of candidates that no other one beats, from 1, and what follows from them; for readers of the file.
    #[serde(default)]
    pub(super) result: Value,
}

/// Candidate of a study.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CandidateRecord {
    mode: Option<String>,
    values: Vec<f64>,
    // Written out in place of a flat `FoundValues`: numbers that serde keeps for a flat part are none to it where `serde_json` has
    // arbitrary precision.
    found: Option<Vec<f64>>,
    reason: Option<String>,
    shortfall: Option<f64>,
}

impl CandidateRecord {
    fn of(each: &Appraisal) -> Self {
        let FoundValues {
            found,
            reason,
            shortfall,
        } = FoundValues::from(&each.found);
        Self {
            mode: each.point.mode.map(|mode| mode.to_string()),
            values: each.point.values.clone(),
            found,
            reason,
            shortfall,
        }
    }

    fn result(&self) -> Result<Vec<f64>, CandidateFault> {
        self.found.clone().ok_or_else(|| CandidateFault {
            reason: self.reason.clone().unwrap_or_default(),
            shortfall: self.shortfall.unwrap_or(0.0),
        })
    }
}

/// Values of the objectives, or why there are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FoundValues {
    pub(super) found: Option<Vec<f64>>,
    pub(super) reason: Option<String>,
    pub(super) shortfall: Option<f64>,
}

impl From<&Result<Vec<f64>, CandidateFault>> for FoundValues {
    fn from(result: &Result<Vec<f64>, CandidateFault>) -> Self {
        let fault = result.as_ref().err();
        Self {
            found: result.as_ref().ok().cloned(),
            reason: fault.map(|fault| fault.reason.clone()),
            shortfall: fault.map(|fault| fault.shortfall),
        }
    }
}

impl StudyRecord {
    pub(super) fn new(
        args: &DesignArgs,
        study: &StudyScene,
        draft: &Scene,
        (own, found): (Result<Vec<f64>, CandidateFault>, Vec<Appraisal>),
        partial: bool,
    ) -> Self {
        let candidates = found.iter().map(CandidateRecord::of);
        Self {
            format: FORMAT,
            scene: draft.name.clone(),
            key: draft.key,
            vary: study.space.names(),
            objectives: study.objectives.clone(),
            maps: study.maps,
            evaluations: args.vary.evaluations,
            seed: args.vary.seed,
            shard: args.vary.shard,
            partial,
            own: FoundValues::from(&own),
            candidates: candidates.collect(),
            result: Value::Null,
        }
    }

    /// Reads a file.
    fn read(file: &Path) -> Result<Self, CliError> {
        let refused = |reason: String| CliError::Refused(format!("{}: {reason}", file.display()));
        let text = files::text_in(file, LONGEST_TABLE)
            .map_err(|error| refused(format!("cannot be read: {error}")))?;
        let record: Self = serde_json::from_str(&text)
            .map_err(|error| refused(format!("is no study.json: {error}")))?;
        let faulty = |each: &CandidateRecord| {
            let counts = |found: &Vec<f64>| found.len() == record.objectives.len();
            let mode = each.mode.as_ref();
            !each.found.as_ref().is_none_or(counts)
                || mode.is_some_and(|mode| mode.parse::<StudyMode>().is_err())
        };
        match () {
            () if record.format != FORMAT => Err(refused(format!(
                "format = {}: this program reads {FORMAT}",
                record.format
            ))),
            () if record.candidates.iter().any(faulty) => Err(refused(
                "a candidate has a wrong mode or count of values".into(),
            )),
            () => Ok(record),
        }
    }

    /// The candidates.
    pub(super) fn appraisals(&self) -> Vec<Appraisal> {
        let of = |each: &CandidateRecord| Appraisal {
            point: DesignPoint {
                mode: each.mode.as_ref().and_then(|mode| mode.parse().ok()),
                values: each.values.clone(),
            },
            found: each.result(),
        };
        self.candidates.iter().map(of).collect()
    }

    /// First quantity in which two parts are not of one study.
    fn difference(&self, other: &Self) -> Option<String> {
        let pairs = [
            ("scene", self.scene.clone(), other.scene.clone()),
            ("key", self.key.to_string(), other.key.to_string()),
            ("vary", self.vary.join(" "), other.vary.join(" ")),
            (
                "for",
                format!("{:?}", self.objectives),
                format!("{:?}", other.objectives),
            ),
            (
                "maps",
                format!("{:?}", self.maps),
                format!("{:?}", other.maps),
            ),
            (
                "evaluations",
                self.evaluations.to_string(),
                other.evaluations.to_string(),
            ),
            ("seed", self.seed.to_string(), other.seed.to_string()),
        ];
        let [name, one, two] = pairs
            .into_iter()
            .find(|(_, one, two)| one != two)
            .map(|(name, one, two)| [name.into(), one, two])?;
        Some(format!("{name} = {one}, and {two} in the first"))
    }
}

/// Puts the parts of a study together: in the order of their numbers, whatever that of the files is.
///
/// # Errors
/// Refused: a file that is no part, parts of several studies, or of another scene, a part that is missing or stands twice.
pub(super) fn merged(
    args: &DesignArgs,
    text: String,
    file: String,
) -> Result<(StudyScene, StudyRecord), CliError> {
    let refused =
        |file: &Path, reason: String| CliError::Refused(format!("{}: {reason}", file.display()));
    let mut parts: Vec<(&Path, [u32; 2], StudyRecord)> = Vec::new();
    for file in &args.vary.merge {
        let record = StudyRecord::read(file)?;
        let Some(shard) = record.shard else {
            let reason = "is a whole study; parts are made with --shard I/N";
            return Err(refused(file, reason.into()));
        };
        if let Some((_, _, first)) = parts.first()
            && let Some(difference) = record.difference(first)
        {
            return Err(refused(file, format!("is of another study: {difference}")));
        }
        let [part, count] = shard;
        if let Some((first, [_, of], _)) = parts.first()
            && *of != count
        {
            let reason = format!("part {part} of {count}, but {} is of {of}", first.display());
            return Err(refused(file, reason));
        }
        if let Some((other, ..)) = parts.iter().find(|(_, [same, _], _)| *same == part) {
            let reason = format!("part {part} of {count} stands in {}, too", other.display());
            return Err(refused(file, reason));
        }
        parts.push((file, shard, record));
    }
    parts.sort_by_key(|(_, [part, _], _)| *part);
    let Some((_, [_, count], first)) = parts.first() else {
        return Err(CliError::Refused("--merge: no file".into()));
    };
    let missing: Vec<String> = (1..=*count)
        .filter(|part| !parts.iter().any(|(_, [own, _], _)| own == part))
        .map(|part| part.to_string())
        .collect();
    if !missing.is_empty() {
        return Err(CliError::Refused(format!(
            "--merge: of {count} parts, these are missing: {}",
            missing.join(", ")
        )));
    }
    let study = study_of(args, first, text, file).map_err(CliError::Refused)?;
    let draft = draft_of(&study)?;
    if draft.key != first.key {
        return Err(CliError::Refused(format!(
            "{}: is another scene than that of the parts, or has other values of --set",
            study.file
        )));
    }
    let mut whole = first.clone();
    whole.shard = None;
    whole.partial = parts.iter().any(|(_, _, record)| record.partial);
    whole.candidates = parts
        .iter()
        .flat_map(|(_, _, record)| record.candidates.iter().cloned())
        .collect();
    Ok((study, whole))
}

/// Candidates with what follows from them.
pub(super) struct StudyResult {
    pub(super) all: Vec<Appraisal>,
    /// Numbers in `all`, from 0.
    pub(super) front: Vec<usize>,
    pub(super) best: Option<usize>,
}

impl StudyResult {
    pub(super) fn of(record: &StudyRecord) -> Self {
        let all = record.appraisals();
        let front = front(&all, &record.objectives);
        let best = best(&all, &record.objectives);
        Self { all, front, best }
    }
}

/// Arguments that make a candidate of the scene.
pub(super) fn set_arguments(study: &StudyScene, each: &Appraisal) -> Vec<String> {
    let settings = study.space.settings(&each.point);
    let set = |setting: &Setting| format!("{}={}", setting.key(), setting.value());
    settings.iter().map(set).collect()
}
