//! A report while it is written: one Markdown file, with tables as CSV and figures as SVG beside
//! it.
//!
//! Parts that are copied into the repository's documents stand between two markers, so that the
//! copies can be replaced and compared ([`super::docs`]).

use super::table::Table;
use crate::error::ReportError;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::canvas::Drawn;

/// The report in one folder.
pub(crate) struct Page<'a> {
    folder: &'a Path,
    text: String,
    blocks: Vec<Block>,
    files: Vec<PathBuf>,
}

/// A part of the report that documents may have a copy of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its name in the markers.
    pub name: String,
    /// Its Markdown, ending with a newline.
    pub text: String,
    /// True if every machine gives the same text: so for errors and counts, not for times.
    pub reproducible: bool,
}

impl<'a> Page<'a> {
    /// An empty report for `folder`, which must exist.
    pub(crate) fn new(folder: &'a Path, title: &str) -> Self {
        Self {
            folder,
            text: format!("# {title}\n"),
            blocks: Vec::new(),
            files: Vec::new(),
        }
    }

    /// A heading of the second level or below.
    pub(crate) fn heading(&mut self, level: usize, text: &str) {
        let _ = writeln!(self.text, "\n{} {text}", "#".repeat(level));
    }

    /// A paragraph of Markdown.
    pub(crate) fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.text, "\n{}", text.trim_end());
    }

    /// A part that documents may copy under `name`; `reproducible` if every machine gives it alike.
    pub(crate) fn block(&mut self, name: &str, reproducible: bool, text: &str) {
        let text = format!("{}\n", text.trim_end());
        self.paragraph(&text);
        self.blocks.push(Block {
            name: name.into(),
            text,
            reproducible,
        });
    }

    /// Writes `table` as the CSV file `name`.
    pub(crate) fn csv(&mut self, name: &str, table: &Table) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        let write = || -> Result<(), csv::Error> {
            let mut writer = csv::Writer::from_path(&path)?;
            for record in table.records() {
                writer.write_record(record)?;
            }
            Ok(writer.flush()?)
        };
        write().map_err(|error| unwritable(&path, &error))?;
        self.files.push(path);
        Ok(())
    }

    /// Writes a figure as the SVG file `name` and shows it; `caption` says what is seen.
    pub(crate) fn figure(
        &mut self,
        name: &str,
        caption: &str,
        drawn: Drawn,
    ) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        drawn
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|svg| std::fs::write(&path, svg))
            .map_err(|error| unwritable(&path, &error))?;
        self.files.push(path);
        self.paragraph(&format!("![{caption}]({name})"));
        Ok(())
    }

    /// Writes the Markdown file and hands out what documents may copy, and all files.
    pub(crate) fn finish(mut self, name: &str) -> Result<(Vec<Block>, Vec<PathBuf>), ReportError> {
        let path = self.folder.join(name);
        std::fs::write(&path, &self.text).map_err(|error| unwritable(&path, &error))?;
        self.files.insert(0, path);
        Ok((self.blocks, self.files))
    }
}

/// Returns the error that names the file that could not be written, and why.
pub(super) fn unwritable(path: &Path, error: &dyn std::fmt::Display) -> ReportError {
    ReportError::Failed(format!("{}: cannot be written: {error}", path.display()))
}
