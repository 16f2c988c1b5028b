//! The command: reads, follows, writes, reports.

use super::description::Linkage;
use super::track::{Track, track};
use super::{draw, report, table};
use crate::cli::LinkageArgs;
use crate::failure::Failure;
use std::io;
use std::path::{Path, PathBuf};

/// `host-sim linkage`: reads the file, follows the linkage over its motion, writes the table and
/// the figures, prints the groups and a summary.
///
/// # Errors
/// Refused: the file. Failed: something cannot be written, or the motion has an end; what there is
/// until then is written.
pub fn command(args: &LinkageArgs) -> Result<(), Failure> {
    let mut linkage =
        Linkage::read(&args.file).map_err(|error| Failure::Refused(error.to_string()))?;
    if let Some(steps) = args.steps {
        linkage.motion.steps = steps;
    }
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&linkage.name),
    };
    let track = track(&linkage);
    let files = if track.positions.is_empty() {
        Vec::new()
    } else {
        write(&linkage, &track, &folder)?
    };
    let mut text = report::header(&args.file.display().to_string(), &linkage);
    text.push_str(&report::summary(&linkage, &track, &files));
    match io::Write::write_all(&mut io::stdout().lock(), text.as_bytes()) {
        // Who closes standard output early does not want the summary.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            return Err(Failure::Failed(format!("standard output: {error}")));
        }
        _ => {}
    }
    match &track.stop {
        Some(stop) => Err(Failure::Failed(report::stopped(&linkage, stop))),
        None => Ok(()),
    }
}

/// Writes the table `linkage.csv` and the figures into `folder`, which is made if it is missing.
/// Returns the files written. The track must have a position.
///
/// # Errors
/// Failed: the file that cannot be written, and why.
pub fn write(linkage: &Linkage, track: &Track, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::Failed(format!("{}: {error}", path.display()))
    };
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
    let mut files = Vec::new();
    let mut save = |name: &str, text: String| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| failed(&path, &error))?;
        files.push(path);
        Ok(())
    };
    save("linkage.csv", table::csv(linkage, track))?;
    for (name, drawn) in draw::figures(linkage, track) {
        save(
            name,
            drawn.map_err(|error| failed(&folder.join(name), &error))?,
        )?;
    }
    Ok(files)
}
