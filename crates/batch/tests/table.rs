//! Tables in both formats: equal bits, the order of the rows, refusals, bounded memory.

use arrow_array::types::{Float32Type, Float64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float32Array, Float64Array, Int8Array, Int64Array, RecordBatch,
    StringArray, cast::AsArray,
};
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use std::cell::Cell;
use std::io::{self, Cursor, Read, Write};
use std::sync::Arc;
use trirrr_batch::table::{Cases, RowCounts, TableError, TableFormat};
use trirrr_scene::NumberType;
use trirrr_scene::record::RESULT_COLUMNS;

const NAMES: &str = "ax_1,ay_1,z1_1,z2_1,h_1,lam_1,sg_1,ax_2,ay_2,z1_2,z2_2,h_2,lam_2,sg_2,\
    ax_3,ay_3,z1_3,z2_3,h_3,lam_3,sg_3,m,I,x,y,alpha,vx,vy,valpha,acx,acy,acalpha";
const MACHINE: [f64; 23] = [
    0.0,
    0.433,
    0.2,
    0.2,
    0.02,
    2.617_993_877_991_494_4,
    1.0,
    0.5,
    0.433,
    0.2,
    0.2,
    0.02,
    0.523_598_775_598_298_8,
    1.0,
    0.25,
    0.0,
    0.2,
    0.2,
    0.02,
    4.712_388_980_384_69,
    1.0,
    0.5,
    0.0025,
];

/// A row of its own for each number: some beyond reach, every hundredth with another machine.
fn row(number: usize) -> Vec<f64> {
    let part = |factor: f64| (number as f64 * factor).fract() - 0.5;
    let mut row = MACHINE.to_vec();
    if number % 100 < 3 {
        row[2] = 0.21;
    }
    let (x, y) = (0.245 + 0.5 * part(0.618), 0.25 + 0.4 * part(0.414));
    row.extend([x, y, 0.17 + 0.3 * part(0.732)]);
    row.extend([0.236, 0.317, 0.732, 0.645, 0.123, 0.87].map(part));
    row
}

fn csv_table(rows: usize) -> Vec<u8> {
    let mut text = format!("{NAMES}\n").into_bytes();
    (0..rows).for_each(|number| write_row(&mut text, number));
    text
}

fn write_row(text: &mut Vec<u8>, number: usize) {
    let fields: Vec<String> = row(number).iter().map(f64::to_string).collect();
    writeln!(text, "{}", fields.join(",")).unwrap();
}

fn arrow_table(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut file = Vec::new();
    let mut writer = FileWriter::try_new(&mut file, &batch.schema()).unwrap();
    // Two batches, of which one ends within a chunk.
    let half = batch.num_rows() / 2;
    writer.write(&batch.slice(0, half)).unwrap();
    writer
        .write(&batch.slice(half, batch.num_rows() - half))
        .unwrap();
    writer.finish().unwrap();
    file
}

fn columns(rows: usize) -> Vec<(&'static str, ArrayRef)> {
    let rows: Vec<Vec<f64>> = (0..rows).map(row).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
    let named = NAMES.split(',').enumerate();
    named
        .map(|(index, name)| {
            (
                name,
                Arc::new(Float64Array::from(column(index))) as ArrayRef,
            )
        })
        .collect()
}

fn evaluate(
    cases: Result<Cases<'_>, TableError>,
    scalar: NumberType,
    format: TableFormat,
) -> Vec<u8> {
    let mut results = Vec::new();
    let counts = cases
        .unwrap()
        .evaluate(scalar, format, &mut results)
        .unwrap();
    assert!(counts.ok > 0 && counts.ok < counts.rows, "{counts:?}");
    results
}

/// Both texts and the bits of the results of each row.
fn read_arrow(file: &[u8]) -> Vec<(String, String, Vec<Option<u64>>)> {
    let mut rows = Vec::new();
    for batch in FileReader::try_new(Cursor::new(file), None).unwrap() {
        let batch = batch.unwrap();
        let bits = |column: &ArrayRef, row: usize| {
            let valid = column.is_valid(row);
            valid.then(|| match column.as_primitive_opt::<Float32Type>() {
                Some(column) => u64::from(column.value(row).to_bits()),
                None => column.as_primitive::<Float64Type>().value(row).to_bits(),
            })
        };
        for row in 0..batch.num_rows() {
            let text = |column: usize| {
                batch
                    .column(column)
                    .as_string::<i32>()
                    .value(row)
                    .to_owned()
            };
            let results = batch.columns()[2..].iter();
            rows.push((
                text(0),
                text(1),
                results.map(|column| bits(column, row)).collect(),
            ));
        }
    }
    rows
}

