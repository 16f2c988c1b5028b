//! Rows of an Arrow batch, by columns.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow_schema::DataType;
use csv::ByteRecord;
use std::borrow::Cow;
use trirrr_scene::cases::Fields;

/// Rows of a batch.
pub(super) struct ArrowRows(pub(super) RecordBatch);

impl ArrowRows {
    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.0.num_rows()
    }

    /// Columns as binary64 numbers. None: the column holds no numbers.
    pub(super) fn numbers(&self) -> Vec<Option<Float64Array>> {
        self.0.columns().iter().map(as_numbers).collect()
    }

    /// Labels of the rows, in the column at `index`.
    pub(super) fn labels(&self, index: usize) -> ByteRecord {
        let column = self.0.column(index);
        let text = |label: Option<&str>| label.unwrap_or_default().to_owned();
        let labels: Vec<String> = match column.data_type() {
            DataType::Utf8 => column.as_string::<i32>().iter().map(text).collect(),
            DataType::LargeUtf8 => column.as_string::<i64>().iter().map(text).collect(),
            DataType::Utf8View => column.as_string_view().iter().map(text).collect(),
            DataType::UInt64 => whole(column.as_primitive::<UInt64Type>().iter()),
            DataType::Int64 => whole(column.as_primitive::<Int64Type>().iter()),
            // Of at most 32 bits, which binary64 holds.
            _ => whole(as_numbers(column).iter().flatten()),
        };
        ByteRecord::from(labels)
    }
}

fn whole<T: ToString>(values: impl Iterator<Item = Option<T>>) -> Vec<String> {
    let text = |value: Option<T>| value.map_or_else(String::new, |value| value.to_string());
    values.map(text).collect()
}

/// Returns a column of numbers, rounded to binary64.
fn as_numbers(column: &ArrayRef) -> Option<Float64Array> {
    macro_rules! widened {
        ($($data:ident => $type:ty),*) => {
            match column.data_type() {
                DataType::Float64 => column.as_primitive::<Float64Type>().clone(),
                $(DataType::$data => column.as_primitive::<$type>().unary(|value| value as f64),)*
                _ => return None,
            }
        };
    }
    Some(widened!(
        Float32 => Float32Type, Int8 => Int8Type, Int16 => Int16Type, Int32 => Int32Type, Int64 => Int64Type,
        UInt8 => UInt8Type, UInt16 => UInt16Type, UInt32 => UInt32Type, UInt64 => UInt64Type
    ))
}

/// One row of [`ArrowRows::numbers`].
pub(super) struct ArrowRow<'a> {
    pub(super) columns: &'a [Option<Float64Array>],
    pub(super) index: usize,
}

impl Fields for ArrowRow<'_> {
    fn count(&self) -> usize {
        self.columns.len()
    }

    fn number(&self, index: usize) -> Option<f64> {
        let column = self.columns.get(index)?.as_ref()?;
        column
            .is_valid(self.index)
            .then(|| column.value(self.index))
    }

    fn text(&self, index: usize) -> Cow<'_, str> {
        self.number(index)
            .map_or(Cow::Borrowed(""), |value| format!("{value:?}").into())
    }
}
