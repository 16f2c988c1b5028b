//! Journal of a job: a small file beside its results that says how far the machine is. With it a later stream goes on where this one
//! was lost, on a machine that waits or on one that has lost the job.

use crate::failure::CliError;
use crate::results::remove_own;
use crate::results::sealed::{self, Sealed};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use trirrr_client::{JobClient, JobMark, JobPlace};
use trirrr_protocol::message::{JobLabel, Transmit};
use trirrr_scene::NumberType;

/// Name of the file.
const FILE: &str = "job.json";

/// Reason why a journal is of no use.
const DAMAGED: &str = "it is damaged, or of an older version: the place at which the job was left is not known; stream the job from its start, without --resume; `trirrr park` or --recover bring a machine back that stands in the middle of it";

/// Longest time that a crash of the host takes out of the journal.
const EVERY: Duration = Duration::from_millis(100);

/// Identity of a job: the scene, its number type, and what is offered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct JobKey {
    pub(super) scene: String,
    pub(super) number: String,
    pub(super) label: JobLabel,
}

/// Journal of one job, which is written as the job goes on.
pub(super) struct Journal {
    path: PathBuf,
    key: JobKey,
    mark: JobMark,
    written: Option<Instant>,
    /// Number of the first move, as it was written.
    first_move: Option<u32>,
}

impl Journal {
    /// Prepares the journal in `folder` of a job that goes on from `mark`. Nothing is written before the machine has answered.
    pub(super) fn new(folder: &Path, key: JobKey, mark: JobMark) -> Self {
        Self {
            path: folder.join(FILE),
            key,
            mark,
            written: None,
            first_move: None,
        }
    }

    /// Refuses a file in the place of the journal that is none, which a stream without `resume` would replace.
    ///
    /// # Errors
    /// Refused: as said.
    pub(super) fn refuse_other(folder: &Path, resume: bool) -> Result<(), CliError> {
        let path = folder.join(FILE);
        match sealed::read(&path)? {
            Sealed::Damaged if !resume => Err(CliError::Refused(format!(
                "{}: is no journal as `trirrr stream` writes it, and stays; give --out another folder, or move it away yourself",
                path.display()
            ))),
            _ => Ok(()),
        }
    }

    /// Returns the number type in which the job of the journal in `folder` was begun, if there is one that names it.
    pub(super) fn number(folder: &Path) -> Option<NumberType> {
        let Ok(Sealed::Whole(value)) = sealed::read(&folder.join(FILE)) else {
            return None;
        };
        let mut types = NumberType::ALL.into_iter();
        types.find(|number| value["number"] == number.name())
    }

    /// Reads the journal in `folder` of the job `key`.
    ///
    /// # Errors
    /// Refused: there is none, it is damaged, or it is of another job.
    pub(super) fn read(folder: &Path, key: &JobKey) -> Result<JobMark, CliError> {
        let path = folder.join(FILE);
        let refused = |why: &str| CliError::Refused(format!("{}: {why}", path.display()));
        let value = match sealed::read(&path)? {
            Sealed::Whole(value) => value,
            Sealed::Missing => {
                return Err(refused(
                    "there is no job to resume: the last stream into this folder was complete, or there was none",
                ));
            }
            Sealed::Damaged => return Err(refused(DAMAGED)),
        };
        let is_of_job = value["scene"] == key.scene.as_str()
            && value["number"] == key.number.as_str()
            && value["items"] == key.label.items
            && value["check"] == key.label.check;
        if !is_of_job {
            return Err(refused(
                "it is of another job: resume with the scene and the number type of the stream that was lost, or leave --resume out",
            ));
        }
        let number = |value: &Value| value.as_u64().and_then(|value| u32::try_from(value).ok());
        let place = |value: &Value| {
            Some(JobPlace {
                index: number(&value["index"])?,
                at: number(&value["at"])?,
            })
        };
        let entry = || {
            Some(JobMark {
                taken: number(&value["taken"])?,
                first_move: number(&value["first_move"]),
                from: place(&value["from"])?,
                reached: place(&value["reached"])?,
            })
        };
        entry().ok_or_else(|| refused(DAMAGED))
    }

    /// Takes in what `client` knows; `place` tells the place on the whole job.
    pub(super) fn take<N: Transmit>(
        &mut self,
        client: &JobClient<N>,
        place: &dyn Fn(JobPlace) -> JobPlace,
    ) {
        self.mark.note(client, place);
    }

    /// Place up to which the machine has played the job with its tool.
    pub(super) fn reached(&self) -> JobPlace {
        self.mark.reached
    }

    /// Writes what was taken in, now and then, at once where the machine has got the name of the job, or `now`. Nothing is written before the
    /// machine has answered.
    ///
    /// # Errors
    /// Failed: the file cannot be written.
    pub(super) fn note<N: Transmit>(
        &mut self,
        client: &JobClient<N>,
        now: bool,
    ) -> Result<(), CliError> {
        let is_due = self
            .written
            .is_none_or(|written| written.elapsed() >= EVERY);
        let JobMark {
            taken,
            first_move,
            from,
            reached,
        } = self.mark;
        let is_named = first_move != self.first_move;
        if client.status().is_none() || !(now || is_due || is_named) {
            return Ok(());
        }
        (self.written, self.first_move) = (Some(Instant::now()), first_move);
        let place = |place: JobPlace| json!({ "index": place.index, "at": place.at });
        let value = json!({
            "scene": self.key.scene,
            "number": self.key.number,
            "items": self.key.label.items,
            "check": self.key.label.check,
            "taken": taken,
            "first_move": first_move,
            "from": place(from),
            "reached": place(reached),
        });
        sealed::write(&self.path, &value).map_err(|error| {
            CliError::Failed(format!(
                "{error}; the machine comes to rest on its path and waits: make room, then --resume goes on"
            ))
        })
    }

    /// Removes the journal of a job that is complete.
    pub(super) fn end(&self) {
        // One that stays is refused by the machine: it has played all moves.
        let _ = remove_own(&self.path);
    }
}
