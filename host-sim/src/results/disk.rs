//! The only place of this package that changes files.
//!
//! A file is made under a name that is free, or takes the place of one that the callers of this module know as their own.

#![allow(clippy::disallowed_methods)]

use super::refusal::is_there;
use crate::failure::CliError;
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// `path: cannot be written: why`.
pub(crate) fn unwritable(path: &Path, error: &io::Error) -> CliError {
    CliError::Failed(format!("{}: cannot be written: {error}", path.display()))
}

/// Hash of the content of a file: FNV-1a, 64 bits. It tells a file that was changed, not one that was forged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ContentHash(pub(super) u64);

impl ContentHash {
    pub(super) fn of_bytes(bytes: &[u8]) -> Self {
        Self(0xcbf2_9ce4_8422_2325).then(bytes)
    }

    fn then(self, bytes: &[u8]) -> Self {
        let fold = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self(bytes.iter().fold(self.0, fold))
    }

    pub(super) fn of_file(path: &Path) -> io::Result<Self> {
        let mut file = BufReader::new(File::open(path)?);
        let (mut hash, mut block) = (Self::of_bytes(b""), vec![0; 1 << 16]);
        loop {
            match file.read(&mut block)? {
                0 => return Ok(hash),
                count => hash = hash.then(&block[..count]),
            }
        }
    }
}

/// Text of a file that this program keeps for itself: it is no input of the user.
pub(super) fn own_text(path: &Path) -> io::Result<Vec<u8>> {
    fs::read(path)
}

/// Makes `folder`, and returns the folders that were missing, the innermost first.
pub(super) fn make_folder(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let all = folder.ancestors().filter(|part| *part != Path::new(""));
    let missing: Vec<PathBuf> = all
        .take_while(|part| !part.exists())
        .map(Path::to_owned)
        .collect();
    fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    Ok(missing)
}

/// Removes a folder that is empty.
pub(super) fn remove_empty_folder(folder: &Path) {
    // One that is not empty stays.
    let _ = fs::remove_dir(folder);
}

/// Makes a file that is not there yet.
///
/// # Errors
/// Refused: it is there. Failed: it cannot be made.
pub(super) fn make(path: &Path) -> Result<File, CliError> {
    File::create_new(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => is_there(path),
        _ => unwritable(path, &error),
    })
}

/// Writes a file that is not there yet. One that cannot be written whole is removed.
///
/// # Errors
/// As [`make`].
pub(crate) fn write_new(path: &Path, content: &[u8]) -> Result<(), CliError> {
    let mut file = make(path)?;
    file.write_all(content).map_err(|error| {
        remove(path).err();
        unwritable(path, &error)
    })
}

/// Puts a new file in the place of `path`, which is the caller's own or missing. A crash leaves the old file or the new one.
///
/// # Errors
/// Failed: it cannot be written; the old file is there then.
pub(super) fn put(path: &Path, content: &[u8]) -> Result<(), CliError> {
    let new = free_name(path, "new");
    write_new(&new, content)?;
    rename(&new, path).inspect_err(|_| {
        remove(&new).err();
    })
}

/// Name beside `path` that is free, and that no other program takes.
pub(super) fn free_name(path: &Path, ending: &str) -> PathBuf {
    let name = |number: u32| {
        let mut name = path.as_os_str().to_owned();
        name.push(format!(".{ending}-{}-{number}", std::process::id()));
        PathBuf::from(name)
    };
    (1..)
        .map(name)
        .find(|path| !path.exists())
        .unwrap_or_else(|| name(0))
}

/// Gives a file another name.
pub(super) fn rename(from: &Path, to: &Path) -> Result<(), CliError> {
    fs::rename(from, to).map_err(|error| unwritable(to, &error))
}

/// Gives a file a name beside its own that is free, if it is there.
pub(super) fn put_aside(path: &Path) -> Result<(), CliError> {
    match path.exists() {
        true => rename(path, &free_name(path, "unfinished")),
        false => Ok(()),
    }
}

/// Removes a file; one that is missing is removed already.
pub(crate) fn remove(path: &Path) -> Result<(), CliError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(unwritable(path, &error)),
        _ => Ok(()),
    }
}

/// Opens a pipe or a device to write into it.
pub(super) fn open_stream(path: &Path) -> Result<File, CliError> {
    let opened = File::options().write(true).open(path);
    opened.map_err(|error| unwritable(path, &error))
}
