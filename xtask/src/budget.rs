//! Measured figures, checked in: a figure that moves is seen in the change that moves it.

use crate::cores::{self, CORES, Core};
use crate::image::scalars;
use crate::repository::{self, SceneFile, compiler, root};
use crate::table::table;
use anyhow::{Context, Result, bail};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// Largest relative change of a figure that need not be looked at.
pub(crate) const TOLERANCE: f64 = 0.02;

/// Options of every chore that measures scenes.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Print one JSON array of flat objects in place of the table
    #[arg(long)]
    json: bool,
    /// A scene, by name or file; repeat for more; without it, every scene in scenes/
    #[arg(long)]
    scene: Vec<String>,
    /// Measure each scene in the number type of its image only
    #[arg(long)]
    own: bool,
    /// m4f, m3, m0 or rv32imc; repeat for more; without it, all that the chore measures on
    #[arg(long)]
    core: Vec<String>,
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

    /// Returns true if no scene is named: all are measured.
    pub(crate) fn names_none(&self) -> bool {
        self.scene.is_empty()
    }

    /// The number types to measure `scene` in.
    pub(crate) fn scalars(&self, scene: &Scene) -> Vec<&'static str> {
        match self.own {
            true => vec![of_scene(scene.number)],
            false => scalars(scene),
        }
    }

    /// The cores to measure on.
    pub(crate) fn cores(&self) -> Result<Vec<&'static Core>> {
        cores_named(&self.core)
    }

    /// Prints what was measured: as JSON, or as a table.
    pub(crate) fn print<Row: BudgetRow>(&self, rows: &[Row]) -> Result<()> {
        if self.json {
            println!("{}", serde_json::to_string_pretty(rows)?);
            return Ok(());
        }
        let headings: Vec<&str> = Row::COLUMNS.split(' ').collect();
        let cells = rows.iter().map(|row| {
            let row = row.fields();
            let cell = |name: &&str| match &row[*name] {
                Value::String(text) => text.clone(),
                // As `f64`, a whole number is shown without a fraction.
                number => number
                    .as_f64()
                    .map_or("-".into(), |value| value.to_string()),
            };
            headings.iter().map(cell).collect()
        });
        print!("{}", table(&headings, &cells.collect::<Vec<_>>()));
        Ok(())
    }

    /// Compares `rows` with what is checked in as `name`, or checks them in, as asked.
    pub(crate) fn settle<Row: BudgetRow>(&self, name: &str, rows: Vec<Row>) -> Result<()> {
        if self.check {
            check(name, &rows)?;
        }
        if self.bless {
            let all = self.core.is_empty() && self.scene.is_empty() && !self.own;
            bless(name, rows, all)?;
        }
        Ok(())
    }
}

fn cores_named(names: &[String]) -> Result<Vec<&'static Core>> {
    if names.is_empty() {
        return Ok(CORES.iter().collect());
    }
    let known: Vec<&str> = CORES.iter().map(|core| core.name).collect();
    let of = |name: &String| {
        cores::named(name).with_context(|| format!("{name}: no such core ({})", known.join(", ")))
    };
    names.iter().map(of).collect()
}

/// A row of figures that can be told from other rows. Constants list fields, parted by spaces.
pub(crate) trait BudgetRow: Serialize + DeserializeOwned {
    /// Fields that name what was measured, such as `core scalar scene`.
    const KEY: &str;
    /// Figures that are held to what is checked in.
    const FIGURES: &str;
    /// Columns of the table.
    const COLUMNS: &str;

    /// The row's fields by name; `null` is what the row does not have.
    fn fields(&self) -> Value {
        serde_json::to_value(self).expect("a row is plain data")
    }

    /// Largest relative change of the row's figures that need not be looked at.
    fn tolerance(&self) -> f64 {
        TOLERANCE
    }

    /// Names what was measured, such as `m4f f32 thesis`.
    fn key(&self) -> String {
        let fields = self.fields();
        let words = Self::KEY
            .split(' ')
            .filter_map(|name| fields[name].as_str());
        words.collect::<Vec<_>>().join(" ")
    }

    /// The figures that the row has, by name.
    fn figures(&self) -> Vec<(&'static str, f64)> {
        let fields = self.fields();
        let figures = Self::FIGURES.split(' ');
        figures
            .filter_map(|name| Some((name, fields[name].as_f64()?)))
            .collect()
    }
}

/// A figure that no change may take above a bound, whatever is checked in.
pub(crate) struct Ceiling {
    /// Key of the rows; `*` stands for any word.
    pub(crate) key: &'static str,
    pub(crate) figure: &'static str,
    pub(crate) most: f64,
}

impl Ceiling {
    pub(crate) const fn new(key: &'static str, figure: &'static str, most: f64) -> Self {
        Self { key, figure, most }
    }

    fn is_of(&self, key: &str) -> bool {
        let agree = |(pattern, word): (&str, &str)| pattern == "*" || pattern == word;
        self.key.split(' ').zip(key.split(' ')).all(agree)
    }
}

