//! Reference files: CSV tables with named columns of numbers. `tests/reference/README.md` says
//! what each one holds.

use crate::double_double::DoubleDouble;
use std::collections::HashMap;
use std::path::Path;

/// A reference file in memory.
pub struct Table {
    columns: HashMap<String, usize>,
    rows: Vec<csv::StringRecord>,
}

/// One row of a [`Table`].
#[derive(Clone, Copy)]
pub struct Row<'a> {
    table: &'a Table,
    cells: &'a csv::StringRecord,
}

impl Table {
    /// Reads `tests/reference/<name>`.
    ///
    /// # Panics
    /// When the file is missing or no table: a test cannot go on without it.
    pub fn read(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("reference")
            .join(name);
        let mut reader = csv::Reader::from_path(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let header = reader.headers().expect("a header").clone();
        let rows: Vec<_> = reader
            .records()
            .map(|row| row.unwrap_or_else(|error| panic!("{}: {error}", path.display())))
            .collect();
        assert!(!rows.is_empty(), "{} holds no rows", path.display());
        Self {
            columns: header.iter().map(str::to_owned).zip(0..).collect(),
            rows,
        }
    }

    /// The rows in file order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }
}

impl<'a> Row<'a> {
    /// The text in `column`.
    ///
    /// # Panics
    /// When there is no such column.
    pub fn text(&self, column: &str) -> &'a str {
        let index = self
            .table
            .columns
            .get(column)
            .unwrap_or_else(|| panic!("no column {column}"));
        &self.cells[*index]
    }

    /// The number in `column`, rounded to the nearest `f64`.
    ///
    /// # Panics
    /// When there is no such column or it holds no number.
    pub fn number(&self, column: &str) -> f64 {
        let text = self.text(column);
        text.parse()
            .unwrap_or_else(|_| panic!("{column}: {text:?} is no number"))
    }

    /// The number in `column` with all its digits; `None` when there is no such column.
    ///
    /// # Panics
    /// When it holds no number.
    pub fn exact(&self, column: &str) -> Option<DoubleDouble> {
        self.table.columns.contains_key(column).then(|| {
            let text = self.text(column);
            DoubleDouble::parse(text).unwrap_or_else(|| panic!("{column}: {text:?} is no number"))
        })
    }

    /// The numbers in `<stem>1` to `<stem>3`.
    pub fn three(&self, stem: &str) -> [f64; 3] {
        [1, 2, 3].map(|leg| self.number(&format!("{stem}{leg}")))
    }
}
