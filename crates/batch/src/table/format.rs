//! Formats of tables, by the endings of their files.

use std::path::Path;

/// Format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Text with commas and a header.
    Csv,
    /// Arrow IPC file, also called Feather version 2.
    Arrow,
}

/// Refusal of a file whose ending names a format that is not supported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} files are not supported; use .csv, or .arrow for an Arrow IPC file")]
pub struct UnknownFormat(String);

impl TableFormat {
    /// Returns the format that the ending of `path` names: `.arrow` and `.feather` Arrow, others CSV.
    ///
    /// # Errors
    /// The ending of a binary format that is not supported.
    pub fn of(path: &Path) -> Result<Self, UnknownFormat> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str().unwrap_or_default() {
            "arrow" | "feather" => Ok(Self::Arrow),
            other @ ("arrows" | "parquet" | "npy" | "npz" | "xlsx" | "ods" | "gz" | "zst") => {
                Err(UnknownFormat(format!(".{other}")))
            }
            _ => Ok(Self::Csv),
        }
    }
}
