//! Files that commands write, and the one rule for all of them.
//!
//! A path that a command has read is never written or removed. Of the files that are there, a command replaces or removes those that an
//! earlier run of the same command wrote, and nobody has changed since: `result.json` has their hashes. Any other file of which it needs
//! the name is refused before anything is touched. No other module of this package makes, writes or removes a file.

mod disk;
mod named;
#[cfg(feature = "full")]
mod png;
mod refusal;
pub(crate) mod sealed;

pub(crate) use disk::{remove as remove_own, unwritable, write_new};
pub(crate) use named::{refresh, replace, write_named};

use crate::failure::CliError;
use disk::ContentHash;
#[cfg(feature = "full")]
use png::drawn_pictures;
use refusal::{OwnFiles, obstacle, refuse_obstacles};
use sealed::{Sealed, hash_of, hex};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::canvas::Drawn;

/// Name of the file that says what the folder holds.
const RESULT: &str = "result.json";

/// Table that is filled before the first result, under another name.
struct WaitingTable {
    name: &'static str,
    path: PathBuf,
}

/// Folder of results of one command.
///
/// The results of an earlier run stay until this one [begins](Self::begin). From then on the folder holds results of this run alone, beside
/// files of others, and `result.json` says `partial` until the command is complete.
pub struct ResultFolder {
    folder: PathBuf,
    command: &'static str,
    /// Files of the earlier run that are still there.
    earlier: OwnFiles,
    kept: &'static [&'static str],
    with_pictures: bool,
    /// Names that this run may write.
    claimed: BTreeSet<String>,
    waiting: Vec<WaitingTable>,
    /// Files that are written when the command begins.
    pending: Vec<(String, Vec<u8>)>,
    /// Files of this run; a table under way has no hash.
    written: Vec<(String, Option<ContentHash>)>,
    /// Folders that were not there before, the innermost first.
    made: Vec<PathBuf>,
    has_begun: bool,
    /// Reason why the results are not complete; empty while the command goes on.
    reason: String,
}

impl ResultFolder {
    /// Takes `folder` for the results of `trirrr COMMAND`. Nothing is written before there is something to write.
    ///
    /// # Errors
    /// Refused: the folder holds the results of another command or of an older version. Failed: it is no folder.
    pub fn for_command(folder: &Path, command: &'static str) -> Result<Self, CliError> {
        let path = folder.join(RESULT);
        let refused = |path: &Path, reason: &str| {
            let name = path.display();
            CliError::Refused(format!("{name}: {reason}; {AWAY}"))
        };
        if folder.exists() && !folder.is_dir() {
            return Err(unwritable(folder, &io::ErrorKind::NotADirectory.into()));
        }
        let earlier = match sealed::read(&path)? {
            Sealed::Missing => OwnFiles::new(),
            Sealed::Whole(result) => match result["command"].as_str() {
                Some(other) if other != command => {
                    let reason = format!("the folder has the results of `trirrr {other}`");
                    return Err(refused(&path, &reason));
                }
                _ => files_of(&result),
            },
            Sealed::Damaged => {
                let reason =
                    "is changed, or of an older version, and does not tell which results may go";
                return Err(refused(&path, reason));
            }
        };
        if trirrr_scene::read::files::was_read(&path) {
            return Err(refused(&path, "this command reads it"));
        }
        Ok(Self {
            folder: folder.into(),
            command,
            earlier,
            kept: &[],
            with_pictures: false,
            claimed: BTreeSet::new(),
            waiting: Vec::new(),
            pending: Vec::new(),
            written: Vec::new(),
            made: Vec::new(),
            has_begun: false,
            reason: String::new(),
        })
    }

    /// Draws each figure as PNG, too, if `asked`.
    #[must_use]
    pub fn with_pictures(mut self, asked: bool) -> Self {
        self.with_pictures = asked;
        self
    }

