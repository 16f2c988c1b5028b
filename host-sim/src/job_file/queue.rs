//! Jobs that are played one after the other.

use super::{JobFileArgs, LoadedJob, LongMoves, load};
use crate::failure::CliError;
use std::path::{Path, PathBuf};

/// Job that waits for its turn, and the folder for its results.
pub(crate) struct QueuedJob {
    pub(crate) file: PathBuf,
    pub(crate) job: LoadedJob,
    pub(crate) folder: PathBuf,
}

/// Reads and plans `first` and the jobs `then` behind it: what is wrong with one is known before another one is played.
/// Results go into `out`, of several jobs each into a folder in it; by default into
/// `out/NAME` with `ending`, which is that of the command.
///
/// # Errors
/// Refused: one of them as [`load`] refuses it, or two that would write into one folder.
pub(crate) fn load_queue(
    first: &Path,
    then: &[PathBuf],
    args: &JobFileArgs,
    moves: LongMoves,
    out: Option<&Path>,
    ending: &str,
) -> Result<Vec<QueuedJob>, CliError> {
    let mut jobs: Vec<QueuedJob> = Vec::new();
    for file in std::iter::once(first).chain(then.iter().map(PathBuf::as_path)) {
        let job = load(file, args, moves)?;
        let name = &job.scene.name;
        let folder = match out {
            Some(folder) if then.is_empty() => folder.to_owned(),
            Some(folder) => folder.join(name),
            None => Path::new("out").join(format!("{name}{ending}")),
        };
        if let Some(other) = jobs.iter().find(|other| other.folder == folder) {
            return Err(CliError::Refused(format!(
                "{} and {}: the results of both would go into {}; rename one, or use --repeat",
                other.file.display(),
                file.display(),
                folder.display()
            )));
        }
        jobs.push(QueuedJob {
            file: file.to_owned(),
            job,
            folder,
        });
    }
    Ok(jobs)
}
