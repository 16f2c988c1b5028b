//! Measured figures, checked in: a figure that moves is seen in the change that moves it.

use crate::repository::{self, SceneFile, compiler, root};
use anyhow::{Context, Result, bail};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::PathBuf;

/// Largest relative change of a figure that need not be looked at.
const TOLERANCE: f64 = 0.02;

/// Options of every chore that measures scenes.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Print one JSON array of flat objects in place of the table
    #[arg(long)]
    json: bool,
    /// A scene, by name or file; repeat for more; without it, every scene in scenes/
    #[arg(long)]
    scene: Vec<String>,
    /// Fail where a figure moved by more than 2 % from what is checked in in xtask/budgets
    #[arg(long, conflicts_with = "bless")]
    check: bool,
    /// Write the figures to xtask/budgets
    #[arg(long)]
    bless: bool,
}

impl Options {
    /// The scenes to measure.
    pub(crate) fn scenes(&self) -> Result<Vec<SceneFile>> {
        repository::scenes_named(&self.scene)
    }

    /// Prints what was measured: as JSON, or as `text` lays it out.
    pub(crate) fn print<Row: Serialize>(
        &self,
        rows: &[Row],
        text: impl FnOnce(&[Row]) -> String,
    ) -> Result<()> {
        if self.json {
            println!("{}", serde_json::to_string_pretty(rows)?);
        } else {
            print!("{}", text(rows));
        }
        Ok(())
    }

    /// Compares `rows` with what is checked in as `name`, or checks them in, as asked.
    /// `all_parts`: of each scene, everything was measured.
    pub(crate) fn settle<Row>(&self, name: &str, rows: Vec<Row>, all_parts: bool) -> Result<()>
    where
        Row: BudgetRow + Serialize + DeserializeOwned,
    {
        if self.check {
            check(name, &rows)?;
        }
        if self.bless {
            bless(name, rows, all_parts && self.scene.is_empty())?;
        }
        Ok(())
    }
}

/// A row of figures that can be told from other rows.
pub(crate) trait BudgetRow {
    /// Names what was measured, such as `m4f f32 thesis`.
    fn key(&self) -> String;
    /// The figures by name.
    fn figures(&self) -> Vec<(&'static str, f64)>;
}

/// A checked-in file of rows.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Budget<Row> {
    /// The compiler that they were measured with.
    rustc: String,
    rows: Vec<Row>,
}

/// `xtask/budgets/NAME.json`.
fn file(name: &str) -> PathBuf {
    root()
        .join("xtask/budgets")
        .join(name)
        .with_extension("json")
}

/// Compares `measured` with what is checked in as `name`.
fn check<Row: BudgetRow + DeserializeOwned>(name: &str, measured: &[Row]) -> Result<()> {
    let file = file(name);
    let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let budget: Budget<Row> =
        serde_json::from_str(&text).with_context(|| file.display().to_string())?;
    let complaints: Vec<String> = measured
        .iter()
        .flat_map(|row| compare(&budget.rows, row))
        .collect();
    if complaints.is_empty() {
        return Ok(());
    }
    let now = compiler()?;
    let other_compiler = if now == budget.rustc {
        String::new()
    } else {
        format!("\n(measured with {now}, checked in with {})", budget.rustc)
    };
    bail!(
        "{}{other_compiler}\nWhere this is meant: cargo xtask {name} --bless, and commit {}",
        complaints.join("\n"),
        file.display()
    )
}

/// Returns what is wrong with `row`, given the rows that are checked in.
fn compare<Row: BudgetRow>(budget: &[Row], row: &Row) -> Vec<String> {
    let key = row.key();
    let Some(expected) = budget.iter().find(|other| other.key() == key) else {
        return vec![format!("{key}: no figures are checked in")];
    };
    let mut complaints = Vec::new();
    let expected = expected.figures();
    for (name, now) in row.figures() {
        let Some((_, then)) = expected.iter().find(|(other, _)| *other == name) else {
            complaints.push(format!("{key}: no {name} is checked in"));
            continue;
        };
        let change = 100.0 * (now - then) / then;
        if now > then * (1.0 + TOLERANCE) {
            complaints.push(format!(
                "{key}: {name} grew from {then} to {now} ({change:+.1} %)"
            ));
        } else if now < then * (1.0 - TOLERANCE) {
            complaints.push(format!(
                "{key}: {name} shrank from {then} to {now} ({change:+.1} %): refresh the figures"
            ));
        }
    }
    complaints
}

