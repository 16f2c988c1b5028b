//! Files of a solved linkage: the table and the figures.

use super::description::Linkage;
use super::track::Track;
use super::{draw, table};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file that cannot be drawn or written.
#[derive(Debug, Error)]
#[error("{}: {source}", path.display())]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// The reason.
    pub source: io::Error,
}

/// Writes the table `linkage.csv` and the figures into `folder`, which is made if missing, and
/// returns the files. The track must have a position.
///
/// # Errors
/// [`WriteError`] for the first file that cannot be written.
pub fn write(linkage: &Linkage, track: &Track, folder: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        |source| WriteError { path, source }
    };
    std::fs::create_dir_all(folder).map_err(at(folder))?;
    let table = ("linkage.csv", Ok(table::csv(linkage, track)));
    let mut files = Vec::new();
    for (name, drawn) in std::iter::once(table).chain(draw::figures(linkage, track)) {
        let path = folder.join(name);
        drawn
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|text| std::fs::write(&path, text))
            .map_err(at(&path))?;
        files.push(path);
    }
    Ok(files)
}
