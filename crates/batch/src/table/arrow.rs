//! Arrow IPC files: batches cut into chunks of rows, and results as batches.

use super::arrow_rows::ArrowRows;
use super::rows::{Chunk, Evaluated};
use super::{Sink, Source, TableError};
use arrow_array::{ArrayRef, Float32Array, Float64Array, RecordBatch, StringArray};
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use csv::ByteRecord;
use std::io::{Read, Seek, Write};
use std::sync::Arc;
use trirrr_scene::cases::Columns;
use trirrr_scene::record::RESULT_COLUMNS;

/// Rows of a chunk.
const CHUNK: usize = 1 << 11;

/// Chunks of an Arrow IPC file.
pub(super) struct ArrowSource<R: Read + Seek> {
    batches: FileReader<R>,
    /// Rows of a batch that are not yet handed out.
    pending: Option<RecordBatch>,
}

impl<R: Read + Seek> ArrowSource<R> {
    /// Reads the schema and finds the columns.
    pub(super) fn open(input: R) -> Result<(Self, Columns), TableError> {
        let batches = FileReader::try_new(input, None)
            .map_err(|error| TableError::NotArrow(error.to_string()))?;
        let schema = batches.schema();
        let header: Vec<&str> = schema
            .fields()
            .iter()
            .map(|field| field.name().as_str())
            .collect();
        let columns = Columns::find(&ByteRecord::from(header)).map_err(TableError::Columns)?;
        for (name, index) in columns.numbers() {
            check(
                &schema,
                name,
                index,
                holds_numbers,
                "floats or whole numbers",
            )?;
        }
        if let Some(index) = columns.label_index() {
            check(
                &schema,
                "case",
                index,
                holds_labels,
                "text or whole numbers",
            )?;
        }
        let source = Self {
            batches,
            pending: None,
        };
        Ok((source, columns))
    }
}

fn check(
    schema: &Schema,
    name: &str,
    index: usize,
    holds: impl Fn(&DataType) -> bool,
    expected: &'static str,
) -> Result<(), TableError> {
    let found = schema.field(index).data_type();
    match holds(found) {
        true => Ok(()),
        false => Err(TableError::ColumnType {
            column: name.into(),
            found: found.to_string(),
            expected,
        }),
    }
}

fn holds_numbers(data: &DataType) -> bool {
    data.is_integer() || matches!(data, DataType::Float32 | DataType::Float64)
}

fn holds_labels(data: &DataType) -> bool {
    use DataType::{LargeUtf8, Utf8, Utf8View};
    data.is_integer() || matches!(data, Utf8 | LargeUtf8 | Utf8View)
}

impl<R: Read + Seek> Source for ArrowSource<R> {
    fn chunks(&mut self, count: usize) -> Result<Vec<Chunk>, TableError> {
        let mut chunks = Vec::with_capacity(count);
        while chunks.len() < count {
            let batch = match self.pending.take() {
                Some(batch) => batch,
                None => match self.batches.next() {
                    Some(batch) => {
                        batch.map_err(|error| TableError::Unreadable(error.to_string()))?
                    }
                    None => break,
                },
            };
            let rows = batch.num_rows().min(CHUNK);
            if rows > 0 {
                chunks.push(Chunk::Arrow(ArrowRows(batch.slice(0, rows))));
                self.pending = Some(batch.slice(rows, batch.num_rows() - rows));
            }
        }
        Ok(chunks)
    }
}

/// Results as batches of an Arrow IPC file.
pub(super) struct ArrowSink<'a> {
    writer: FileWriter<&'a mut dyn Write>,
}

impl<'a> ArrowSink<'a> {
    /// Writes the schema.
    pub(super) fn begin(output: &'a mut dyn Write, binary32: bool) -> Result<Self, TableError> {
        let writer = FileWriter::try_new(output, &schema(binary32));
        let writer = writer.map_err(TableError::unwritable)?;
        Ok(Self { writer })
    }
}

impl Sink for ArrowSink<'_> {
    type Part = RecordBatch;

    fn encode(before: usize, chunk: &Evaluated, binary32: bool) -> Result<RecordBatch, TableError> {
        batch(before, chunk, binary32).map_err(TableError::unwritable)
    }

    fn write(&mut self, batch: RecordBatch) -> Result<(), TableError> {
        self.writer.write(&batch).map_err(TableError::unwritable)
    }

    fn finish(mut self) -> Result<(), TableError> {
        self.writer.finish().map_err(TableError::unwritable)
    }
}

/// Schema of the results; a row without a result has nulls.
fn schema(binary32: bool) -> Schema {
    let float = match binary32 {
        true => DataType::Float32,
        false => DataType::Float64,
    };
    let texts = ["case", "status"].map(|name| Field::new(name, DataType::Utf8, false));
    let results = RESULT_COLUMNS.map(|name| Field::new(name, float.clone(), true));
    Schema::new(texts.into_iter().chain(results).collect::<Vec<_>>())
}

fn batch(before: usize, chunk: &Evaluated, binary32: bool) -> Result<RecordBatch, ArrowError> {
    let rows = chunk.outcomes.len();
    let cases: StringArray = match &chunk.labels {
        Some(labels) => labels
            .iter()
            .map(|label| Some(String::from_utf8_lossy(label)))
            .collect(),
        None => (1..=rows)
            .map(|row| Some((before + row).to_string()))
            .collect(),
    };
    let outcomes = chunk.outcomes.iter();
    let statuses: StringArray = outcomes
        .map(|row| Some(row.as_ref().err().map_or("ok", String::as_str)))
        .collect();
    let mut columns: Vec<ArrayRef> = vec![Arc::new(cases), Arc::new(statuses)];
    for column in 0..RESULT_COLUMNS.len() {
        let results = chunk
            .outcomes
            .iter()
            .map(|row| row.as_ref().ok().map(|row| row[column]));
        columns.push(match binary32 {
            // Exact: the value was widened.
            true => Arc::new(
                results
                    .map(|value| value.map(|value| value as f32))
                    .collect::<Float32Array>(),
            ),
            false => Arc::new(results.collect::<Float64Array>()),
        });
    }
    RecordBatch::try_new(Arc::new(schema(binary32)), columns)
}