/// The rows that are checked in as `name`.
pub(crate) fn checked_in<Row: DeserializeOwned>(name: &str) -> Result<Vec<Row>> {
    let budget: Budget<Row> = serde_json::from_str(&fs::read_to_string(file(name))?)?;
    Ok(budget.rows)
}

/// Checks `measured` in as `name`. Rows of what was not measured stay, unless `everything` was.
fn bless<Row>(name: &str, measured: Vec<Row>, everything: bool) -> Result<()>
where
    Row: BudgetRow + Serialize + DeserializeOwned,
{
    let file = file(name);
    let mut rows = measured;
    if !everything && file.exists() {
        let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        let old: Budget<Row> =
            serde_json::from_str(&text).with_context(|| file.display().to_string())?;
        let new: Vec<String> = rows.iter().map(BudgetRow::key).collect();
        rows.extend(old.rows.into_iter().filter(|row| !new.contains(&row.key())));
    }
    rows.sort_by_key(BudgetRow::key);
    let budget = Budget {
        rustc: compiler()?,
        rows,
    };
    fs::write(&file, to_text(&budget)?).with_context(|| file.display().to_string())?;
    eprintln!("wrote {}", file.display());
    Ok(())
}

/// JSON with one row per line, so that a difference between two versions reads as a table.
fn to_text<Row: Serialize>(budget: &Budget<Row>) -> Result<String> {
    let rows: Vec<String> = budget
        .rows
        .iter()
        .map(|row| Ok(format!("    {}", serde_json::to_string(row)?)))
        .collect::<Result<_>>()?;
    let rustc = serde_json::to_string(&budget.rustc)?;
    Ok(format!(
        "{{\n  \"rustc\": {rustc},\n  \"rows\": [\n{}\n  ]\n}}\n",
        rows.join(",\n")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Serialize, Deserialize)]
    struct Row(String, f64);

    impl BudgetRow for Row {
        fn key(&self) -> String {
            self.0.clone()
        }
        fn figures(&self) -> Vec<(&'static str, f64)> {
            vec![("max", self.1)]
        }
    }

    fn complaints(then: f64, now: f64) -> Vec<String> {
        compare(&[Row("a".into(), then)], &Row("a".into(), now))
    }

    #[test]
    fn two_percent_either_way_pass() {
        for now in [500.0, 490.0, 510.0] {
            assert!(complaints(500.0, now).is_empty(), "{now}");
        }
    }

    #[test]
    fn more_than_that_is_named_with_its_direction() {
        assert_eq!(
            complaints(500.0, 511.0),
            ["a: max grew from 500 to 511 (+2.2 %)"]
        );
        assert_eq!(
            complaints(500.0, 489.0),
            ["a: max shrank from 500 to 489 (-2.2 %): refresh the figures"]
        );
        // From nothing, anything is growth.
        assert_eq!(complaints(0.0, 4.0).len(), 1);
    }

    #[test]
    fn a_row_that_is_not_checked_in_is_an_error() {
        let found = compare(&[Row("a".into(), 1.0)], &Row("b".into(), 1.0));
        assert_eq!(found, ["b: no figures are checked in"]);
    }

    #[test]
    fn the_file_reads_back_as_written() {
        let budget = Budget {
            rustc: "rustc 1.95.0".into(),
            rows: vec![Row("a".into(), 1.5), Row("b".into(), 2.0)],
        };
        let text = to_text(&budget).expect("plain data");
        assert_eq!(
            text.lines()
                .filter(|line| line.starts_with("    ["))
                .count(),
            2
        );
        let back: Budget<Row> = serde_json::from_str(&text).expect("is JSON");
        assert_eq!((back.rows[1].0.as_str(), back.rows[1].1), ("b", 2.0));
    }
}
