//! Rows as text: the first columns are names and stand left, numbers stand right.

/// The rows under their headings, as wide as they need.
pub(crate) fn table(headings: &[&str], rows: &[Vec<String>]) -> String {
    let mut widths: Vec<usize> = headings.iter().map(|heading| heading.len()).collect();
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.len());
        }
    }
    let line = |cells: Vec<&str>| {
        let mut text = String::new();
        for (cell, &width) in cells.iter().zip(&widths) {
            let numeric = cell.starts_with(|c: char| c.is_ascii_digit());
            let cell = if numeric {
                format!("{cell:>width$}")
            } else {
                format!("{cell:<width$}")
            };
            text.push_str(&cell);
            text.push_str("  ");
        }
        text.trim_end().to_owned() + "\n"
    };
    let mut text = line(headings.to_vec());
    for row in rows {
        text.push_str(&line(row.iter().map(String::as_str).collect()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_left_and_numbers_right() {
        let rows = [
            vec!["m4f".into(), "9.5".into()],
            vec!["rv32imc".into(), "1234.0".into()],
        ];
        assert_eq!(
            table(&["core", "mean"], &rows),
            "core     mean\nm4f         9.5\nrv32imc  1234.0\n"
        );
    }
}