/// Checks that no figure of `rows` is above its ceiling: the one that names the row most closely.
pub(crate) fn hold_ceilings<Row: BudgetRow>(rows: &[Row], ceilings: &[Ceiling]) -> Result<()> {
    for row in rows {
        let key = row.key();
        let of_row: Vec<&Ceiling> = ceilings.iter().filter(|one| one.is_of(&key)).collect();
        for Ceiling {
            key: pattern,
            figure,
            most,
        } in &of_row
        {
            let open = |pattern: &str| pattern.matches('*').count();
            let closer = |one: &&Ceiling| one.figure == *figure && open(one.key) < open(pattern);
            if of_row.iter().any(closer) {
                continue;
            }
            let figures = row.figures();
            let found = figures.iter().find(|(name, _)| name == figure);
            if let Some((_, value)) = found.filter(|(_, value)| value > most) {
                bail!("{key}: {figure} is {value}, the ceiling is {most}");
            }
        }
    }
    Ok(())
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

/// Reads what is checked in as `name`.
fn read<Row: DeserializeOwned>(name: &str) -> Result<Budget<Row>> {
    let file = file(name);
    let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    serde_json::from_str(&text).with_context(|| file.display().to_string())
}

/// Compares `measured` with what is checked in as `name`.
fn check<Row: BudgetRow>(name: &str, measured: &[Row]) -> Result<()> {
    let budget: Budget<Row> = read(name)?;
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
        file(name).display()
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
        if now > then * (1.0 + row.tolerance()) {
            complaints.push(format!(
                "{key}: {name} grew from {then} to {now} ({change:+.1} %)"
            ));
        } else if now < then * (1.0 - row.tolerance()) {
            complaints.push(format!(
                "{key}: {name} shrank from {then} to {now} ({change:+.1} %): refresh the figures"
            ));
        }
    }
    complaints
}

/// The rows that are checked in as `name`.
pub(crate) fn checked_in<Row: DeserializeOwned>(name: &str) -> Result<Vec<Row>> {
    Ok(read(name)?.rows)
}

/// Fails if a ceiling is of nothing that is checked in as `name`: a word that is mistyped would hold nothing.
#[cfg(test)]
pub(crate) fn expect_measured<Row: BudgetRow>(name: &str, ceilings: &[Ceiling]) {
    let rows: Vec<Row> = checked_in(name).expect("the file of figures");
    for ceiling in ceilings {
        let measured = rows.iter().any(|row| {
            let mut figures = row.figures().into_iter();
            ceiling.is_of(&row.key()) && figures.any(|(figure, _)| figure == ceiling.figure)
        });
        assert!(measured, "{}: {}", ceiling.key, ceiling.figure);
    }
}

/// Checks `rows` in as `name`. Rows of what was not measured stay, unless `everything` was.
fn bless<Row: BudgetRow>(name: &str, mut rows: Vec<Row>, everything: bool) -> Result<()> {
    let file = file(name);
    if !everything && file.exists() {
        let new: Vec<String> = rows.iter().map(BudgetRow::key).collect();
        let old = checked_in::<Row>(name)?.into_iter();
        rows.extend(old.filter(|row| !new.contains(&row.key())));
    }
    rows.sort_by_cached_key(BudgetRow::key);
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
    struct Row {
        core: String,
        max: f64,
    }

    impl BudgetRow for Row {
        const KEY: &str = "core";
        const FIGURES: &str = "max";
        const COLUMNS: &str = "core max";
    }

    fn row(core: &str, max: f64) -> Row {
        Row {
            core: core.into(),
            max,
        }
    }

    fn complaints(then: f64, now: f64) -> Vec<String> {
        compare(&[row("a", then)], &row("a", now))
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
        let found = compare(&[row("a", 1.0)], &row("b", 1.0));
        assert_eq!(found, ["b: no figures are checked in"]);
    }

    #[test]
    fn the_file_reads_back_as_written() {
        let budget = Budget {
            rustc: "rustc 1.95.0".into(),
            rows: vec![row("a", 1.5), row("b", 2.0)],
        };
        let text = to_text(&budget).expect("plain data");
        assert_eq!(
            text.lines()
                .filter(|line| line.starts_with("    {"))
                .count(),
            2
        );
        let back: Budget<Row> = serde_json::from_str(&text).expect("is JSON");
        assert_eq!((back.rows[1].core.as_str(), back.rows[1].max), ("b", 2.0));
    }

    #[test]
    fn an_unknown_core_is_refused_with_the_known_ones() {
        let error = cores_named(&["m7".into()]).expect_err("not emulated here");
        assert_eq!(error.to_string(), "m7: no such core (m4f, m3, m0, rv32imc)");
    }

    #[test]
    fn a_star_in_a_ceiling_stands_for_any_word() {
        let ceilings = [Ceiling::new("m4f * thesis", "max", 600.0)];
        let held = |core: &str, max| hold_ceilings(&[row(core, max)], &ceilings);
        assert!(held("m4f f32 thesis", 600.0).is_ok());
        assert!(held("m4f f32 thesis-links", 601.0).is_ok());
        assert_eq!(
            held("m4f f32 thesis", 601.0)
                .expect_err("above it")
                .to_string(),
            "m4f f32 thesis: max is 601, the ceiling is 600"
        );
    }
}
