//! CSV tables of numbers with a row of names: separators, cells and faults, as measurements and telemetry have them.

use std::fmt;
use trirrr_scene::cases::other_separator;

/// Something that is wrong with a table: line, column, reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnFault {
    /// Line in the file, from 1; 0 where it is the file as a whole.
    pub line: u32,
    /// Name of the column; empty where it is the line as a whole.
    pub column: String,
    /// Reason, with what would do.
    pub reason: String,
}

impl fmt::Display for ColumnFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "{}:", self.line)?;
        }
        if !self.column.is_empty() {
            write!(f, " {}:", self.column)?;
        }
        write!(f, " {}", self.reason)
    }
}

impl ColumnFault {
    pub(crate) fn of_line(line: u32, reason: impl Into<String>) -> Self {
        Self {
            line,
            column: String::new(),
            reason: reason.into(),
        }
    }

    pub(crate) fn of_column(column: &str, reason: impl Into<String>) -> Self {
        Self {
            line: 1,
            column: column.to_owned(),
            reason: reason.into(),
        }
    }
}

/// A table with its cells as text.
pub(crate) struct CellTable {
    pub(crate) names: Vec<String>,
    /// Line and cells of each row.
    pub(crate) rows: Vec<(u32, csv::StringRecord)>,
}

impl CellTable {
    /// Reads `text`. Rows that begin with `#` are comments.
    ///
    /// # Errors
    /// No table, another separator than commas, a row with more or fewer cells than names, two columns of one name.
    pub(crate) fn read(text: &str) -> Result<Self, ColumnFault> {
        // Spreadsheets put a mark of the encoding first.
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let unread = |error: csv::Error| {
            let line = error.position().map_or(0, |place| place.line() as u32);
            ColumnFault::of_line(line, format!("no table: {error}"))
        };
        let header = reader.headers().map_err(unread)?;
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        if let [only] = &names[..]
            && let Some(reason) = other_separator(only)
        {
            return Err(ColumnFault::of_line(1, reason));
        }
        for (index, name) in names.iter().enumerate() {
            if !name.is_empty() && names[..index].contains(name) {
                return Err(ColumnFault::of_column(name, "two columns have this name"));
            }
        }
        let mut rows = Vec::new();
        for row in reader.into_records() {
            let row = row.map_err(unread)?;
            let line = row.position().map_or(0, |place| line_of(text, place));
            if row.len() != names.len() {
                let reason = format!(
                    "{} cells, and the table has {} columns; with decimal commas in it, write decimal points",
                    row.len(),
                    names.len()
                );
                return Err(ColumnFault::of_line(line, reason));
            }
            rows.push((line, row));
        }
        Ok(Self { names, rows })
    }

    /// Place of the column `name`.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|other| other == name)
    }

    /// Number in a cell; none where it is empty.
    ///
    /// # Errors
    /// The cell is no finite number of at most 1e9.
    pub(crate) fn number(
        &self,
        (line, row): &(u32, csv::StringRecord),
        place: usize,
    ) -> Result<Option<f64>, ColumnFault> {
        let cell = row.get(place).unwrap_or_default();
        if cell.is_empty() {
            return Ok(None);
        }
        let reason = match cell.parse::<f64>() {
            Ok(value) if value.abs() <= 1e9 => return Ok(Some(value)),
            Ok(_) => format!("{cell:?} is no finite number of at most 1e9"),
            Err(_) if cell.replace(',', ".").parse::<f64>().is_ok() => {
                format!("{cell:?} has a decimal comma; write a decimal point")
            }
            Err(_) => format!("{cell:?} is no number"),
        };
        Err(ColumnFault {
            line: *line,
            column: self.names[place].clone(),
            reason,
        })
    }
}

/// Line of a row. The reader's place is before the empty rows and comments above it.
fn line_of(text: &str, place: &csv::Position) -> u32 {
    let from = text.get(place.byte() as usize..).unwrap_or_default();
    let above = |line: &&str| line.trim().is_empty() || line.starts_with('#');
    (place.line() as usize + from.lines().take_while(above).count()) as u32
}
