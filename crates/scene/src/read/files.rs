//! Files that the program reads: bounded in length, text in any encoding of Unicode, and remembered.
//!
//! A program that writes files asks [`was_read`] first: what the user gave it to read is never replaced or removed.

use std::collections::HashMap;
use std::fs::{self, File, Metadata};
use std::io::{self, Error, ErrorKind, Read, stdin};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Path that stands for standard input.
const STANDARD_INPUT: &str = "-";

/// Most bytes of a scene, a linkage or a board file: a hundred thousand moves.
pub const LONGEST_SCENE: u64 = 16 << 20;

/// Most bytes of the file of a machine.
pub const LONGEST_MACHINE: u64 = 1 << 20;

/// Most bytes of a table, a drawing or an image.
pub const LONGEST_TABLE: u64 = 1 << 30;

/// Most bytes of what is no regular file, such as a pipe: nobody knows its length before.
const LONGEST_STREAM: u64 = 64 << 20;

/// Files that this program has read. A pipe is read once, so its bytes stay for who reads it again.
static READ: Mutex<Option<HashMap<FileName, Option<Vec<u8>>>>> = Mutex::new(None);

/// Name by which two paths of one file are equal, whatever links, case and `..` are in them.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum FileName {
    /// Device and number of the file: those of hard links are the same.
    #[cfg(unix)]
    Number(u64, u64),
    /// Path without links.
    #[cfg_attr(unix, allow(dead_code))]
    Path(PathBuf),
}

