//! Tables of a report: Markdown for readers, CSV for programs.

use std::fmt::Write;

/// A table of texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub(crate) fn new(headings: &[&str]) -> Self {
        Self {
            headings: headings.iter().map(|&heading| heading.into()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row, which has as many cells as there are headings.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let cells: Vec<String> = cells.into_iter().collect();
        debug_assert_eq!(cells.len(), self.headings.len(), "{cells:?}");
        self.rows.push(cells);
    }

    /// As Markdown: numbers to the right, texts to the left, as the first row has them.
    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        let mut line = |cells: &mut dyn Iterator<Item = &str>| {
            let cells: Vec<&str> = cells.collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        };
        line(&mut self.headings.iter().map(String::as_str));
        let numeric = |column: usize| {
            let cell = self.rows.first().and_then(|row| row.get(column));
            cell.is_some_and(|cell| cell.starts_with(|first: char| first.is_ascii_digit()))
        };
        line(
            &mut (0..self.headings.len()).map(|column| match numeric(column) {
                true => "---:",
                false => "---",
            }),
        );
        for row in &self.rows {
            line(&mut row.iter().map(String::as_str));
        }
        text
    }

    /// The header and the rows, for a CSV file.
    pub(crate) fn records(&self) -> impl Iterator<Item = &Vec<String>> {
        std::iter::once(&self.headings).chain(&self.rows)
    }
}

/// Two significant digits: what a worst error is known to. Zero is `0`; from a hundredth to a
/// thousand there is no exponent.
pub(crate) fn two_digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (0.01..0.0995).contains(&size) => format!("{value:.3}"),
        size if (0.0995..0.995).contains(&size) => format!("{value:.2}"),
        size if (0.995..9.95).contains(&size) => format!("{value:.1}"),
        size if (9.95..999.5).contains(&size) => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_to_the_right() {
        let mut table = Table::new(&["name", "value"]);
        table.row(["a".into(), "1.5e-3".into()]);
        table.row(["b".into(), "none".into()]);
        assert_eq!(
            table.markdown(),
            "| name | value |\n| --- | ---: |\n| a | 1.5e-3 |\n| b | none |\n"
        );
        assert_eq!(table.records().count(), 3);
    }

    #[test]
    fn errors_have_two_digits() {
        assert_eq!(two_digits(1.26e-7), "1.3e-7");
        assert_eq!(two_digits(0.0), "0");
        for (value, text) in [
            (0.0123, "0.012"),
            (0.099_6, "0.10"),
            (-0.123, "-0.12"),
            (0.996, "1.0"),
            (2.44, "2.4"),
            (9.96, "10"),
            (123.4, "123"),
            (1234.0, "1.2e3"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(two_digits(value), text);
        }
    }
}
