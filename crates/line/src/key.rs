//! Keys that both ends of a TCP link share, and what is drawn at random.

use std::fmt;
use std::fs;
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use trirrr_scene::read::files::{LONGEST_MACHINE, text_in};

/// Bytes of a key.
pub(crate) const KEY_BYTES: usize = 32;

/// Key that both ends of a link share: 32 bytes, in a file 64 hexadecimal digits on one line.
#[derive(Clone, PartialEq, Eq)]
pub struct SharedKey([u8; KEY_BYTES]);

/// Reason why a key cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file does not exist.
    #[error(
        "{}: no such key file; `trirrr key {}` writes a new key, and the far end needs a copy of it",
        .0.display(), .0.display()
    )]
    Missing(PathBuf),
    /// The file is there already: a key that is in use is not to be lost.
    #[error("{}: exists already, and is not overwritten: choose another name, or delete the file first", .0.display())]
    Exists(PathBuf),
    /// The file holds something else.
    #[error("{}: a key is 64 hexadecimal digits on one line, as `trirrr key` writes them; this file holds something else", .0.display())]
    Malformed(PathBuf),
    /// The key is one byte over and over: everybody knows it.
    #[error("{}: a key of one byte over and over is no secret; `trirrr key FILE` draws a new one, and the far end needs a copy of it", .0.display())]
    Known(PathBuf),
    /// The system refuses.
    #[error("{}: {error}", .file.display())]
    Other {
        /// The file.
        file: PathBuf,
        /// Reason, in the words of the system.
        error: io::Error,
    },
}

impl SharedKey {
    /// Draws a new key from the operating system.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn random() -> io::Result<Self> {
        let mut bytes = [0; KEY_BYTES];
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        Ok(Self(bytes))
    }

    /// Reads the key in `file`.
    ///
    /// # Errors
    /// [`KeyError`].
    pub fn read(file: &Path) -> Result<Self, KeyError> {
        let text = text_in(file, LONGEST_MACHINE).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => KeyError::Missing(file.into()),
            io::ErrorKind::InvalidData | io::ErrorKind::FileTooLarge => {
                KeyError::Malformed(file.into())
            }
            _ => other(file, error),
        })?;
        let key = Self::parse(&text).ok_or_else(|| KeyError::Malformed(file.into()))?;
        match key.is_known() {
            true => Err(KeyError::Known(file.into())),
            false => Ok(key),
        }
    }

    /// Writes the key into a new `file`, which on Unix only its owner may read.
    ///
    /// # Errors
    /// [`KeyError`]; a file that exists stays as it is.
    pub fn write_new(&self, file: &Path) -> Result<(), KeyError> {
        let mut options = fs::OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut opened = options.open(file).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => KeyError::Exists(file.into()),
            _ => other(file, error),
        })?;
        let digits: String = self.0.iter().map(|byte| format!("{byte:02x}")).collect();
        let written = opened.write_all(format!("{digits}\n").as_bytes());
        written.map_err(|error| other(file, error))
    }

    /// Returns true if other users of this computer may read `file`. Only Unix tells.
    pub fn is_open_to_others(file: &Path) -> bool {
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::metadata(file).is_ok_and(|data| data.permissions().mode() & 0o044 != 0)
        }
        #[cfg(not(unix))]
        {
            let _ = file;
            false
        }
    }

    fn parse(text: &str) -> Option<Self> {
        let digits = text.trim_end().as_bytes();
        if digits.len() != 2 * KEY_BYTES {
            return None;
        }
        let digit = |digit: u8| char::from(digit).to_digit(16);
        let mut bytes = [0; KEY_BYTES];
        for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
            // Two digits make at most 255.
            *byte = (digit(pair[0])? * 16 + digit(pair[1])?) as u8;
        }
        Some(Self(bytes))
    }

    /// Returns true for a key that nobody has drawn, such as that of a file of zeros.
    fn is_known(&self) -> bool {
        self.0.iter().all(|byte| *byte == self.0[0])
    }

    #[cfg(feature = "keys")]
    pub(crate) fn bytes(&self) -> &[u8; KEY_BYTES] {
        &self.0
    }
}

/// Says that there is a key, and not which: what is printed is read by others.
impl fmt::Debug for SharedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedKey(..)")
    }
}

/// Returns a number that nobody can foretell, drawn from the operating system.
pub fn entropy() -> u32 {
    getrandom::u32().unwrap_or_else(|_| {
        // The keys of the standard library's hash tables are drawn from the system in another way, and make the program end
        // where there is none.
        let hasher = std::hash::RandomState::new().build_hasher();
        hasher.finish() as u32
    })
}

fn other(file: &Path, error: io::Error) -> KeyError {
    let file = file.into();
    KeyError::Other { file, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_64_digits_on_one_line() {
        let digits = "00ff".repeat(16);
        let key = SharedKey::parse(&format!("{digits}\r\n")).unwrap();
        assert_eq!(key.0[..3], [0x00, 0xff, 0x00]);
        assert_eq!(SharedKey::parse(&digits.to_uppercase()), Some(key));
        for wrong in [
            &digits[1..],
            "",
            &format!("{digits}0"),
            &format!("+{}", &digits[1..]),
            &format!("\u{e9}{}", &digits[2..]).replace('0', "g"),
        ] {
            assert_eq!(SharedKey::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_key_that_everybody_knows_is_refused() {
        let file = std::env::temp_dir().join(format!("trirrr-key-{}", entropy()));
        for (digits, is_known) in [("00", true), ("ff", true), ("5A", true), ("5a5b", false)] {
            fs::write(&file, digits.repeat(64 / digits.len())).unwrap();
            let read = SharedKey::read(&file);
            assert_eq!(
                matches!(read, Err(KeyError::Known(_))),
                is_known,
                "{digits}"
            );
            assert_eq!(read.is_ok(), !is_known, "{digits}");
        }
        fs::remove_file(&file).unwrap();
    }

    #[test]
    fn what_is_drawn_differs() {
        let drawn: std::collections::BTreeSet<u32> = (0..64).map(|_| entropy()).collect();
        // Two of 64 are alike once in two million times, and four never.
        assert!(drawn.len() > 61, "{drawn:?}");
        assert_ne!(SharedKey::random().unwrap(), SharedKey::random().unwrap());
        assert_eq!(
            format!("{:?}", SharedKey::random().unwrap()),
            "SharedKey(..)"
        );
    }
}
