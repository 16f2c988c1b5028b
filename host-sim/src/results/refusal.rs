//! The rule: which files may be replaced or removed, and why others may not.

use super::disk::{ContentHash, unwritable};
use crate::failure::CliError;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use trirrr_scene::read::files::was_read;

/// Files that earlier runs of one command wrote, by name. No hash: the command did not come to the end of the file, and who takes its name
/// puts it [aside](super::disk::put_aside).
pub(super) type OwnFiles = BTreeMap<String, Option<ContentHash>>;

/// Refusal of a file that is there, for a command that replaces nothing.
pub(super) fn is_there(path: &Path) -> CliError {
    CliError::Refused(format!(
        "{}: is there already, and stays; give another name",
        path.display()
    ))
}

/// Reason why `path` is neither replaced nor removed by `trirrr COMMAND`, of which `own` are the earlier files; none where the file is
/// missing, or one of them without a change.
pub(super) fn obstacle(path: &Path, command: &str, own: &OwnFiles) -> Option<String> {
    let file = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return None,
        Err(error) => return Some(error.to_string()),
        Ok(file) => file,
    };
    if was_read(path) {
        return Some("this command reads it, and replaces nothing that it reads".into());
    }
    let name = path.file_name().and_then(|name| name.to_str());
    match name.and_then(|name| own.get(name)) {
        None => Some(format!("is there already, and not from `trirrr {command}`")),
        // Of a program that was killed. It is put aside, not removed: nobody knows whether it was changed.
        Some(None) if file.is_file() => None,
        Some(hash) => {
            let found = ContentHash::of_file(path).ok();
            let is_same = file.is_file() && found.is_some() && found == *hash;
            (!is_same).then(|| format!("was changed since `trirrr {command}` wrote it"))
        }
    }
}

/// Refuses `paths`, each in a line of its own with its [`obstacle`]. `way` says what helps.
///
/// # Errors
/// Refused: there is an obstacle. Failed: a folder has the name.
pub(super) fn refuse_obstacles<'p>(
    paths: impl Iterator<Item = &'p Path> + Clone,
    command: &str,
    own: &OwnFiles,
    way: &str,
) -> Result<(), CliError> {
    if let Some(folder) = paths.clone().find(|path| path.is_dir()) {
        return Err(unwritable(folder, &ErrorKind::IsADirectory.into()));
    }
    let line = |path: &Path| {
        let reason = obstacle(path, command, own)?;
        Some(format!("{}: {reason}; {way}", path.display()))
    };
    let lines: Vec<String> = paths.filter_map(line).collect();
    match lines.is_empty() {
        true => Ok(()),
        false => Err(CliError::Refused(lines.join("\n"))),
    }
}
