//! Result of a command as one document: text for a terminal, an object in JSON, and a page come from the same values.
//!
//! A [`Facts`] holds values, each with a key for JSON and a label for people. The end of the key is the unit: `peak_torque_nm` is shown
//! in `N m`. A [`Document`] puts records, tables, notes and figures in order.

mod facts;
mod page;
mod quantity;
pub mod schema;
mod text;

pub use facts::{Facts, csv};
pub use page::escaped;
pub use quantity::{digits, quantity};

use serde::Serialize;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Readers that see a value or a section. JSON has all that has a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Reader {
    /// Programs alone.
    Program,
    /// Readers of the page, too.
    Page,
    /// Readers of the terminal, too.
    Terminal,
}

#[derive(Clone, Debug)]
enum DocumentPart {
    Heading(String),
    Pairs {
        /// Place of the object in JSON, with dots between its steps; empty: the root.
        key: &'static str,
        facts: Facts,
    },
    Table {
        /// Place of the array in JSON; empty: the rows stand in text alone.
        key: &'static str,
        rows: Vec<Facts>,
    },
    Note(String),
    /// SVG or HTML of this program.
    Figure(String),
    Files(Vec<PathBuf>),
}

/// Result of a command.
#[derive(Clone, Debug, Default)]
pub struct Document {
    sections: Vec<(Reader, DocumentPart)>,
}

impl Document {
    /// Begins a document.
    pub fn new() -> Self {
        Self::default()
    }

    fn add(&mut self, reader: Reader, section: DocumentPart) -> &mut Self {
        self.sections.push((reader, section));
        self
    }

    /// Begins a part with a heading.
    pub fn heading(&mut self, text: impl Into<String>) -> &mut Self {
        self.add(Reader::Terminal, DocumentPart::Heading(text.into()))
    }

    /// Begins a part of the page.
    pub fn page_heading(&mut self, text: impl Into<String>) -> &mut Self {
        self.add(Reader::Page, DocumentPart::Heading(text.into()))
    }

    /// Adds values to the object.
    pub fn pairs(&mut self, facts: Facts) -> &mut Self {
        self.pairs_in("", facts)
    }

    /// Adds values to the object at `key`; dots lead into objects.
    pub fn pairs_in(&mut self, key: &'static str, facts: Facts) -> &mut Self {
        self.add(Reader::Terminal, DocumentPart::Pairs { key, facts })
    }

    /// Adds a table. JSON has its rows as an array of objects at `key`.
    pub fn table(&mut self, key: &'static str, rows: Vec<Facts>) -> &mut Self {
        self.add(Reader::Terminal, DocumentPart::Table { key, rows })
    }

    /// Adds a table for the page and JSON.
    pub fn page_table(&mut self, key: &'static str, rows: Vec<Facts>) -> &mut Self {
        self.add(Reader::Page, DocumentPart::Table { key, rows })
    }

    /// Adds a value for programs at `key`.
    pub fn data(&mut self, key: &'static str, value: impl Serialize) -> &mut Self {
        self.pairs(Facts::new().data(key, value))
    }

    /// Adds a sentence.
    pub fn note(&mut self, text: impl Into<String>) -> &mut Self {
        self.add(Reader::Terminal, DocumentPart::Note(text.into()))
    }

    /// Adds a sentence to the page.
    pub fn page_note(&mut self, text: impl Into<String>) -> &mut Self {
        self.add(Reader::Page, DocumentPart::Note(text.into()))
    }

    /// Adds a figure to the page: SVG or HTML, as it is.
    pub fn figure(&mut self, svg: impl Into<String>) -> &mut Self {
        self.add(Reader::Page, DocumentPart::Figure(svg.into()))
    }

    /// Adds the written files.
    pub fn files(&mut self, files: impl IntoIterator<Item = impl Into<PathBuf>>) -> &mut Self {
        let files = files.into_iter().map(Into::into).collect();
        self.add(Reader::Terminal, DocumentPart::Files(files))
    }

    /// Object of the document.
    pub fn json(&self) -> Value {
        let mut root = Map::new();
        for (_, section) in &self.sections {
            match section {
                DocumentPart::Pairs { key: "", facts } => facts.json_into(&mut root),
                DocumentPart::Pairs { key, facts } => facts::insert(&mut root, key, json!(facts)),
                DocumentPart::Table { key, rows } if !key.is_empty() => {
                    facts::insert(&mut root, key, json!(rows));
                }
                DocumentPart::Files(files) => facts::insert(&mut root, "files", json!(files)),
                _ => {}
            }
        }
        root.into()
    }
}

#[cfg(test)]
mod tests;
