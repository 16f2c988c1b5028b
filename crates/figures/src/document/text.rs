//! A document as lines for a terminal.

use super::facts::Fact;
use super::quantity::{number, readable};
use super::{Document, DocumentPart, Facts, Reader};

/// Least width of the column of labels.
const LABELS: usize = 12;

/// TextColumn of a table: its head, and a cell for each row.
pub(super) struct TextColumn {
    pub(super) head: String,
    pub(super) cells: Vec<String>,
    pub(super) is_number: bool,
}

/// Columns of `rows` that `reader` sees; those without a value are left out.
pub(super) fn columns(rows: &[Facts], reader: Reader) -> Vec<TextColumn> {
    let mut labels: Vec<&str> = Vec::new();
    for field in rows.iter().flat_map(|row| row.shown(reader)) {
        if !labels.contains(&&*field.label) {
            labels.push(&field.label);
        }
    }
    let columns = labels.into_iter().map(|label| {
        let cell = |row| Facts::shown(row, reader).find(|field| field.label == label);
        column(label, &rows.iter().map(cell).collect::<Vec<_>>())
    });
    columns
        .filter(|column| column.cells.iter().any(|cell| cell != "-"))
        .collect()
}

fn column(label: &str, fields: &[Option<&Fact>]) -> TextColumn {
    let words = |field: &Option<&Fact>| {
        let text = field
            .map(|field| field.lines().join(" "))
            .unwrap_or_default();
        if text.is_empty() { "-".into() } else { text }
    };
    let cells: Vec<String> = fields.iter().map(words).collect();
    let numbers: Vec<_> = fields
        .iter()
        .map(|field| field.and_then(Fact::number))
        .collect();
    let known: Vec<_> = numbers.iter().flatten().collect();
    let is_number = !known.is_empty()
        && known.iter().all(|(_, unit)| *unit == known[0].1)
        && numbers
            .iter()
            .zip(&cells)
            .all(|(number, cell)| number.is_some() || cell == "-");
    if !is_number {
        return TextColumn {
            head: label.into(),
            cells,
            is_number,
        };
    }
    let size = known
        .iter()
        .map(|(value, _)| value.abs())
        .fold(0.0, f64::max);
    let decimals = fields.iter().flatten().find_map(|field| field.decimals);
    let (factor, unit) = match decimals {
        Some(_) => (1.0, known[0].1),
        None => readable(known[0].1, size),
    };
    let cell = |of: &Option<(f64, _)>| match (of, decimals) {
        (None, _) => "-".into(),
        (Some((value, _)), Some(decimals)) => format!("{value:.decimals$}"),
        (Some((value, _)), None) => number(factor * value, unit),
    };
    let head = if unit.is_empty() {
        label.to_owned()
    } else {
        format!("{label}, {unit}")
    };
    TextColumn {
        head,
        cells: numbers.iter().map(cell).collect(),
        is_number,
    }
}

/// Escapes what would end the line or command the terminal.
fn shown(text: &str) -> String {
    let escape = |c: char| match c.is_control() {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    text.chars().map(escape).collect()
}

impl Document {
    /// Lines of the document.
    pub fn text(&self) -> String {
        let width = self.label_width();
        let mut text = String::new();
        let mut is_heading = false;
        for (_, section) in self
            .sections
            .iter()
            .filter(|(reader, _)| *reader == Reader::Terminal)
        {
            let part = match section {
                DocumentPart::Heading(text) | DocumentPart::Note(text) => shown(text) + "\n",
                DocumentPart::Pairs { facts, .. } => pairs(facts, width),
                DocumentPart::Table { rows, .. } => table(rows),
                DocumentPart::Figure(_) => String::new(),
                DocumentPart::Files(files) => {
                    let files = files.iter().map(|file| file.display().to_string());
                    pairs(&Facts::new().text("written", Vec::from_iter(files)), width)
                }
            };
            if part.is_empty() {
                continue;
            }
            // A heading and a note belong to their neighbours.
            let joins = is_heading || matches!(section, DocumentPart::Note(_));
            text += if text.is_empty() || joins { "" } else { "\n" };
            text += &part;
            is_heading = matches!(section, DocumentPart::Heading(_));
        }
        text
    }

    fn label_width(&self) -> usize {
        let pairs = self
            .sections
            .iter()
            .filter_map(|(_, section)| match section {
                DocumentPart::Pairs { facts, .. } => Some(facts.shown(Reader::Terminal)),
                _ => None,
            });
        let labels = pairs.flatten().filter(|field| !field.lines().is_empty());
        let widest = labels.map(|field| field.label.chars().count() + 1).max();
        widest.unwrap_or(0).max(LABELS)
    }
}

fn pairs(facts: &Facts, width: usize) -> String {
    let mut text = String::new();
    for field in facts.shown(Reader::Terminal) {
        let labels = [&*field.label].into_iter().chain(std::iter::repeat(""));
        for (label, line) in labels.zip(field.lines()) {
            let line = format!("{label:<width$}{}", shown(&line));
            text += line.trim_end();
            text.push('\n');
        }
    }
    text
}

fn table(rows: &[Facts]) -> String {
    let mut rows = rows.to_vec();
    rows.retain(|row| row.shown(Reader::Terminal).next().is_some());
    let is_marked = rows.iter().any(|row| row.is_marked);
    let mut lines: Vec<String> = [false]
        .into_iter()
        .chain(rows.iter().map(|row| row.is_marked))
        .map(|own| match own {
            _ if !is_marked => String::new(),
            true => "* ".into(),
            false => "  ".into(),
        })
        .collect();
    for column in columns(&rows, Reader::Terminal) {
        let cells: Vec<String> = [&column.head]
            .into_iter()
            .chain(&column.cells)
            .map(|cell| shown(cell))
            .collect();
        let width = cells
            .iter()
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0);
        for (line, cell) in lines.iter_mut().zip(cells) {
            *line += &match column.is_number {
                true => format!("{cell:>width$}  "),
                false => format!("{cell:<width$}  "),
            };
        }
    }
    // A table without columns for the terminal has no lines either.
    let lines = lines
        .iter()
        .map(|line| line.trim_end())
        .filter(|line| !line.is_empty());
    lines.map(|line| format!("{line}\n")).collect()
}
