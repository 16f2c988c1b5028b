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
pub use page::{Block, ReportFile};

use page::Page;
use progress::Progress;
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

    fn write(self, page: &mut Page, progress: &Progress<'_>) -> Result<(), ReportError> {
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

/// A report that is made.
#[derive(Clone, Debug)]
pub struct Report {
    /// Parts that documents may copy.
    pub blocks: Vec<Block>,
    /// Files, the page first.
    pub files: Vec<ReportFile>,
}

/// Makes the report of `sections`.
///
/// Errors and counts are computed by all threads of rayon's current pool. Run times are measured while nothing else is
/// computed, or in processor time of one thread. `progress` hears how many steps are done, and of how many.
///
/// # Errors
/// Failed: a measurement, a table or a figure.
pub fn measure(
    sections: &[ReportSection],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Report, ReportError> {
    let mut page = Page::new("Report");
    let steps = sections.iter().map(|section| section.steps()).sum();
    let progress = Progress::new(steps, progress);
    for section in sections {
        section.write(&mut page, &progress)?;
    }
    let (blocks, files) = page.finish("report.md");
    Ok(Report { blocks, files })
}

impl Report {
    /// Text of a document with its copies of the report's parts replaced, and the figures that it shows from the folder `images` beside it.
    ///
    /// # Errors
    /// A marker without its other one, or of no part.
    pub fn refreshed(&self, document: &str) -> Result<(String, Vec<&ReportFile>), String> {
        let text = docs::refreshed(document, &self.blocks)?;
        let is_shown = |file: &&ReportFile| text.contains(&format!("(images/{})", file.name));
        let shown = self.files.iter().filter(is_shown).collect();
        Ok((text, shown))
    }
}
