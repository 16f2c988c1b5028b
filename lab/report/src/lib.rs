//! Report on the numbers: errors and run times of every number type, extremes, integrators, torques by Lagrange.
//!
//! Each section lies in a folder of its own and writes its part of one page. All errors and times
//! are measured anew by every call.

#![forbid(unsafe_code)]

mod colours;
pub mod docs;
mod draws;
mod error;
mod exact;
mod extremes;
mod lagrange;
mod numbers;
mod page;
mod progress;
mod scenes;
mod table;
pub mod work_precision;

pub use error::ReportError;
pub use page::Block;

use page::{Page, unwritable};
use progress::Progress;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Part of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportSection {
    /// Error and run time of every number type.
    Numbers,
    /// Extreme machines, moves and poses in every number type.
    Extremes,
    /// Error and run time of every method of integration.
    WorkPrecision,
    /// Torques of the core beside those of Lagrange's equations.
    Lagrange,
}

impl ReportSection {
    /// All of them, in order.
    pub const ALL: [Self; 4] = [
        Self::Numbers,
        Self::Extremes,
        Self::WorkPrecision,
        Self::Lagrange,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ReportSection::Numbers => "numbers",
            ReportSection::Extremes => "extremes",
            ReportSection::WorkPrecision => "work-precision",
            ReportSection::Lagrange => "lagrange",
        }
    }

    /// Contents in one line.
    pub fn about(self) -> &'static str {
        match self {
            ReportSection::Numbers => "Error and run time of every number type",
            ReportSection::Extremes => "Extreme machines, moves and poses in every number type",
            ReportSection::WorkPrecision => "Error and run time of every method of integration",
            ReportSection::Lagrange => "Torques of the core beside those of Lagrange's equations",
        }
    }

    /// Steps that [`Progress`] counts.
    fn steps(self) -> usize {
        match self {
            ReportSection::Numbers => numbers::STEPS,
            ReportSection::Extremes => extremes::STEPS,
            ReportSection::WorkPrecision => work_precision::STEPS,
            ReportSection::Lagrange => lagrange::STEPS,
        }
    }

    fn write(self, page: &mut Page<'_>, progress: &Progress<'_>) -> Result<(), ReportError> {
        match self {
            ReportSection::Numbers => numbers::write(page, progress),
            ReportSection::Extremes => extremes::write(page, progress),
            ReportSection::WorkPrecision => work_precision::write(page, progress),
            ReportSection::Lagrange => lagrange::write(page, progress),
        }
    }
}

impl FromStr for ReportSection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut all = Self::ALL.into_iter();
        all.find(|section| section.name() == text)
            .ok_or_else(|| "expected numbers, extremes, work-precision or lagrange".into())
    }
}

/// Written report.
#[derive(Clone, Debug)]
pub struct Report {
    /// Parts that documents may copy.
    pub blocks: Vec<Block>,
    /// Files, the page first.
    pub files: Vec<PathBuf>,
}

/// Writes `sections` into `folder`, which is made if it is missing.
///
/// Errors and counts are computed by all threads of rayon's current pool. Run times are measured while nothing else is
/// computed, or in processor time of one thread. `progress` hears how many steps are done, and of how many.
///
/// # Errors
/// Failed: something cannot be written.
pub fn write(
    sections: &[ReportSection],
    folder: &Path,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Report, ReportError> {
    std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    let mut page = Page::new(folder, "Report");
    let steps = sections.iter().map(|section| section.steps()).sum();
    let progress = Progress::new(steps, progress);
    for section in sections {
        section.write(&mut page, &progress)?;
    }
    let (blocks, files) = page.finish("report.md")?;
    Ok(Report { blocks, files })
}

/// Replaces the copies in `document`, and the figures in the folder `images` beside it.
///
/// # Errors
/// Refused: the document cannot be read, or its markers do not match. Failed: something cannot be
/// written.
pub fn refresh(document: &Path, report: &Report) -> Result<(), ReportError> {
    let refused =
        |reason: String| ReportError::Refused(format!("{}: {reason}", document.display()));
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
