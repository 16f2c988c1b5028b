//! Evaluates a table of cases, one machine and one instant in each row.

mod args;

pub use args::EvalArgs;

use crate::failure::CliError;
use crate::results::replace;
use csv::ByteRecord;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;
use trirrr_core::machine::Parameters;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::NumberType;
use trirrr_scene::cases::{self, Columns};
use trirrr_scene::in_number_type;
use trirrr_scene::pipeline;
use trirrr_scene::record::{RESULT_COLUMNS, Record, number};

/// Rows of a table, and those of them with a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct RowCounts {
    /// Rows in the table.
    pub rows: usize,
    /// Rows with numbers.
    pub ok: usize,
}

/// `trirrr eval`: evaluates the table and says on standard error how many rows have numbers.
///
/// # Errors
/// Refused: the table cannot be read or lacks a column, or the number type is not there. Failed:
/// the results cannot be written.
pub fn command(args: &EvalArgs) -> Result<(), CliError> {
    let scalar = args.scalar;
    let cases = args.cases.display();
    let input = File::open(&args.cases)
        .map_err(|error| CliError::Refused(format!("{cases}: cannot be read: {error}")))?;
    let name = cases.to_string();
    let count = match &args.out {
        None => evaluate(scalar, &name, input, &mut io::stdout().lock()),
        Some(out) => {
            refuse_same_file(&args.cases, out)?;
            replace(out, |file| {
                evaluate(scalar, &name, input, &mut BufWriter::new(file))
            })
        }
    }?;
    // Standard error may be closed; the results are out.
    let _ = writeln!(
        io::stderr(),
        "{name}: {} of {} rows ok",
        count.ok,
        count.rows
    );
    Ok(())
}

/// The results would replace the cases while they are read.
fn refuse_same_file(cases: &Path, out: &Path) -> Result<(), CliError> {
    match (cases.canonicalize(), out.canonicalize()) {
        (Ok(cases), Ok(target)) if cases == target => Err(CliError::Refused(format!(
            "--out {}: is the table of cases itself",
            out.display()
        ))),
        _ => Ok(()),
    }
}

/// Evaluates the table in `input`, called `name` in messages, row by row into `output`.
///
/// A reader that closes its end early (a broken pipe) ends the work without an error.
///
/// # Errors
/// As [`command`].
pub fn evaluate(
    scalar: NumberType,
    name: &str,
    input: impl Read,
    output: &mut dyn Write,
) -> Result<RowCounts, CliError> {
    in_number_type!(scalar, N => evaluate_in::<N>(name, input, output))
}

fn evaluate_in<N: Number>(
    name: &str,
    input: impl Read,
    output: &mut dyn Write,
) -> Result<RowCounts, CliError> {
    let unreadable =
        |error: csv::Error| CliError::Failed(format!("{name}: cannot be read: {error}"));
    // Flexible: a row that is too short or too long spoils itself only.
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(input);
    let mut record = ByteRecord::new();
    if !reader.read_byte_record(&mut record).map_err(unreadable)? {
        let reason = "is empty, expected a header that names the columns";
        return Err(CliError::Refused(format!("{name}: {reason}")));
    }
    let columns =
        Columns::find(&record).map_err(|reason| CliError::Refused(format!("{name}: {reason}")))?;

    let mut results = Results {
        writer: csv::Writer::from_writer(output),
        closed: false,
    };
    results.put(["case", "status"].into_iter().chain(RESULT_COLUMNS))?;
    let mut count = RowCounts::default();
    while !results.closed && reader.read_byte_record(&mut record).map_err(unreadable)? {
        count.rows += 1;
        let case = columns
            .label(&record)
            .map_or_else(|| count.rows.to_string().into_bytes(), <[u8]>::to_vec);
        match evaluate_row::<N>(&columns, &record) {
            Ok(motion) => {
                count.ok += 1;
                results.row(&case, "ok", &motion.results().map(number))?;
            }
            Err(status) => results.row(&case, &status, &[const { String::new() }; 28])?,
        }
    }
    results.flush()?;
    Ok(count)
}

/// The motion of a row, or its status.
fn evaluate_row<N: Number>(columns: &Columns, record: &ByteRecord) -> Result<Record, String> {
    let invalid = |reason: String| format!("invalid: {reason}");
    if N::PROPAGATES_NON_FINITE {
        let case = cases::read::<N>(columns, record).map_err(invalid)?;
        return motion(&case.parameters, Units::SI, &case.setpoint);
    }
    // Read as it stands, then in the units that the row needs.
    let case = cases::read::<f64>(columns, record).map_err(invalid)?;
    case.parameters
        .check::<f64>()
        .map_err(|error| invalid(error.to_string()))?;
    let units = trirrr_scene::units_of_setpoints(&case.parameters, [&case.setpoint])
        .map_err(|error| format!("does not fit: {error}"))?;
    let setpoint = units.setpoint(&case.setpoint);
    let (pose, velocity) = (setpoint.pose, setpoint.velocity);
    let setpoint = Setpoint {
        pose: Pose::from_f64(pose.position.x, pose.position.y, pose.angle),
        velocity: velocity.map(N::from_f64),
        acceleration: setpoint.acceleration.map(N::from_f64),
    };
    motion(&case.parameters, units, &setpoint)
}

/// The motion of the machine for `setpoint`, given in `units`.
fn motion<N: Number>(
    parameters: &Parameters,
    units: Units,
    setpoint: &Setpoint<N>,
) -> Result<Record, String> {
    let machine =
        pipeline::build_in(parameters, units).map_err(|error| format!("invalid: {error}"))?;
    machine
        .evaluate(0.0, setpoint)
        .map_err(|status| status.to_string())
}

/// The table of results, and whether its reader has gone.
struct Results<'a> {
    writer: csv::Writer<&'a mut dyn Write>,
    closed: bool,
}

impl Results<'_> {
    fn row(&mut self, case: &[u8], status: &str, values: &[String; 28]) -> Result<(), CliError> {
        let fields = [case, status.as_bytes()].into_iter();
        self.put(fields.chain(values.iter().map(String::as_bytes)))
    }

    fn put<T: AsRef<[u8]>>(&mut self, fields: impl Iterator<Item = T>) -> Result<(), CliError> {
        // Not `io::Error::from`, which hides the kind.
        let written = self.writer.write_record(fields);
        self.note(written.map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => error,
            other => io::Error::other(format!("{other:?}")),
        }))
    }

    fn flush(&mut self) -> Result<(), CliError> {
        let flushed = self.writer.flush();
        self.note(flushed)
    }

    fn note(&mut self, result: io::Result<()>) -> Result<(), CliError> {
        match result {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            other => other.map_err(|error| {
                CliError::Failed(format!("the results cannot be written: {error}"))
            }),
        }
    }
}