#[test]
fn both_formats_hold_the_same_bits_in_the_same_order() {
    const ROWS: usize = 5000;
    let (csv, arrow) = (csv_table(ROWS), arrow_table(columns(ROWS)));
    for scalar in [NumberType::F64, NumberType::F32] {
        let from_csv = |format| evaluate(Cases::csv(csv.as_slice()), scalar, format);
        let from_arrow = |format| evaluate(Cases::arrow(Cursor::new(&arrow)), scalar, format);
        let text = from_csv(TableFormat::Csv);
        assert_eq!(text, from_arrow(TableFormat::Csv));
        let rows = read_arrow(&from_csv(TableFormat::Arrow));
        assert_eq!(rows, read_arrow(&from_arrow(TableFormat::Arrow)));
        assert_eq!(rows.len(), ROWS);

        let text = String::from_utf8(text).unwrap();
        let mut lines = text.lines();
        let header = format!("case,status,{}", RESULT_COLUMNS.join(","));
        assert_eq!(lines.next(), Some(header.as_str()));
        for (number, (line, (case, status, results))) in lines.zip(rows).enumerate() {
            let fields: Vec<&str> = line.split(',').collect();
            assert_eq!(fields[..2], [case.as_str(), status.as_str()]);
            assert_eq!(case, (number + 1).to_string());
            assert_eq!(fields.len(), 2 + results.len());
            for (field, bits) in fields[2..].iter().zip(results) {
                let read = match scalar {
                    NumberType::F32 => field.parse::<f32>().map(|value| value.to_bits().into()),
                    _ => field.parse::<f64>().map(f64::to_bits),
                };
                assert_eq!(read.ok(), bits, "{field}");
            }
        }
    }
}

/// Each row by itself has the results that it has among others: nothing of the row before is left.
#[test]
fn a_row_does_not_depend_on_its_neighbours() {
    let all = evaluate(
        Cases::csv(csv_table(400).as_slice()),
        NumberType::Fixed,
        TableFormat::Csv,
    );
    let all = String::from_utf8(all).unwrap();
    for (number, line) in all.lines().skip(1).enumerate().skip(90).take(120) {
        let mut single = format!("{NAMES}\n").into_bytes();
        write_row(&mut single, number);
        let mut results = Vec::new();
        let cases = Cases::csv(single.as_slice()).unwrap();
        cases
            .evaluate(NumberType::Fixed, TableFormat::Csv, &mut results)
            .unwrap();
        let results = String::from_utf8(results).unwrap();
        let without_case = |line: &str| line.split_once(',').unwrap().1.to_owned();
        assert_eq!(
            without_case(results.lines().nth(1).unwrap()),
            without_case(line)
        );
    }
}

#[test]
fn arrow_columns_may_be_narrow_and_nulls_are_empty() {
    let mut table = columns(3);
    let replace = |table: &mut Vec<(&str, ArrayRef)>, name: &str, column: ArrayRef| {
        table
            .iter_mut()
            .find(|(found, _)| *found == name)
            .unwrap()
            .1 = column;
    };
    replace(
        &mut table,
        "sg_1",
        Arc::new(Int8Array::from(vec![1, -1, 2])),
    );
    replace(
        &mut table,
        "sg_2",
        Arc::new(Int64Array::from(vec![1, 1, 1])),
    );
    replace(&mut table, "m", Arc::new(Float32Array::from(vec![0.5; 3])));
    replace(
        &mut table,
        "x",
        Arc::new(Float64Array::from(vec![Some(0.245), None, Some(0.245)])),
    );
    replace(&mut table, "y", Arc::new(Float64Array::from(vec![0.25; 3])));
    let names = StringArray::from(vec![Some("first, \"quoted\""), None, Some("third")]);
    table.push(("case", Arc::new(names)));
    table.push(("note", Arc::new(BooleanArray::from(vec![true; 3]))));
    let file = arrow_table(table);
    let results = evaluate(
        Cases::arrow(Cursor::new(file)),
        NumberType::F64,
        TableFormat::Arrow,
    );
    let rows = read_arrow(&results);
    let texts: Vec<_> = rows
        .iter()
        .map(|(case, status, _)| (case.as_str(), status.as_str()))
        .collect();
    assert_eq!(
        texts,
        [
            ("first, \"quoted\"", "ok"),
            ("", "invalid: x is empty"),
            ("third", "invalid: sg_1 = 2.0: must be 1 or -1"),
        ]
    );
}

