//! `trirrr report`: errors, run times and extremes, by the crate `trirrr-report`.

use crate::failure::CliError;
use crate::results::{ResultFolder, refresh};
use crate::terminal::{bar, print};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use std::time::Duration;
use trirrr_report::{ReportError, ReportSection, measure};
use trirrr_scene::read::files::{LONGEST_TABLE, text_in};

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
    let document = args.docs.as_ref().map(|document| {
        let text = text_in(document, LONGEST_TABLE);
        text.map(|text| (document, text)).map_err(|error| {
            CliError::Refused(format!("{}: cannot be read: {error}", document.display()))
        })
    });
    let document = document.transpose()?;
    let mut results = ResultFolder::for_command(&args.out, "report")?;
    let report = with_bar(|progress| measure(sections, progress))?;
    for file in &report.files {
        results.write(&file.name, file.content.clone())?;
    }
    results.end(None)?;
    for file in results.files() {
        print(&format!("{}\n", file.display()))?;
    }
    let Some((document, text)) = document else {
        return Ok(());
    };
    let (text, shown) = report
        .refreshed(&text)
        .map_err(|reason| CliError::Refused(format!("{}: {reason}", document.display())))?;
    let images = document.with_file_name("images");
    let figures = shown
        .iter()
        .map(|file| (images.join(&file.name), &*file.content));
    refresh(figures.chain([(document.clone(), text.as_bytes())]))
}

/// Shows the steps of `work` as a bar on standard error, on a terminal only.
fn with_bar<T>(work: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> T) -> T {
    let bar = bar(0, "{elapsed_precise} {wide_bar} {pos} of {len}");
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
