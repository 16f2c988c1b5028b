//! Files in JSON that tell whether they are as the program wrote them.

use super::disk::{self, ContentHash};
use crate::failure::CliError;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;

/// Key of the hash over all others.
const SEAL: &str = "seal";

/// Content of a sealed file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Sealed {
    /// The file does not exist.
    Missing,
    /// As the program wrote it.
    Whole(Value),
    /// Cut off, changed, of an older version, or something else.
    Damaged,
}

/// Reads a sealed file.
///
/// # Errors
/// Refused: the file cannot be read.
pub(crate) fn read(path: &Path) -> Result<Sealed, CliError> {
    let bytes = match disk::own_text(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Sealed::Missing),
        Err(error) => {
            let name = path.display();
            return Err(CliError::Refused(format!(
                "{name}: cannot be read: {error}"
            )));
        }
    };
    Ok(opened(&bytes).map_or(Sealed::Damaged, Sealed::Whole))
}

/// The value without its seal, if the file has every byte that was written.
fn opened(bytes: &[u8]) -> Option<Value> {
    let mut value: Value = serde_json::from_slice(bytes).ok()?;
    value.as_object_mut()?.remove(SEAL)?;
    (sealed_text(&value).as_bytes() == bytes).then_some(value)
}

/// Text of a sealed file.
fn sealed_text(value: &Value) -> String {
    let mut sealed = value.clone();
    if let Some(object) = sealed.as_object_mut() {
        object.insert(SEAL.into(), seal_of(value).into());
    }
    format!("{sealed:#}\n")
}

fn seal_of(value: &Value) -> String {
    hex(ContentHash::of_bytes(value.to_string().as_bytes()))
}

/// Hash as text.
pub(super) fn hex(ContentHash(hash): ContentHash) -> String {
    format!("{hash:016x}")
}

/// Hash of a text of [`hex`].
pub(super) fn hash_of(value: &Value) -> Option<ContentHash> {
    let hash = u64::from_str_radix(value.as_str()?, 16);
    hash.ok().map(ContentHash)
}

/// Writes an object with its seal in the place of `path`, which is missing or the caller's own.
///
/// # Errors
/// Failed: the file cannot be written; the old one is there then.
pub(crate) fn write(path: &Path, value: &Value) -> Result<(), CliError> {
    disk::put(path, sealed_text(value).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn any_other_byte_is_damage() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("job.json");
        assert_eq!(read(&path).unwrap(), Sealed::Missing);
        let value = json!({"scene": "a", "places": [1, {"at": 2}], "b": null});
        write(&path, &value).unwrap();
        assert_eq!(read(&path).unwrap(), Sealed::Whole(value));
        let whole = disk::own_text(&path).unwrap();
        let damaged = |bytes: &[u8]| {
            disk::put(&path, bytes).unwrap();
            read(&path).unwrap() == Sealed::Damaged
        };
        assert!(damaged(&[&whole[..], b" "].concat()));
        assert!((0..whole.len()).all(|length| damaged(&whole[..length])));
        for (index, byte) in whole.iter().enumerate() {
            if byte.is_ascii_alphanumeric() {
                let mut other = whole.clone();
                other[index] ^= 1;
                assert!(damaged(&other), "{index}");
            }
        }
        assert!(damaged(b"[]") && damaged(b"{}") && damaged(b"\xff\0"));
    }
}
