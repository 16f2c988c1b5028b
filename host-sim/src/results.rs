//! Results of a command in a folder or a file, and the one rule for them.
//!
//! The results of an earlier command stay until this one has its first result: a command that is
//! refused, or a board that does not start, loses nothing. From then on the folder holds results of
//! this command alone, and `result.json` says `partial` until the command is complete.

use crate::failure::CliError;
use crate::recording::unwritable;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Name of the file that says what the folder holds.
const RESULT: &str = "result.json";

/// Tables of any command. Folders of versions without a [`RESULT`] hold them too.
const TABLES: [&str; 6] = [
    "ticks.csv",
    "drives.csv",
    "plant.csv",
    "tolerances.csv",
    "tolerance_budget.csv",
    "linkage.csv",
];

/// Ending of a table that waits for the first result.
const WAITING: &str = "waiting";

/// Folder of results, of which earlier ones go when this command begins.
pub struct ResultFolder {
    folder: PathBuf,
    command: &'static str,
    /// The folder was not there before.
    is_new: bool,
    /// Tables under way, by name.
    tables: Vec<&'static str>,
    has_begun: bool,
}

impl ResultFolder {
    /// Makes `folder` if it is missing. `command` is the command's name.
    ///
    /// # Errors
    /// Failed: the folder cannot be made.
    pub fn create(folder: &Path, command: &'static str) -> Result<Self, CliError> {
        let is_new = !folder.exists();
        fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
        Ok(Self {
            folder: folder.into(),
            command,
            is_new,
            tables: Vec::new(),
            has_begun: false,
        })
    }

    /// The folder in which this command has [ended](Self::end) results already, to add more.
    pub fn reopen(folder: &Path, command: &'static str) -> Self {
        Self {
            folder: folder.into(),
            command,
            is_new: false,
            tables: Vec::new(),
            has_begun: true,
        }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Returns `true` if there is a result.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Makes the table `name`, which bears another name until [`begin`](Self::begin). Returns its path
    /// and the file.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub fn table(&mut self, name: &'static str) -> Result<(PathBuf, File), CliError> {
        let path = self.folder.join(name);
        if path.is_dir() {
            return Err(unwritable(&path, &io::ErrorKind::IsADirectory.into()));
        }
        let waiting = self.waiting(name);
        let file = File::create(&waiting).map_err(|error| unwritable(&waiting, &error))?;
        self.tables.push(name);
        Ok((path, file))
    }

    fn waiting(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.{WAITING}"))
    }

    /// There is a result: removes those of the earlier command, and gives the tables their names. Does
    /// nothing the second time.
    ///
    /// # Errors
    /// Failed: something cannot be removed or written.
    pub fn begin(&mut self) -> Result<(), CliError> {
        if self.has_begun {
            return Ok(());
        }
        for name in self.earlier() {
            let path = self.folder.join(name);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(unwritable(&path, &error));
                }
                _ => {}
            }
        }
        for name in &self.tables {
            let path = self.folder.join(name);
            fs::rename(self.waiting(name), &path).map_err(|error| unwritable(&path, &error))?;
        }
        self.has_begun = true;
        self.say("partial", "", &self.tables)
    }

    /// Names of the files of the earlier command.
    fn earlier(&self) -> Vec<String> {
        let text = fs::read_to_string(self.folder.join(RESULT)).unwrap_or_default();
        let result: Value = serde_json::from_str(&text).unwrap_or_default();
        let files = result["files"].as_array().into_iter().flatten();
        // A name alone: whoever wrote the file, nothing outside the folder goes.
        let names = files.filter_map(Value::as_str);
        let names = names.filter(|name| Path::new(name).file_name() == Some(name.as_ref()));
        names.chain(TABLES).map(str::to_owned).collect()
    }

    /// Ends the results: `files` are written, and `end` says why they are not complete. Without a
    /// result nothing is written.
    ///
    /// # Errors
    /// Failed: `result.json` cannot be written.
    pub fn end(&self, files: &[PathBuf], end: Result<(), &str>) -> Result<(), CliError> {
        if !self.has_begun {
            return Ok(());
        }
        let names = files.iter().filter_map(|file| file.file_name()?.to_str());
        let names: Vec<&str> = names.collect();
        match end {
            Ok(()) => self.say("complete", "", &names),
            Err(reason) => self.say("partial", reason, &names),
        }
    }

    fn say(&self, status: &str, reason: &str, files: &[&str]) -> Result<(), CliError> {
        let path = self.folder.join(RESULT);
        let result = json!({
            "command": self.command,
            "status": status,
            "reason": reason,
            "files": files,
        });
        fs::write(&path, format!("{result:#}\n")).map_err(|error| unwritable(&path, &error))
    }
}

/// Writes the file `name` into `folder`, and returns its path.
///
/// # Errors
/// Failed: the file cannot be written.
pub(crate) fn write_text(folder: &Path, name: &str, text: &str) -> Result<PathBuf, CliError> {
    let path = folder.join(name);
    fs::write(&path, text).map_err(|error| unwritable(&path, &error))?;
    Ok(path)
}

/// Lets `write` write a new file in the place of `path`.
///
/// The earlier file stays until the new one is complete, and where `write` refuses. Where `write` fails,
/// the earlier file goes, and what was written is `path` with `.partial` behind it. What is no file, such
/// as a pipe, is written as it is.
///
/// # Errors
/// Those of `write`. Failed: the file cannot be written.
pub fn replace<T>(
    path: &Path,
    write: impl FnOnce(File) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let failed = |error: io::Error| unwritable(path, &error);
    if path.exists() && !path.is_file() {
        return write(File::options().write(true).open(path).map_err(failed)?);
    }
    // The file itself, where the path is a link to it.
    let path = &path.canonicalize().unwrap_or_else(|_| path.into());
    let mut partial = path.clone().into_os_string();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let result = write(File::create(&partial).map_err(failed)?);
    match &result {
        Ok(_) => fs::rename(&partial, path).map_err(failed)?,
        Err(CliError::Refused(_) | CliError::OtherNumbers { .. }) => {
            fs::remove_file(&partial).map_err(failed)?
        }
        Err(CliError::Failed(_)) if path.exists() => fs::remove_file(path).map_err(failed)?,
        Err(CliError::Failed(_)) => {}
    }
    result
}

impl Drop for ResultFolder {
    /// Leaves nothing of a command without a result.
    fn drop(&mut self) {
        if self.has_begun {
            return;
        }
        // What cannot be removed is not taken for a result.
        for name in &self.tables {
            let _ = fs::remove_file(self.waiting(name));
        }
        if self.is_new {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}
