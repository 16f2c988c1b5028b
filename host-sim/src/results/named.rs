//! Files that the user names, as `--out FILE` and `--figure FILE`.
//!
//! The rule is that of folders. What earlier commands wrote stands in a hidden file beside them: nobody looks for a `result.json` there.

use super::disk::{self, ContentHash};
use super::refusal::{OwnFiles, refuse_obstacles};
use super::sealed::{self, Sealed, hash_of, hex};
use crate::failure::CliError;
use serde_json::{Value, json};
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use trirrr_scene::read::files::was_read;

/// File with the hashes of named files in its folder, by command and name.
const RECORD: &str = ".trirrr.json";

/// Way out for a file that is not replaced.
const AWAY: &str = "give another name, or move it away yourself";

/// Record of the named files of one folder.
struct NamedRecord {
    path: PathBuf,
    /// None: what lies there is no record, and stays.
    value: Option<Value>,
}

impl NamedRecord {
    fn beside(file: &Path) -> Result<Self, CliError> {
        let path = file.with_file_name(RECORD);
        let value = match sealed::read(&path)? {
            Sealed::Missing => Some(json!({})),
            Sealed::Whole(value) => Some(value),
            Sealed::Damaged => None,
        };
        Ok(Self { path, value })
    }

    fn own(&self, command: &str) -> OwnFiles {
        let files = self.value.as_ref().map(|value| &value[command]);
        let files = files.and_then(Value::as_object).into_iter().flatten();
        let hash = |(name, hash): (&String, &Value)| (name.clone(), hash_of(hash));
        files.map(hash).collect()
    }

    /// Takes note of a file that was written. Without the note it is not replaced next time.
    fn note(&mut self, command: &str, file: &Path) {
        let name = file.file_name().and_then(|name| name.to_str());
        let hash = ContentHash::of_file(file).ok();
        if let (Some(value), Some(name), Some(hash)) = (&mut self.value, name, hash) {
            value[command][name] = hex(hash).into();
            // A folder in which nothing can be made: the file itself stands.
            let _ = sealed::write(&self.path, value);
        }
    }
}

/// Refuses `files` that the command is not to replace. An empty file has nothing to lose: `mktemp` makes one.
fn refuse(record: &NamedRecord, command: &str, files: &[&Path]) -> Result<(), CliError> {
    let is_empty = |path: &Path| {
        let file = path.symlink_metadata();
        file.is_ok_and(|file| file.is_file() && file.len() == 0) && !was_read(path)
    };
    let filled = files.iter().copied().filter(|path| !is_empty(path));
    refuse_obstacles(filled, command, &record.own(command), AWAY)
}

/// Writes the files of `trirrr COMMAND`, all or none of them.
///
/// # Errors
/// Refused: one is there and is not to be replaced. Failed: one cannot be written.
pub(crate) fn write_named(command: &str, files: &[(PathBuf, String)]) -> Result<(), CliError> {
    for (path, _) in files {
        refuse(&NamedRecord::beside(path)?, command, &[path])?;
    }
    for (path, content) in files {
        disk::put(path, content.as_bytes())?;
        NamedRecord::beside(path)?.note(command, path);
    }
    Ok(())
}

/// Writes files anew that the user names to be changed in place: the one exception from the rule, for the documents of this project.
///
/// # Errors
/// Failed: one cannot be written; it is as before then.
pub(crate) fn refresh<'c>(
    files: impl Iterator<Item = (PathBuf, &'c [u8])>,
) -> Result<(), CliError> {
    for (path, content) in files {
        disk::make_folder(path.parent().unwrap_or(Path::new("")))?;
        disk::put(&path, content)?;
    }
    Ok(())
}

/// Lets `write` write the file of `trirrr COMMAND` in the place of `path`.
///
/// The earlier file stays until the new one is complete, and where `write` refuses. Where `write` fails, the earlier file goes, and what
/// was written is `path` with `.partial` behind it. What is no file, such as a pipe, is written as it is.
///
/// # Errors
/// Those of `write`. Refused: a file is there that is not to be replaced. Failed: the file cannot be written.
pub(crate) fn replace<T>(
    command: &str,
    path: &Path,
    write: impl FnOnce(File) -> Result<T, CliError>,
) -> Result<T, CliError> {
    if path.exists() && !path.is_file() && !path.is_dir() {
        return write(disk::open_stream(path)?);
    }
    let mut partial = path.to_owned().into_os_string();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let folder = path.parent().unwrap_or(Path::new(""));
    if folder != Path::new("") && !folder.is_dir() {
        return Err(disk::unwritable(path, &ErrorKind::NotFound.into()));
    }
    let mut record = NamedRecord::beside(path)?;
    refuse(&record, command, &[path, &partial])?;
    disk::remove(&partial)?;
    let result = write(disk::make(&partial)?);
    if let Err(CliError::Refused(_) | CliError::OtherNumbers { .. }) = &result {
        disk::remove(&partial)?;
        return result;
    }
    // Time has passed.
    refuse(&record, command, &[path])?;
    match &result {
        Ok(_) => disk::rename(&partial, path)?,
        Err(_) => disk::remove(path)?,
    }
    record.note(command, if result.is_ok() { path } else { &partial });
    result
}
