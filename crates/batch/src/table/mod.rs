//! Tables of cases in, tables of results out: CSV or Arrow IPC files, in the order of the rows.
//!
//! A table is read in waves of chunks. All threads of rayon's current pool evaluate a wave while the one before is written
//! and the next one is read. Memory depends on the number of threads and on the longest row or Arrow batch, not on the number of rows.

mod arrow;
mod arrow_rows;
mod csv;
mod error;
mod format;
mod rows;

pub use error::TableError;
pub use format::{TableFormat, UnknownFormat};

use self::csv::{CsvSink, CsvSource};
use arrow::{ArrowSink, ArrowSource};
use rayon::prelude::*;
use rows::{Chunk, Evaluated};
use std::io::{self, Read, Seek, Write};
use trirrr_scene::cases::Columns;
use trirrr_scene::{NumberType, in_number_type};

/// Chunks of a wave for each thread: no thread is idle long while another one has rows that take longer.
const CHUNKS_PER_THREAD: usize = 4;

/// Rows of a table, and those of them with a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct RowCounts {
    /// Rows in the table.
    pub rows: usize,
    /// Rows with numbers.
    pub ok: usize,
    /// The reader of the results closed its end early: rows behind it do not count.
    pub is_cut: bool,
}

/// Table of cases, open for reading. `trirrr_scene::cases` has its columns.
pub struct Cases<'a> {
    source: Box<dyn Source + 'a>,
    columns: Columns,
}

/// Rows of a file, in order.
trait Source {
    /// Reads up to `count` chunks. None are left at the end of the file.
    fn chunks(&mut self, count: usize) -> Result<Vec<Chunk>, TableError>;
}

/// Results on their way into a file.
trait Sink {
    /// Encoded rows.
    type Part: Send;

    /// Encodes the rows of `chunk`, which `before` others precede. Results are binary32 or binary64 numbers.
    fn encode(before: usize, chunk: &Evaluated, binary32: bool) -> Result<Self::Part, TableError>;

    /// Writes encoded rows.
    fn write(&mut self, part: Self::Part) -> Result<(), TableError>;

    /// Writes all that stands behind the rows.
    fn finish(self) -> Result<(), TableError>;
}

impl<'a> Cases<'a> {
    /// Reads the header of a CSV table.
    ///
    /// # Errors
    /// [`TableError::Empty`], [`TableError::Columns`], [`TableError::Unreadable`].
    pub fn csv(input: impl Read + 'a) -> Result<Self, TableError> {
        let mut source = CsvSource::new(input, self::csv::CHUNK);
        let columns = Columns::find(&source.header()?).map_err(TableError::Columns)?;
        let source = Box::new(source);
        Ok(Self { source, columns })
    }

    /// Reads the schema of an Arrow IPC file. Numbers stand in columns of floats or of whole numbers, labels in
    /// columns of text or of whole numbers.
    ///
    /// # Errors
    /// [`TableError::NotArrow`], [`TableError::Columns`], [`TableError::ColumnType`].
    pub fn arrow(input: impl Read + Seek + 'a) -> Result<Self, TableError> {
        let (source, columns) = ArrowSource::open(input)?;
        let source = Box::new(source);
        Ok(Self { source, columns })
    }

    /// Evaluates all rows in `scalar` and writes them to `output` as `format`. Results of `f32` and `micromath` are
    /// written as binary32 numbers, those of the other number types as binary64.
    ///
    /// A reader of `output` that closes its end early (a broken pipe) ends the work without an error.
    ///
    /// # Errors
    /// [`TableError::Unreadable`], [`TableError::Unwritable`].
    pub fn evaluate(
        self,
        scalar: NumberType,
        format: TableFormat,
        output: &mut dyn Write,
    ) -> Result<RowCounts, TableError> {
        let mut counts = RowCounts::default();
        let done = match format {
            TableFormat::Csv => CsvSink::begin(output)
                .and_then(|sink| self.evaluate_into(scalar, sink, &mut counts)),
            TableFormat::Arrow => ArrowSink::begin(output, scalar.is_binary32())
                .and_then(|sink| self.evaluate_into(scalar, sink, &mut counts)),
        };
        match done {
            Err(TableError::Unwritable(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
                Ok(RowCounts {
                    is_cut: true,
                    ..counts
                })
            }
            other => other.map(|()| counts),
        }
    }

    /// Reads and writes on this thread while others evaluate.
    fn evaluate_into<S: Sink>(
        mut self,
        scalar: NumberType,
        mut sink: S,
        counts: &mut RowCounts,
    ) -> Result<(), TableError> {
        let wave = CHUNKS_PER_THREAD * rayon::current_num_threads();
        let columns = &self.columns;
        let mut parts = Vec::new();
        let mut chunks = self.source.chunks(wave);
        loop {
            let now = match chunks {
                Ok(now) if !now.is_empty() => now,
                end => {
                    write(&mut sink, parts)?;
                    end?;
                    return sink.finish();
                }
            };
            let before = std::mem::take(&mut parts);
            chunks = rayon::in_place_scope(|scope| {
                scope.spawn(|_| parts = evaluate_wave::<S>(now, scalar, columns, counts));
                write(&mut sink, before)?;
                Ok(self.source.chunks(wave))
            })?;
        }
    }
}

fn write<S: Sink>(sink: &mut S, parts: Vec<Result<S::Part, TableError>>) -> Result<(), TableError> {
    parts.into_iter().try_for_each(|part| sink.write(part?))
}

/// Evaluates and encodes chunks, in order.
fn evaluate_wave<S: Sink>(
    chunks: Vec<Chunk>,
    scalar: NumberType,
    columns: &Columns,
    counts: &mut RowCounts,
) -> Vec<Result<S::Part, TableError>> {
    let evaluate = |chunk: Chunk| in_number_type!(scalar, N => chunk.evaluate::<N>(columns));
    let evaluated: Vec<Evaluated> = chunks.into_par_iter().map(evaluate).collect();
    // A row without a label bears its number, so that the rows before it are counted first.
    let numbered: Vec<(usize, &Evaluated)> = evaluated
        .iter()
        .map(|chunk| {
            let before = counts.rows;
            counts.rows += chunk.outcomes.len();
            counts.ok += chunk.outcomes.iter().filter(|row| row.is_ok()).count();
            (before, chunk)
        })
        .collect();
    let encode = |(before, chunk)| S::encode(before, chunk, scalar.is_binary32());
    numbered.into_par_iter().map(encode).collect()
}
