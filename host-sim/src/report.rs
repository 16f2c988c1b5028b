//! `trirrr report`: errors, run times and extremes, by the crate `trirrr-report`.

use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::print;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::time::Duration;
use trirrr_report::{ReportError, ReportSection, refresh, write};

/// `trirrr report`.
///
/// Writes report.md with its tables as CSV and its figures as SVG. Instruction counts are those
/// that were checked in when this program was built; everything else is measured now.
#[derive(Args, Clone, Debug)]
pub struct ReportArgs {
    /// Folder for what is written, made if missing; files of an earlier report are replaced
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    pub out: PathBuf,
    /// A part of the report; repeat for more [default: all of them]
    #[arg(long, value_parser = section())]
    pub section: Vec<ReportSection>,
    /// A Markdown file whose copies of the report's parts are replaced, and the figures in
    /// `images` beside it
    #[arg(long, value_name = "FILE.md")]
    pub docs: Option<PathBuf>,
}

fn section() -> impl TypedValueParser<Value = ReportSection> {
    let named = |section: ReportSection| PossibleValue::new(section.name()).help(section.about());
    PossibleValuesParser::new(ReportSection::ALL.map(named))
        .try_map(|name| name.parse::<ReportSection>())
}

/// Writes the report and, where asked to, refreshes the copies in a document.
///
/// # Errors
/// Refused: a document that cannot be read or whose markers do not match. Failed: something cannot
/// be written.
pub fn command(args: &ReportArgs) -> Result<(), CliError> {
    let sections = match args.section.as_slice() {
        [] => &ReportSection::ALL,
        some => some,
    };
    let mut results = ResultFolder::create(&args.out, "report")?;
    results.begin()?;
    let report = with_bar(|progress| write(sections, &args.out, progress))?;
    results.end(&report.files, Ok(()))?;
    for file in &report.files {
        print(&format!("{}\n", file.display()))?;
    }
    match &args.docs {
        Some(document) => Ok(refresh(document, &report)?),
        None => Ok(()),
    }
}

/// Shows the steps of `work` as a bar on standard error, on a terminal only.
fn with_bar<T>(work: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> T) -> T {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos} of {len}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    let result = work(&|done, steps| {
        bar.set_length(steps as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    result
}

impl From<ReportError> for CliError {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Refused(reason) => CliError::Refused(reason),
            ReportError::Failed(reason) => CliError::Failed(reason),
        }
    }
}
