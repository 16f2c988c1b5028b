//! Evaluates a table of machines and states, CSV or Arrow by the endings of the files, and prints rows per second.
//! Without files, evaluates a table of the repository and throws the results away.
//!
//! `cargo run --release -p trirrr-batch --example evaluate_table -- CASES.csv RESULTS.arrow`

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use std::time::Instant;
use trirrr_batch::table::{Cases, TableFormat};
use trirrr_scene::NumberType;

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let own = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/reference/extreme.csv"
    );
    let (cases, results): (PathBuf, Option<&PathBuf>) = match files.as_slice() {
        [] => (own.into(), None),
        [cases, results] => (cases.clone(), Some(results)),
        _ => return Err("expected a table of cases and a file for the results".into()),
    };
    let start = Instant::now();
    let input = File::open(&cases)?;
    let table = match TableFormat::of(&cases)? {
        TableFormat::Csv => Cases::csv(input)?,
        TableFormat::Arrow => Cases::arrow(input)?,
    };
    let counts = match results {
        Some(results) => {
            let output = &mut BufWriter::new(File::create(results)?);
            table.evaluate(NumberType::F64, TableFormat::of(results)?, output)?
        }
        None => table.evaluate(NumberType::F64, TableFormat::Csv, &mut std::io::sink())?,
    };
    let rate = counts.rows as f64 / start.elapsed().as_secs_f64();
    println!("{} of {} rows ok, {rate:.0} rows/s", counts.ok, counts.rows);
    Ok(())
}
