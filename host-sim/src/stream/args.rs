//! Arguments of `trirrr stream`.

use crate::arguments::{DEFAULT_SCENE, factor, number_type};
use crate::failure::CliError;
use crate::job_file::JobFileArgs;
use crate::serve::read_key;
use clap::Args;
use std::path::PathBuf;
use trirrr_line::{Address, Port, Retry};
use trirrr_protocol::message::TelemetryFields;
use trirrr_scene::NumberType;

/// Line to a board.
#[derive(Args, Clone, Debug)]
pub struct PortArgs {
    /// The board: /dev/tty..., or tcp:HOST:PORT for an emulated one or `trirrr device`
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Rate of a serial port
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    pub baud: u32,
    /// Key file of a TCP port that expects a key
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
}

impl PortArgs {
    /// Opens the port, which is opened anew as `retry` says.
    ///
    /// # Errors
    /// Refused: the key file. Failed: the port cannot be opened.
    pub(crate) fn open(&self, retry: Retry) -> Result<Port, CliError> {
        let key = self.key.as_deref().map(read_key).transpose()?;
        let port = Port::new(self.port.clone(), self.baud, key, retry);
        port.opened()
            .map_err(|error| CliError::Failed(error.to_string()))
    }
}

/// `trirrr stream`.
///
/// Offers the scene's moves to a board as it has room for them, starts the job, and stays with it
/// to its end. Repeats what is not answered, opens the port anew when it is lost, and goes on where
/// the board is. Writes ticks.csv from the telemetry (one row per sample, SI units) and the figures
/// as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The scene must be the one that the board's image was built from. Ctrl-C stops the machine on its \
path and ends the stream; a second one ends the stream at once, and the board's host timeout \
stops the machine. With --keys, a line `hold`, `resume`, `stop` or `feed PERCENT` on standard input \
does that.")]
pub struct StreamArgs {
    /// The scene, a TOML file; or with --machine a job: G-code, a drawing (SVG, DXF), an image, a table of poses (CSV)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// More of them, played one after the other; all are read and planned before the first is played
    #[arg(conflicts_with = "resume")]
    pub then: Vec<PathBuf>,
    /// The job in a file of its own.
    #[command(flatten)]
    pub job: JobFileArgs,
    /// The line to the board.
    #[command(flatten)]
    pub line: PortArgs,
    /// Folder for what is written, made if missing; results of an earlier stream go with the first sample
    /// [default: out/NAME-stream, after the scene's name]. Of several jobs each has a folder in it
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number type of the board's image [default: the scene's]
    #[arg(long, value_parser = number_type())]
    pub scalar: Option<NumberType>,
    /// Ticks from one telemetry sample to the next [default: the scene's, more where the port is too
    /// slow for them]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u16).range(1..))]
    pub telemetry: Option<u16>,
    /// Fields that a sample has besides setpoint and tool: `all`, `none`, or some of angles, rates, accelerations, torques and
    /// duration, with commas between them. Whatever is left out is computed from the setpoint; a slow port carries more samples
    /// without them
    #[arg(long, value_name = "FIELDS", default_value = "all", value_parser = fields)]
    pub fields: TelemetryFields,
    /// Seconds without an answer, or without the port, after which the stream gives up
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = factor)]
    pub patience: f64,
    /// Acknowledge a latched fault, and bring the machine to where the job starts: one that is not
    /// homed by homing it, any other by moving its motors there in so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = factor)]
    pub recover: Option<f64>,
    /// Go on with the job that an earlier stream into the same folder has begun: at the very place, on a machine that waits for
    /// its host; else from the place that it had reached, back to which the machine goes with the tool off (first to a rest before it,
    /// in the seconds of --recover, 2 by default). Results go into a folder `resumed-1` in that folder, or the next number
    #[arg(long)]
    pub resume: bool,
    /// Do not home a machine that is not homed: the stream ends instead
    #[arg(long)]
    pub no_homing: bool,
    /// Play at so many percent of normal speed, 1 to 100
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub feed: Option<u8>,
    /// Send the pieces of the job's path in place of moves: the board plans them, if its scene has `plans_paths`
    #[arg(long)]
    pub path: bool,
    /// Take `hold`, `resume`, `stop` and `feed PERCENT` from standard input, a line each
    #[arg(long)]
    pub keys: bool,
}

/// Reads the fields of `--fields`.
fn fields(text: &str) -> Result<TelemetryFields, String> {
    let rows = TelemetryFields::SETPOINT | TelemetryFields::TOOL;
    match text {
        "all" => return Ok(TelemetryFields::ALL),
        "none" => return Ok(rows),
        _ => {}
    }
    text.split(',').try_fold(rows, |fields, name| {
        let named = TelemetryFields::NAMES.iter().find(|(each, _)| *each == name);
        named.map(|(_, field)| fields | *field).ok_or_else(|| {
            format!("{name:?} is no field: take all, none, or some of angles, rates, accelerations, torques and duration")
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_by_name() {
        let rows = TelemetryFields::SETPOINT | TelemetryFields::TOOL;
        assert_eq!(fields("all").unwrap(), TelemetryFields::ALL);
        assert_eq!(fields("none").unwrap(), rows);
        let some = rows | TelemetryFields::RATES | TelemetryFields::TORQUES;
        assert_eq!(fields("rates,torques").unwrap(), some);
        assert!(fields("rates,torque").unwrap_err().contains("\"torque\""));
    }
}
