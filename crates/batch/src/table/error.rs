//! Failure of the evaluation of a table.

use arrow_schema::ArrowError;
use std::io;

/// Reason why a table is not evaluated to its end. The name of its file belongs before the message.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The table has no header.
    #[error("is empty, expected a header that names the columns")]
    Empty,
    /// Columns are missing, or there twice.
    #[error("{0}")]
    Columns(String),
    /// A column holds something else than numbers or labels.
    #[error("column {column} holds {found}, expected {expected}")]
    ColumnType {
        /// Name of the column.
        column: String,
        /// Type of its values.
        found: String,
        /// Types that it may have.
        expected: &'static str,
    },
    /// The file is no Arrow IPC file, or one with an encoding that this program does not read.
    #[error("cannot be read as an Arrow IPC file: {0}")]
    NotArrow(String),
    /// Reading failed.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// Writing failed.
    #[error("the results cannot be written: {0}")]
    Unwritable(io::Error),
}

impl TableError {
    /// Failure of an Arrow writer, with the kind of its input and output error.
    pub(super) fn unwritable(error: ArrowError) -> Self {
        Self::Unwritable(match error {
            ArrowError::IoError(_, error) => error,
            other => io::Error::other(other),
        })
    }
}
