//! Tables of cases: one machine and one instant in each row, in SI units.
//!
//! A header names the columns, in any order. The instant is a state, or a time within a move from
//! rest to rest.

mod columns;
mod row;

pub use columns::{Columns, other_separator};
pub use row::{Case, Fields, read};

/// Reads all rows of the table `text`, each with its label.
///
/// # Errors
/// The first column or value that cannot be used.
pub fn read_all(text: &str) -> Result<Vec<(String, Case<f64>)>, String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.byte_headers().map_err(|error| error.to_string())?;
    let columns = Columns::find(header)?;
    let mut cases = Vec::new();
    for row in reader.byte_records() {
        let row = row.map_err(|error| error.to_string())?;
        let label = String::from_utf8_lossy(columns.label(&row).unwrap_or_default()).into_owned();
        cases.push((label, read::<f64>(&columns, &row)?));
    }
    Ok(cases)
}
