//! A report while it is written: one Markdown file, with tables as CSV and figures as SVG beside
//! it.
//!
//! Parts that are copied into the repository's documents stand between two markers, so that the
//! copies can be replaced and compared ([`super::docs`]).

use super::table::Table;
use crate::error::ReportError;
use std::fmt::Write;
use trirrr_figures::canvas::Drawn;

/// A report while it is made.
pub(crate) struct Page {
    text: String,
    blocks: Vec<Block>,
    files: Vec<ReportFile>,
}

/// A file of the report.
#[derive(Clone, Debug)]
pub struct ReportFile {
    /// Name in the folder of the report.
    pub name: String,
    /// Content.
    pub content: Vec<u8>,
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

impl Page {
    /// An empty report.
    pub(crate) fn new(title: &str) -> Self {
        Self {
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

    fn add(&mut self, name: &str, content: Vec<u8>) {
        let name = name.into();
        self.files.push(ReportFile { name, content });
    }

    /// Adds `table` as the CSV file `name`.
    pub(crate) fn csv(&mut self, name: &str, table: &Table) -> Result<(), ReportError> {
        let failed = |error: String| ReportError::Failed(format!("{name}: {error}"));
        let mut writer = csv::Writer::from_writer(Vec::new());
        for record in table.records() {
            let written = writer.write_record(record);
            written.map_err(|error| failed(error.to_string()))?;
        }
        let content = writer.into_inner();
        self.add(name, content.map_err(|error| failed(error.to_string()))?);
        Ok(())
    }

    /// Adds a figure as the SVG file `name` and shows it; `caption` says what is seen.
    pub(crate) fn figure(
        &mut self,
        name: &str,
        caption: &str,
        drawn: Drawn,
    ) -> Result<(), ReportError> {
        let svg = drawn.map_err(|error| ReportError::Failed(format!("{name}: {error}")))?;
        self.add(name, svg.into());
        self.paragraph(&format!("![{caption}]({name})"));
        Ok(())
    }

    /// Adds the Markdown file, as the first, and hands out what documents may copy, and all files.
    pub(crate) fn finish(mut self, name: &str) -> (Vec<Block>, Vec<ReportFile>) {
        let page = ReportFile {
            name: name.into(),
            content: self.text.into(),
        };
        self.files.insert(0, page);
        (self.blocks, self.files)
    }
}