impl FileName {
    #[cfg(unix)]
    fn of(_: &Path, metadata: &Metadata) -> Option<Self> {
        use std::os::unix::fs::MetadataExt;
        Some(Self::Number(metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn of(file: &Path, _: &Metadata) -> Option<Self> {
        file.canonicalize().ok().map(Self::Path)
    }
}

fn all_read() -> MutexGuard<'static, Option<HashMap<FileName, Option<Vec<u8>>>>> {
    // A panic elsewhere leaves the map whole.
    READ.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns true if this program has read `file`, by this path or another one.
pub fn was_read(file: &Path) -> bool {
    let name = fs::metadata(file).and_then(|metadata| {
        FileName::of(file, &metadata).ok_or_else(|| ErrorKind::NotFound.into())
    });
    let all = all_read();
    name.is_ok_and(|name| all.as_ref().is_some_and(|all| all.contains_key(&name)))
}

/// Opens a file to read it, and remembers it.
///
/// # Errors
/// Those of the system; a folder.
pub fn open(file: &Path) -> io::Result<File> {
    let opened = File::open(file)?;
    let metadata = opened.metadata()?;
    if metadata.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    if let Some(name) = FileName::of(file, &metadata) {
        let mut all = all_read();
        all.get_or_insert_default().entry(name).or_default();
    }
    Ok(opened)
}

/// Returns true if `file` stands for a stream, such as a pipe: what is read from it has no folder of its own.
pub fn is_stream(file: &Path) -> bool {
    is_standard_input(file) || fs::metadata(file).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

/// Returns true if `file` is `-`, which stands for standard input.
pub fn is_standard_input(file: &Path) -> bool {
    file == Path::new(STANDARD_INPUT)
}

/// Reads a whole file of at most `limit` bytes; `-` is standard input. A pipe that is read again gives the same bytes.
///
/// # Errors
/// Those of the system; a folder; a longer file.
pub fn bytes_of(file: &Path, limit: u64) -> io::Result<Vec<u8>> {
    if is_standard_input(file) {
        let name = FileName::Path(file.into());
        return stream_bytes(name, stdin().lock(), limit);
    }
    if is_stream(file) {
        let metadata = fs::metadata(file)?;
        let name = FileName::of(file, &metadata).unwrap_or(FileName::Path(file.into()));
        if let Some(Some(bytes)) = all_read().as_ref().and_then(|all| all.get(&name)) {
            return Ok(bytes.clone());
        }
        return stream_bytes(name, File::open(file)?, limit);
    }
    let opened = open(file)?;
    // Refused before it is read: its length is known.
    refuse_longer(opened.metadata()?.len(), limit)?;
    bounded(opened, limit)
}

fn stream_bytes(name: FileName, stream: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    if let Some(Some(bytes)) = all_read().as_ref().and_then(|all| all.get(&name)) {
        return Ok(bytes.clone());
    }
    let bytes = bounded(stream, limit.min(LONGEST_STREAM))?;
    let mut all = all_read();
    all.get_or_insert_default()
        .insert(name, Some(bytes.clone()));
    Ok(bytes)
}

fn bounded(from: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(limit + 1).read_to_end(&mut bytes)?;
    refuse_longer(bytes.len() as u64, limit)?;
    Ok(bytes)
}

fn refuse_longer(length: u64, limit: u64) -> io::Result<()> {
    match length > limit {
        true => {
            let limit = limit >> 20;
            let reason = format!("it is longer than {limit} MiB, the most that is read");
            Err(Error::new(ErrorKind::FileTooLarge, reason))
        }
        false => Ok(()),
    }
}

/// Reads a whole file of text, of at most `limit` bytes: UTF-8, or UTF-16 with a byte order mark as Windows writes it.
///
/// # Errors
/// As [`bytes_of`]; another encoding, with its line.
pub fn text_in(file: &Path, limit: u64) -> io::Result<String> {
    decoded(bytes_of(file, limit)?)
}

/// Reads the text of a regular file, as [`text_in`]. A pipe or a device is refused before it is opened, which may wait for ever.
///
/// # Errors
/// As there; what is no regular file.
pub(super) fn regular_text(file: &Path, limit: u64) -> io::Result<String> {
    match fs::metadata(file)?.is_file() {
        true => text_in(file, limit),
        false => Err(Error::other("it is no regular file")),
    }
}

fn decoded(bytes: Vec<u8>) -> io::Result<String> {
    let wide: fn([u8; 2]) -> u16 = match bytes.get(..2) {
        Some([0xFF, 0xFE]) => u16::from_le_bytes,
        Some([0xFE, 0xFF]) => u16::from_be_bytes,
        _ => {
            return String::from_utf8(bytes).map_err(|error| {
                let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
                let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
                not_text(&format!("line {line} is no text in UTF-8"))
            });
        }
    };
    let units = bytes[2..].chunks(2).map(|pair| match *pair {
        [first, second] => wide([first, second]),
        // Half a unit at the end, as an unpaired surrogate: no text.
        _ => 0xD800,
    });
    char::decode_utf16(units)
        .collect::<Result<String, _>>()
        .map_err(|_| not_text("it begins as UTF-16, and is none"))
}

fn not_text(reason: &str) -> Error {
    let reason = format!("{reason}; save it as UTF-8");
    Error::new(ErrorKind::InvalidData, reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    #[test]
    fn text_is_the_same_in_every_encoding_of_unicode() {
        let text = "name = \"Säge\" # \u{1f600}\r\n";
        let wide = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let marked = std::iter::once(0xFEFF).chain(text.encode_utf16());
            marked.flat_map(bytes).collect()
        };
        for bytes in [text.into(), wide(u16::to_le_bytes), wide(u16::to_be_bytes)] {
            assert_eq!(decoded(bytes).unwrap(), text);
        }
        for (bytes, said) in [
            (&b"a\nb\n\xe4 = 1"[..], "line 3 is no text in UTF-8"),
            (&[0xFF, 0xFE, 0x61], "UTF-16"),
            (&[0xFE, 0xFF, 0xD8, 0, 0, 0x61], "UTF-16"),
        ] {
            let error = decoded(bytes.into()).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
            assert!(error.contains("save it as UTF-8"), "{error}");
        }
    }

    #[test]
    fn a_file_that_was_read_is_known_by_every_name() {
        let folder = tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["read.toml", "other.toml"] {
            fs::write(at(name), "a = 1").unwrap();
        }
        fs::create_dir(at("sub")).unwrap();
        assert!(!was_read(&at("read.toml")));
        assert_eq!(text_in(&at("read.toml"), 5).unwrap(), "a = 1");
        assert!(was_read(&at("read.toml")));
        assert!(was_read(&at("sub/../read.toml")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("read.toml"), at("link")).unwrap();
            fs::hard_link(at("read.toml"), at("hard")).unwrap();
            assert!(was_read(&at("link")) && was_read(&at("hard")));
        }
        assert!(!was_read(&at("other.toml")) && !was_read(&at("none")));
    }

    #[test]
    fn nothing_is_read_beyond_the_limit() {
        let folder = tempdir().unwrap();
        let file = folder.path().join("long");
        fs::write(&file, "123456").unwrap();
        assert!(text_in(&file, 6).is_ok());
        let error = text_in(&file, 5).unwrap_err();
        assert!(error.to_string().contains("longer than"), "{error}");
        assert!(bounded(io::repeat(b'a'), 1000).is_err());
        let error = text_in(folder.path(), 5).unwrap_err();
        assert!(error.to_string().contains("folder"), "{error}");
        assert!(regular_text(folder.path(), 5).is_err());
    }
}
