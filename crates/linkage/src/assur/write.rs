//! Files of a solved linkage: the table and the figures.

use super::arm::{ArmBranch, SerialArm};
use super::description::Linkage;
use super::track::Track;
use super::{draw, table};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use trirrr_figures::canvas::Drawn;

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
    let table = ("linkage.csv", Ok(table::csv(linkage, track)));
    save(
        folder,
        std::iter::once(table).chain(draw::figures(linkage, track)),
    )
}

/// Writes the table `inverse.csv` and a figure of both solutions into `folder`, which is made if missing, and returns the files.
///
/// # Errors
/// [`WriteError`] for the first file that cannot be written.
pub fn write_inverse(
    linkage: &Linkage,
    arm: &SerialArm,
    branches: &[ArmBranch; 2],
    folder: &Path,
) -> Result<Vec<PathBuf>, WriteError> {
    let positions = branches.each_ref().map(|branch| branch.position.clone());
    let track = Track {
        positions: positions.into(),
        stop: None,
        closure: 0.0,
        nearest: Vec::new(),
    };
    let table = (
        "inverse.csv",
        Ok(table::inverse_csv(linkage, arm, branches)),
    );
    let figure = ("inverse.svg", draw::inverse(linkage, &track));
    save(folder, [table, figure].into_iter())
}

fn save(
    folder: &Path,
    drawn: impl Iterator<Item = (&'static str, Drawn)>,
) -> Result<Vec<PathBuf>, WriteError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        |source| WriteError { path, source }
    };
    std::fs::create_dir_all(folder).map_err(at(folder))?;
    let mut files = Vec::new();
    for (name, drawn) in drawn {
        let path = folder.join(name);
        drawn
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|text| std::fs::write(&path, text))
            .map_err(at(&path))?;
        files.push(path);
    }
    Ok(files)
}
