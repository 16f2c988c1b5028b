//! Evaluates a table of cases, one machine and one instant in each row.

mod args;

pub use args::EvalArgs;
pub use trirrr_batch::table::RowCounts;

use crate::failure::CliError;
use crate::results::replace;
use std::io::{self, BufWriter, Read, Write};
use trirrr_batch::table::{Cases, TableError, TableFormat};
use trirrr_scene::read::files;
use trirrr_scene::{NumberType, visible};

/// `trirrr eval`: evaluates the table and says on standard error how many rows have numbers.
///
/// # Errors
/// Refused: the table cannot be read or lacks a column, a format or number type is not there. Failed: the results cannot
/// be written, or no row has numbers.
pub fn command(args: &EvalArgs) -> Result<(), CliError> {
    let name = args.cases.display().to_string();
    let failed = |error| failure(&name, error);
    let format = TableFormat::of(&args.cases)
        .map_err(|error| CliError::Refused(format!("{name}: {error}")))?;
    let open = || {
        let input = files::open(&args.cases);
        input.map_err(|error| CliError::Refused(format!("{name}: cannot be read: {error}")))
    };
    let cases = match format {
        _ if files::is_standard_input(&args.cases) => Cases::csv(io::stdin().lock()),
        TableFormat::Csv => Cases::csv(open()?),
        TableFormat::Arrow => Cases::arrow(open()?),
    };
    let cases = cases.map_err(failed)?;
    let evaluate = |format, output: &mut dyn Write| {
        let counts = cases.evaluate(args.scalar, format, output);
        counts.map_err(failed)
    };
    let counts = match &args.out {
        None => evaluate(TableFormat::Csv, &mut io::stdout().lock()),
        Some(out) => {
            let format = TableFormat::of(out)
                .map_err(|error| CliError::Refused(format!("--out {}: {error}", out.display())))?;
            replace("eval", out, |file| {
                evaluate(format, &mut BufWriter::new(file))
            })
        }
    }?;
    // Who closes the pipe has seen enough: the counts are not those of the table.
    if counts.is_cut {
        return Ok(());
    }
    // Standard error may be closed; the results are out.
    let (ok, rows) = (counts.ok, counts.rows);
    let _ = writeln!(io::stderr(), "{}: {ok} of {rows} rows ok", visible(&name));
    match ok == 0 && rows > 0 {
        true => Err(CliError::Failed(format!(
            "{name}: no row has numbers: the column status of the results says why"
        ))),
        false => Ok(()),
    }
}

/// Failure of the table called `name`.
fn failure(name: &str, error: TableError) -> CliError {
    match error {
        TableError::Unwritable(_) => CliError::Failed(error.to_string()),
        TableError::Unreadable(_) => CliError::Failed(format!("{name}: {error}")),
        _ => CliError::Refused(format!("{name}: {error}")),
    }
}

/// Evaluates the CSV table in `input`, called `name` in messages, row by row into `output`.
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
    let failed = |error| failure(name, error);
    let cases = Cases::csv(input).map_err(failed)?;
    cases
        .evaluate(scalar, TableFormat::Csv, output)
        .map_err(failed)
}