fn refusal(file: impl AsRef<[u8]>) -> String {
    match Cases::arrow(Cursor::new(file)) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn a_file_or_column_that_is_not_what_it_says_is_refused() {
    let mut table = columns(2);
    table[2].1 = Arc::new(StringArray::from(vec!["0.2", "0.2"]));
    assert_eq!(
        refusal(arrow_table(table)),
        "column z1_1 holds Utf8, expected floats or whole numbers"
    );
    let mut table = columns(2);
    table.push(("case", Arc::new(Float64Array::from(vec![1.0, 2.0]))));
    assert_eq!(
        refusal(arrow_table(table)),
        "column case holds Float64, expected text or whole numbers"
    );
    let mut table = columns(2);
    table.retain(|(name, _)| *name != "z2_3");
    assert_eq!(refusal(arrow_table(table)), "column z2_3 is missing");
    for file in [
        csv_table(3),
        Vec::new(),
        arrow_table(columns(2))[..2000].to_vec(),
    ] {
        let message = refusal(file);
        assert!(
            message.starts_with("cannot be read as an Arrow IPC file: "),
            "{message}"
        );
    }
    let parquet = TableFormat::of("a/cases.parquet".as_ref()).unwrap_err();
    assert_eq!(
        parquet.to_string(),
        ".parquet files are not supported; use .csv, or .arrow for an Arrow IPC file"
    );
    for (file, format) in [
        ("a.arrow", TableFormat::Arrow),
        ("a.FEATHER", TableFormat::Arrow),
        ("a.csv", TableFormat::Csv),
        ("/dev/stdin", TableFormat::Csv),
    ] {
        assert_eq!(TableFormat::of(file.as_ref()), Ok(format));
    }
}

/// Rows that are made when they are read.
struct EndlessRows<'a> {
    next: usize,
    most: usize,
    line: Cursor<Vec<u8>>,
    read: &'a Cell<usize>,
}

impl Read for EndlessRows<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.line.position() == self.line.get_ref().len() as u64 && self.next < self.most {
            let mut line = Vec::new();
            write_row(&mut line, self.next);
            self.line = Cursor::new(line);
            self.next += 1;
            self.read.set(self.next);
        }
        self.line.read(buffer)
    }
}

/// Counts lines, and the most rows that were read and not yet written.
struct CountingLines<'a> {
    lines: usize,
    most_between: usize,
    read: &'a Cell<usize>,
}

impl Write for CountingLines<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.most_between = self
            .most_between
            .max(self.read.get().saturating_sub(self.lines));
        self.lines += bytes.iter().filter(|byte| **byte == b'\n').count();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Rows between input and output do not grow with the table.
fn rows_under_way(rows: usize) -> usize {
    let read = &Cell::new(0);
    let input = EndlessRows {
        next: 0,
        most: rows,
        line: Cursor::new(format!("{NAMES}\n").into_bytes()),
        read,
    };
    let mut output = CountingLines {
        lines: 0,
        most_between: 0,
        read,
    };
    let cases = Cases::csv(input).unwrap();
    let counts = cases.evaluate(NumberType::F64, TableFormat::Csv, &mut output);
    assert!(matches!(counts, Ok(RowCounts { rows: counted, .. }) if counted == rows));
    assert_eq!(output.lines, rows + 1);
    output.most_between
}

#[test]
fn few_rows_are_under_way() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let most = pool.install(|| rows_under_way(20_000));
    assert!((1000..15_000).contains(&most), "{most}");
}

#[test]
#[ignore = "a million rows; cargo xtask nightly runs it"]
fn a_million_rows_need_the_memory_of_a_few() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let most = pool.install(|| rows_under_way(1_000_000));
    assert!((1000..15_000).contains(&most), "{most}");
    println!("{most} rows under way of 1,000,000");
}
