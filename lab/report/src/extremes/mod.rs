//! Section "extremes": what becomes of the tick where machines, moves and poses are extreme.

mod cases;
mod curves;
mod measure;

use super::page::Page;
use super::progress::Progress;
use super::table::{Table, two_digits};
use crate::error::ReportError;
use cases::ExtremeCase;
use measure::{CaseOutcome, measure};
use rayon::prelude::*;
use std::collections::BTreeMap;
use trirrr_core::number::{Coarse, Fixed};

/// The outcomes of one number type, in the order of the cases.
struct Column {
    scalar: &'static str,
    outcomes: Vec<CaseOutcome>,
}

fn columns(cases: &[ExtremeCase]) -> [Column; 4] {
    let column = |scalar, measure: fn(&ExtremeCase) -> CaseOutcome| Column {
        scalar,
        outcomes: cases.par_iter().map(measure).collect(),
    };
    [
        column("f64", measure::<f64>),
        column("f32", measure::<f32>),
        column("fixed", measure::<Fixed>),
        column("micromath", measure::<Coarse>),
    ]
}

/// Steps of the section: all cases, and the curves.
pub(crate) const STEPS: usize = 2;

/// Writes the section.
pub(super) fn write(page: &mut Page, progress: &Progress<'_>) -> Result<(), ReportError> {
    let cases = cases::all()?;
    let columns = progress.step(columns(&cases));
    page.heading(2, "Extremes of the tick");
    page.paragraph(&format!(
        "{} cases: those of the reference file, durations of a move from 1 ms to 10,000 s, moves \
         down to 1e-9 m and of nothing, many turns, machines from 1 mm to 1 km, all working modes, \
         and poses that differ from a singularity by less and less, down to the last step of an \
         f64. *Forward* is the worst error of the motors' results against the exact values, in \
         units of u cond, what a rounding of every input does to them. *Closure* is how far the \
         loops are from closing with the computed angles, in units in the last place of the \
         machine's size.",
        cases.len()
    ));
    page.block("extremes", true, &summary(&cases, &columns).markdown());
    page.csv("extremes.csv", &every_case(&cases, &columns))?;
    progress.step(curves::write(page, &cases::thesis_links()?))
}

/// Contents of one cell of the summary: counts, and the worst of each measure.
#[derive(Default)]
struct Cell {
    ok: usize,
    forward: f64,
    closure: f64,
    others: BTreeMap<String, usize>,
}

impl Cell {
    fn of<'a>(outcomes: impl Iterator<Item = &'a CaseOutcome>) -> Self {
        let mut cell = Self::default();
        for outcome in outcomes {
            match outcome {
                CaseOutcome::Motion {
                    forward, closure, ..
                } => {
                    cell.ok += 1;
                    cell.forward = cell.forward.max(*forward);
                    cell.closure = cell.closure.max(*closure);
                }
                CaseOutcome::BeyondReach => {
                    *cell.others.entry("rounded into reach".into()).or_default() += 1
                }
                CaseOutcome::Status(status) => {
                    // Which leg, and what is out of range, stands in the table of all cases.
                    let kind = status.split([':', ',']).next().unwrap_or(status);
                    *cell.others.entry(kind.to_owned()).or_default() += 1;
                }
            }
        }
        cell
    }
}

fn summary(cases: &[ExtremeCase], columns: &[Column]) -> Table {
    let mut groups: Vec<&str> = Vec::new();
    for case in cases {
        if !groups.contains(&case.group) {
            groups.push(case.group);
        }
    }
    let mut table = Table::new(&[
        "what is extreme",
        "number type",
        "with results",
        "forward (u cond)",
        "closure (ulp)",
        "without",
    ]);
    for group in groups {
        for column in columns {
            let of_group = cases.iter().zip(&column.outcomes);
            let of_group = of_group.filter(|(case, _)| case.group == group);
            let cell = Cell::of(of_group.map(|(_, outcome)| outcome));
            let others: Vec<String> = cell
                .others
                .iter()
                .map(|(kind, count)| format!("{count} {kind}"))
                .collect();
            table.row([
                group.to_owned(),
                column.scalar.to_owned(),
                cell.ok.to_string(),
                two_digits(cell.forward),
                two_digits(cell.closure),
                others.join(", "),
            ]);
        }
    }
    table
}

