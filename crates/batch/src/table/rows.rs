//! Evaluation of the rows of one chunk.

use super::arrow_rows::{ArrowRow, ArrowRows};
use csv::{ByteRecord, Reader, ReaderBuilder};
use trirrr_core::machine::Parameters;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::cases::{self, Columns, Fields};
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::record::RESULT_COLUMNS;

/// Results of a row in the order of [`RESULT_COLUMNS`], or its status.
pub(super) type Outcome = Result<[f64; RESULT_COLUMNS.len()], String>;

/// Rows that one thread evaluates.
pub(super) enum Chunk {
    /// Whole records of a CSV file without its header.
    Csv(Vec<u8>),
    /// Rows of an Arrow batch.
    Arrow(ArrowRows),
}

/// Evaluated rows.
pub(super) struct Evaluated {
    /// A field for each row; none if the table has no labels.
    pub(super) labels: Option<ByteRecord>,
    /// Results of the rows.
    pub(super) outcomes: Vec<Outcome>,
}

/// Returns a reader of records. A row that is too short or too long spoils itself only.
pub(super) fn reader(bytes: &[u8]) -> Reader<&[u8]> {
    let mut builder = ReaderBuilder::new();
    builder.has_headers(false).flexible(true).from_reader(bytes)
}

impl Chunk {
    /// Evaluates the rows in the number type `N`.
    pub(super) fn evaluate<N: Number>(self, columns: &Columns) -> Evaluated {
        let mut machine = None;
        let mut outcomes = Vec::new();
        let labels = match self {
            Chunk::Csv(bytes) => {
                let mut labels = columns.label_index().map(|_| ByteRecord::new());
                let mut reader = reader(&bytes);
                let mut row = ByteRecord::new();
                // Reading memory does not fail.
                while reader.read_byte_record(&mut row).unwrap_or(false) {
                    if let Some(labels) = &mut labels {
                        labels.push_field(columns.label(&row).unwrap_or_default());
                    }
                    outcomes.push(evaluate_row::<N>(columns, &row, &mut machine));
                }
                labels
            }
            Chunk::Arrow(rows) => {
                let numbers = &rows.numbers();
                outcomes.extend((0..rows.count()).map(|index| {
                    let row = ArrowRow {
                        columns: numbers,
                        index,
                    };
                    evaluate_row::<N>(columns, &row, &mut machine)
                }));
                columns.label_index().map(|index| rows.labels(index))
            }
        };
        Evaluated { labels, outcomes }
    }
}

/// The machine of the row before, for rows with the same one.
struct BuiltMachine<N: Number> {
    parameters: Parameters,
    units: Units,
    pipeline: Box<dyn Pipeline<N>>,
}

/// The results of a row, or its status.
fn evaluate_row<N: Number>(
    columns: &Columns,
    row: &impl Fields,
    machine: &mut Option<BuiltMachine<N>>,
) -> Outcome {
    let invalid = |reason: String| format!("invalid: {reason}");
    if N::PROPAGATES_NON_FINITE {
        let case = cases::read::<N>(columns, row).map_err(invalid)?;
        return results(machine, &case.parameters, Units::SI, &case.setpoint);
    }
    // Read as it stands, then in the units that the row needs.
    let case = cases::read::<f64>(columns, row).map_err(invalid)?;
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
    results(machine, &case.parameters, units, &setpoint)
}

/// The results of the machine for `setpoint`, given in `units`.
fn results<N: Number>(
    machine: &mut Option<BuiltMachine<N>>,
    parameters: &Parameters,
    units: Units,
    setpoint: &Setpoint<N>,
) -> Outcome {
    let is_built =
        |built: &&BuiltMachine<N>| built.units == units && built.parameters == *parameters;
    let built = match machine.as_ref().filter(is_built) {
        Some(built) => built,
        None => machine.insert(BuiltMachine {
            parameters: *parameters,
            units,
            pipeline: pipeline::build_in(parameters, units)
                .map_err(|error| format!("invalid: {error}"))?,
        }),
    };
    let record = built.pipeline.evaluate(0.0, setpoint);
    let record = record.map_err(|status| status.to_string())?;
    Ok(record.results())
}
