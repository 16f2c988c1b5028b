//! `cargo xtask house`: figures of the source's shape, against the thresholds that CI holds.
//!
//! Measured are the files that git knows. Tests are left out: [`source::Sources`] says which files are tests.

mod code;
mod documents;
mod packages;
mod prose;
mod source;

use crate::table::table;
use anyhow::{Result, ensure};
use source::Sources;

/// Type parameters of a public struct or enum, lifetimes and constants apart.
const PARAMETERS: usize = 3;

/// Share of documentation blocks that open with a question word, percent.
const OPENERS_PERCENT: f64 = 1.0;

/// Type names that are defined three times or more.
const REPEATED_NAMES: usize = 14;

/// Programs in the `examples/` of packages.
const EXAMPLES: usize = 8;

#[derive(clap::Args)]
pub(crate) struct HouseArgs {
    /// Fail where a figure is beyond its threshold
    #[arg(long)]
    check: bool,
    /// List every finding behind the figures
    #[arg(long)]
    list: bool,
}

/// One figure, its threshold in words, and the findings behind it.
struct Figure {
    name: &'static str,
    value: String,
    threshold: String,
    holds: bool,
    findings: Vec<String>,
}

pub(crate) fn run(arguments: &HouseArgs) -> Result<()> {
    let figures = figures(&Sources::read()?)?;
    let rows: Vec<Vec<String>> = figures
        .iter()
        .map(|figure| {
            let verdict = if figure.holds { "" } else { "beyond" };
            let cells = [figure.name, &figure.value, &figure.threshold, verdict];
            cells.map(str::to_owned).to_vec()
        })
        .collect();
    print!("{}", table(&["figure", "measured", "threshold", ""], &rows));
    for figure in &figures {
        if arguments.list || (arguments.check && !figure.holds) {
            println!("\n{}:", figure.name);
            for finding in &figure.findings {
                println!("  {finding}");
            }
        }
    }
    let beyond: Vec<&str> = figures
        .iter()
        .filter(|figure| !figure.holds)
        .map(|figure| figure.name)
        .collect();
    ensure!(
        !arguments.check || beyond.is_empty(),
        "beyond their thresholds: {}",
        beyond.join("; ")
    );
    Ok(())
}

fn figures(sources: &Sources) -> Result<Vec<Figure>> {
    let code = code::measure(&sources.product)?;
    let prose = prose::measure(&sources.product);
    let packages = packages::measure()?;
    let documents = documents::measure()?;
    let openers = 100.0 * prose.openers.len() as f64 / prose.blocks as f64;
    Ok(vec![
        Figure {
            name: "type parameters of a public type, at most",
            value: code.most_parameters.to_string(),
            threshold: format!("at most {PARAMETERS}"),
            holds: code.most_parameters <= PARAMETERS,
            findings: code.above(PARAMETERS),
        },
        Figure {
            name: "docs that open with a question word",
            value: format!(
                "{openers:.2} % ({} of {})",
                prose.openers.len(),
                prose.blocks
            ),
            threshold: format!("at most {OPENERS_PERCENT} %"),
            holds: openers <= OPENERS_PERCENT,
            findings: prose.openers,
        },
        Figure {
            name: "type names defined three times or more",
            value: code.repeated(3).len().to_string(),
            threshold: format!("at most {REPEATED_NAMES}"),
            holds: code.repeated(3).len() <= REPEATED_NAMES,
            findings: code.repeated(3),
        },
        Figure {
            name: "runnable examples",
            value: packages.examples.len().to_string(),
            threshold: format!("at least {EXAMPLES}"),
            holds: packages.examples.len() >= EXAMPLES,
            findings: packages.examples,
        },
        Figure {
            name: "dependencies against the direction of the rooms",
            value: packages.upward.len().to_string(),
            threshold: "none".into(),
            holds: packages.upward.is_empty(),
            findings: packages.upward,
        },
        Figure {
            name: "links of documents that lead nowhere",
            value: documents.lost_links.len().to_string(),
            threshold: "none".into(),
            holds: documents.lost_links.is_empty(),
            findings: documents.lost_links,
        },
        Figure {
            name: "tables of documents that an empty line cuts",
            value: documents.cut_tables.len().to_string(),
            threshold: "none".into(),
            holds: documents.cut_tables.is_empty(),
            findings: documents.cut_tables,
        },
        Figure {
            name: "packages and dependencies between them",
            value: format!("{} and {}", packages.count, packages.dependencies),
            threshold: "-".into(),
            holds: true,
            findings: Vec::new(),
        },
        Figure {
            name: "lines of Rust without tests and comments",
            value: code.lines.to_string(),
            threshold: "-".into(),
            holds: true,
            findings: code.lines_by_room(),
        },
    ])
}