fn every_case(cases: &[ExtremeCase], columns: &[Column]) -> Table {
    let mut table = Table::new(&[
        "group",
        "case",
        "scalar",
        "status",
        "forward_over_u_cond",
        "worst_result",
        "closure_ulp",
    ]);
    for (index, case) in cases.iter().enumerate() {
        for column in columns {
            let (status, figures) = match &column.outcomes[index] {
                CaseOutcome::Motion {
                    forward,
                    worst,
                    closure,
                    ..
                } => (
                    "ok".to_owned(),
                    [
                        format!("{forward:e}"),
                        worst.clone(),
                        format!("{closure:e}"),
                    ],
                ),
                CaseOutcome::BeyondReach => ("rounded into reach".to_owned(), Default::default()),
                CaseOutcome::Status(status) => (status.clone(), Default::default()),
            };
            let names = [
                case.group.to_owned(),
                case.name.clone(),
                column.scalar.to_owned(),
                status,
            ];
            table.row(names.into_iter().chain(figures));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that the test asserts of one number type, over all cases.
    struct Expected {
        scalar: &'static str,
        forward: std::ops::Range<f64>,
        closure: std::ops::Range<f64>,
        without: &'static [(&'static str, std::ops::RangeInclusive<usize>)],
    }

    /// A backward stable computation errs by a few roundings of its inputs: below one u cond here,
    /// and not by less than half of one, or the bracket has to follow. The loops close within the
    /// rounding of the two angles, pi u of the size of the links each, which is less than a unit in
    /// the last place of the machine's size. micromath's functions are off by 1e-3 to 6e-2, which
    /// is some 1e4 to 1e6 of the 6e-8 that f32 rounds by.
    #[test]
    fn errors_closures_and_statuses_are_as_the_formats_explain() {
        let cases = cases::all().unwrap();
        assert!(cases.len() > 140);
        let mut wrong = Vec::new();
        for (column, expected) in columns(&cases).iter().zip([
            Expected {
                scalar: "f64",
                forward: 0.5..1.0,
                closure: 0.5..1.0,
                without: &[("parallel singular", 1..=1)],
            },
            Expected {
                scalar: "f32",
                forward: 0.5..1.0,
                closure: 0.5..1.0,
                without: &[("parallel singular", 16..=16), ("serial singular", 13..=13)],
            },
            Expected {
                scalar: "fixed",
                // What is rounded on the way counts for more than the inputs do.
                forward: 1.0..4.0,
                closure: 2.0..8.0,
                without: &[
                    ("does not fit", 25..=35),
                    ("out of range of the number type", 0..=3),
                ],
            },
            Expected {
                scalar: "micromath",
                forward: 2e4..5e5,
                closure: 2e4..5e5,
                without: &[("unreachable", 4..=4)],
            },
        ]) {
            assert_eq!(column.scalar, expected.scalar);
            let cell = Cell::of(column.outcomes.iter());
            let without: Vec<_> = cell
                .others
                .iter()
                .map(|(kind, count)| (kind.as_str(), *count))
                .collect();
            let all = cell.ok + without.iter().map(|(_, count)| count).sum::<usize>();
            assert_eq!(all, cases.len(), "{}", column.scalar);
            let as_expected = without.iter().all(|(kind, count)| {
                let mut of_kind = expected.without.iter().filter(|(name, _)| name == kind);
                of_kind.any(|(_, counts)| counts.contains(count))
            });
            let missing = expected.without.iter().any(|(kind, counts)| {
                *counts.start() > 0 && !without.iter().any(|(name, _)| name == kind)
            });
            if !as_expected
                || missing
                || !expected.forward.contains(&cell.forward)
                || !expected.closure.contains(&cell.closure)
            {
                let found = (cell.forward, cell.closure, without);
                wrong.push(format!("{}: {found:?}", column.scalar));
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