    /// Keeps earlier files of these names, which this run does not write.
    #[must_use]
    pub fn keeping(mut self, names: &'static [&'static str]) -> Self {
        self.kept = names;
        self
    }

    /// Claims names that this run may write: what stands in the way is said before the work begins.
    ///
    /// # Errors
    /// Refused: a file of such a name is there that is not to be replaced.
    pub fn claim<T: AsRef<str>>(
        &mut self,
        names: impl IntoIterator<Item = T>,
    ) -> Result<(), CliError> {
        let mut new: Vec<String> = Vec::new();
        for name in names {
            let name = name.as_ref();
            new.push(name.into());
            if let Some(stem) = name.strip_suffix(".svg").filter(|_| self.with_pictures) {
                new.push(format!("{stem}.png"));
            }
        }
        let paths: Vec<PathBuf> = new.iter().map(|name| self.folder.join(name)).collect();
        let paths = paths.iter().map(PathBuf::as_path);
        refuse_obstacles(paths, self.command, &self.earlier, AWAY)?;
        self.claimed.extend(new);
        Ok(())
    }

    /// Returns `true` if there is a result.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Path of a file in the folder.
    pub fn path_of(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Files of this run, in order.
    pub fn files(&self) -> Vec<PathBuf> {
        let written = self.written.iter().map(|(name, _)| name);
        let pending = self.pending.iter().map(|(name, _)| name);
        let names = written.chain(pending);
        names.map(|name| self.folder.join(name)).collect()
    }

    /// Makes the table `name`, which bears another name until [`begin`](Self::begin). Returns its path and the file.
    ///
    /// # Errors
    /// Refused: as [`claim`](Self::claim). Failed: the table cannot be written.
    pub fn table(&mut self, name: &'static str) -> Result<(PathBuf, File), CliError> {
        self.claim([name])?;
        let path = self.folder.join(name);
        if self.has_begun {
            let file = disk::make(&path)?;
            self.written.push((name.into(), None));
            return Ok((path, file));
        }
        self.make_folder()?;
        let waiting = disk::free_name(&path, "waiting");
        let file = disk::make(&waiting)?;
        self.waiting.push(WaitingTable {
            name,
            path: waiting,
        });
        Ok((path, file))
    }

    /// Writes the file `name`, and returns its path. Before the command has begun the file waits in memory.
    ///
    /// # Errors
    /// Refused: a file of this name is there. Failed: the file cannot be written.
    pub fn write(&mut self, name: &str, content: impl Into<Vec<u8>>) -> Result<PathBuf, CliError> {
        let content = content.into();
        let path = self.folder.join(name);
        match self.has_begun {
            false => self.pending.push((name.into(), content)),
            true => {
                debug_assert!(self.claimed.contains(name), "{name} was not claimed");
                self.write_now(name, &content)?;
            }
        }
        Ok(path)
    }

    /// Writes the figure `name`, as [`write`](Self::write).
    ///
    /// # Errors
    /// As there. Failed: it cannot be drawn.
    pub fn figure(&mut self, name: &str, drawn: Drawn) -> Result<PathBuf, CliError> {
        let svg = drawn.map_err(|error| {
            unwritable(
                &self.folder.join(name),
                &io::Error::other(error.to_string()),
            )
        })?;
        self.write(name, svg)
    }

    fn write_now(&mut self, name: &str, content: &[u8]) -> Result<(), CliError> {
        write_new(&self.folder.join(name), content)?;
        let hash = ContentHash::of_bytes(content);
        self.written.push((name.into(), Some(hash)));
        self.say("partial")
    }

    fn make_folder(&mut self) -> Result<(), CliError> {
        let made = disk::make_folder(&self.folder)?;
        self.made.extend(made);
        Ok(())
    }

    /// There is a result: removes those of the earlier run that nobody has changed or read, gives the tables their names and writes what
    /// waits. Does nothing the second time.
    ///
    /// # Errors
    /// Refused: as [`claim`](Self::claim), before anything is touched. Failed: something cannot be removed or written.
    pub fn begin(&mut self) -> Result<(), CliError> {
        if self.has_begun {
            return Ok(());
        }
        let pending = std::mem::take(&mut self.pending);
        let names: Vec<&str> = pending.iter().map(|(name, _)| name.as_str()).collect();
        // Those of before once more: time has passed.
        let again = std::mem::take(&mut self.claimed);
        let claimed = self.claim(again.iter().map(String::as_str).chain(names));
        if let Err(refusal) = claimed {
            self.pending = pending;
            return Err(refusal);
        }
        self.make_folder()?;
        // From here on a crash leaves nothing of which `result.json` does not know.
        let tables = self.waiting.iter().map(|table| (table.name.into(), None));
        self.written = tables.collect();
        self.has_begun = true;
        self.say("partial")?;
        let mut earlier = std::mem::take(&mut self.earlier);
        let own = earlier.clone();
        for (name, hash) in own
            .iter()
            .filter(|(name, _)| !self.kept.contains(&name.as_str()))
        {
            let path = self.folder.join(name);
            // The user's from now on, where it was changed.
            match obstacle(&path, self.command, &own) {
                None if hash.is_none() => disk::put_aside(&path)?,
                None => disk::remove(&path)?,
                Some(_) => {}
            }
            earlier.remove(name);
        }
        self.earlier = earlier;
        for WaitingTable { name, path } in std::mem::take(&mut self.waiting) {
            disk::rename(&path, &self.folder.join(name))?;
        }
        for (name, content) in pending {
            self.write_now(&name, &content)?;
        }
        self.say("partial")
    }

    /// Draws the figures of this run as PNG, too, if that is asked for; returns the files. Those that are drawn already are left out.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn pictures(&mut self) -> Result<Vec<PathBuf>, CliError> {
        let mut figures: Vec<(String, Vec<u8>)> = Vec::new();
        if self.with_pictures {
            let names: BTreeSet<String> = self.names().map(str::to_owned).collect();
            for name in &names {
                let Some(stem) = name.strip_suffix(".svg") else {
                    continue;
                };
                let picture = format!("{stem}.png");
                if !names.contains(&picture) {
                    figures.push((picture, self.content_of(name)?));
                }
            }
        }
        let drawn = drawn_pictures(&figures);
        let mut files = Vec::new();
        for ((name, _), bytes) in figures.iter().zip(drawn) {
            let bytes = bytes.map_err(|error| unwritable(&self.folder.join(name), &error))?;
            files.push(self.write(name, bytes)?);
        }
        Ok(files)
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        let written = self.written.iter().map(|(name, _)| name.as_str());
        written.chain(self.pending.iter().map(|(name, _)| name.as_str()))
    }

    fn content_of(&self, name: &str) -> Result<Vec<u8>, CliError> {
        let path = self.folder.join(name);
        match self.pending.iter().find(|(pending, _)| pending == name) {
            Some((_, content)) => Ok(content.clone()),
            None => disk::own_text(&path).map_err(|error| unwritable(&path, &error)),
        }
    }

    /// Ends the results, which are complete without a `reason` why not. Without a result nothing is written.
    ///
    /// # Errors
    /// As [`begin`](Self::begin).
    pub fn end(&mut self, reason: Option<&str>) -> Result<(), CliError> {
        if !self.pending.is_empty() {
            self.begin()?;
        }
        if !self.has_begun {
            return Ok(());
        }
        for (name, hash) in &mut self.written {
            if hash.is_none() {
                let path = self.folder.join(name);
                let found = ContentHash::of_file(&path);
                *hash = Some(found.map_err(|error| unwritable(&path, &error))?);
            }
        }
        self.reason = reason.unwrap_or_default().into();
        self.say(if reason.is_none() {
            "complete"
        } else {
            "partial"
        })
    }

    fn say(&self, status: &str) -> Result<(), CliError> {
        let names: Vec<&str> = self.written.iter().map(|(name, _)| name.as_str()).collect();
        let own = self.earlier.iter().map(|(name, hash)| (name, *hash));
        let own = own.chain(self.written.iter().map(|(name, hash)| (name, *hash)));
        let hashes = own.map(|(name, hash)| (name.clone(), hash.map(hex).into()));
        let result = json!({
            "command": self.command,
            "status": status,
            "reason": self.reason,
            "files": names,
            "hashes": hashes.collect::<serde_json::Map<String, Value>>(),
        });
        sealed::write(&self.folder.join(RESULT), &result)
    }
}

/// Way out for files in a folder of results.
const AWAY: &str = "give --out another folder, or move it away yourself";

/// Files of a run by its `result.json`.
fn files_of(result: &Value) -> OwnFiles {
    let hashes = result["hashes"].as_object().into_iter().flatten();
    // A name alone: nothing outside the folder goes.
    let names = hashes.filter(|(name, _)| Path::new(name).file_name() == Some(name.as_ref()));
    names
        .map(|(name, hash)| (name.clone(), hash_of(hash)))
        .collect()
}

/// No picture: [`PictureArgs`](crate::pictures::PictureArgs) leave them to `trirrr-full`.
#[cfg(not(feature = "full"))]
fn drawn_pictures(_: &[(String, Vec<u8>)]) -> Vec<io::Result<Vec<u8>>> {
    Vec::new()
}

impl Drop for ResultFolder {
    /// Leaves nothing of a command without a result.
    fn drop(&mut self) {
        if self.has_begun {
            return;
        }
        // What cannot be removed is not taken for a result.
        for table in &self.waiting {
            let _ = disk::remove(&table.path);
        }
        self.made
            .iter()
            .for_each(|folder| disk::remove_empty_folder(folder));
    }
}
