//! `host-sim report`: what the numbers are worth and what they cost, measured anew.
//!
//! Each section lies in a folder of its own and writes its part of one page.

pub mod docs;
mod exact;
mod extremes;
mod numbers;
mod page;
mod scenes;
mod table;
pub mod work_precision;

pub use page::Block;

use crate::cli::ReportArgs;
use crate::failure::Failure;
use clap::ValueEnum;
use page::{Page, unwritable};
use std::path::{Path, PathBuf};

/// A part of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Section {
    /// Error and run time of every number type
    Numbers,
    /// Extreme machines, moves and poses in every number type
    Extremes,
    /// Error and run time of every method of integration
    WorkPrecision,
}

impl Section {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::Numbers, Self::Extremes, Self::WorkPrecision];

    fn write(self, page: &mut Page<'_>) -> Result<(), Failure> {
        match self {
            Section::Numbers => numbers::write(page),
            Section::Extremes => extremes::write(page),
            Section::WorkPrecision => work_precision::write(page),
        }
    }
}

/// What a report gives, besides what it writes.
#[derive(Clone, Debug)]
pub struct Report {
    /// The parts that documents may copy.
    pub blocks: Vec<Block>,
    /// What was written, the page first.
    pub files: Vec<PathBuf>,
}

/// `host-sim report`: writes the report and, where asked to, the copies in a document.
///
/// # Errors
/// Refused: a document that cannot be read or whose markers do not match. Failed: something cannot
/// be written.
pub fn command(args: &ReportArgs) -> Result<(), Failure> {
    let sections = match args.section.as_slice() {
        [] => &Section::ALL,
        some => some,
    };
    let report = write(sections, &args.out)?;
    for file in &report.files {
        println!("{}", file.display());
    }
    match &args.docs {
        Some(document) => refresh(document, &report),
        None => Ok(()),
    }
}

/// Writes `sections` into `folder`, which is made if it is missing.
///
/// # Errors
/// Failed: something cannot be written.
pub fn write(sections: &[Section], folder: &Path) -> Result<Report, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    let mut page = Page::new(folder, "Report");
    for section in sections {
        section.write(&mut page)?;
    }
    let (blocks, files) = page.finish("report.md")?;
    Ok(Report { blocks, files })
}

/// Replaces the copies in `document`, and the figures in the folder `images` beside it.
fn refresh(document: &Path, report: &Report) -> Result<(), Failure> {
    let refused = |reason: String| Failure::Refused(format!("{}: {reason}", document.display()));
    let text = std::fs::read_to_string(document)
        .map_err(|error| refused(format!("cannot be read: {error}")))?;
    let text = docs::refreshed(&text, &report.blocks).map_err(refused)?;
    std::fs::write(document, &text).map_err(|error| unwritable(document, &error))?;
    let images = document.with_file_name("images");
    let figures = report.files.iter().filter(|file| {
        let name = file.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| text.contains(&format!("(images/{name})")))
    });
    for figure in figures {
        std::fs::create_dir_all(&images).map_err(|error| unwritable(&images, &error))?;
        let copy = images.join(figure.file_name().unwrap_or_default());
        std::fs::copy(figure, &copy).map_err(|error| unwritable(&copy, &error))?;
    }
    Ok(())
}
