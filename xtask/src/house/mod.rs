//! `cargo xtask house`: figures of the source's shape, against the thresholds that CI holds.
//!
//! Measured are the files that git knows. Tests are left out: [`source::Sources`] says which files are tests.

mod circles;
mod code;
mod documents;
mod packages;
mod prose;
mod source;

use crate::table::table;
use anyhow::{Result, ensure};
use source::{Source, Sources};

/// Documentation blocks that open with a question word.
const QUESTIONS: usize = 20;

/// Type names that are defined three times or more.
const REPEATED_NAMES: usize = 14;

/// Circles of three files and more in a crate.
const CIRCLES: usize = 0;

/// Lines with a `cfg` in [`APP`], for 1,000 lines of its code.
const CONDITIONS: usize = 25;

/// Room of what all boards run: modules and types choose there.
const APP: &str = "firmware/app";

#[derive(clap::Args)]
pub(crate) struct HouseArgs {
    /// Fail where a figure is beyond its threshold
    #[arg(long)]
    check: bool,
    /// List every finding behind the figures
    #[arg(long)]
    list: bool,
}

/// One figure, and the findings behind it.
struct Figure {
    name: &'static str,
    value: usize,
    /// Threshold; none where the figure is only told.
    most: Option<usize>,
    findings: Vec<String>,
}

impl Figure {
    /// A number of `findings`, of which there may be `most`.
    fn of(name: &'static str, findings: Vec<String>, most: usize) -> Self {
        Self {
            name,
            value: findings.len(),
            most: Some(most),
            findings,
        }
    }

    fn holds(&self) -> bool {
        self.most.is_none_or(|most| self.value <= most)
    }
}

pub(crate) fn run(arguments: &HouseArgs) -> Result<()> {
    let figures = figures(&Sources::read()?.product)?;
    let row = |figure: &Figure| {
        let most = figure.most.map_or("-".into(), |most| most.to_string());
        let verdict = if figure.holds() { "" } else { "beyond" };
        let value = figure.value.to_string();
        vec![figure.name.into(), value, most, verdict.into()]
    };
    let rows: Vec<_> = figures.iter().map(row).collect();
    print!("{}", table(&["figure", "measured", "at most", ""], &rows));
    for figure in &figures {
        if arguments.list || (arguments.check && !figure.holds()) {
            println!("\n{}:", figure.name);
            for finding in &figure.findings {
                println!("  {finding}");
            }
        }
    }
    let beyond = figures.iter().filter(|figure| !figure.holds());
    let beyond: Vec<&str> = beyond.map(|figure| figure.name).collect();
    ensure!(
        !arguments.check || beyond.is_empty(),
        "beyond their thresholds: {}",
        beyond.join("; ")
    );
    Ok(())
}

fn figures(sources: &[Source]) -> Result<Vec<Figure>> {
    let documents = documents::measure()?;
    let rooms = code::lines_by_room(sources);
    let room = |(room, lines)| format!("{room}: {lines}");
    let wide = code::wide(sources, 3);
    let repeated = code::repeated(sources, 3);
    let questions = prose::questions(sources);
    let circles = circles::find(sources);
    let conditions = code::conditions(sources, APP);
    let app = rooms.get(APP).copied().unwrap_or(1);
    let upward = packages::upward()?;
    let (links, tables) = (documents.lost_links, documents.cut_tables);
    Ok(vec![
        Figure::of("public types with more than three type parameters", wide, 0),
        Figure::of("docs that open with a question word", questions, QUESTIONS),
        Figure::of(
            "type names defined three times or more",
            repeated,
            REPEATED_NAMES,
        ),
        Figure::of("circles of three files and more", circles, CIRCLES),
        Figure {
            name: "cfgs in 1,000 lines of firmware/app",
            value: 1000 * conditions.len() / app,
            most: Some(CONDITIONS),
            findings: conditions,
        },
        Figure::of("dependencies against the direction of the rooms", upward, 0),
        Figure::of("links of documents that lead nowhere", links, 0),
        Figure::of("tables of documents that an empty line cuts", tables, 0),
        Figure {
            name: "lines of Rust without tests and comments",
            value: rooms.values().sum(),
            most: None,
            findings: rooms.iter().map(room).collect(),
        },
    ])
}
