//! The command line.

use crate::link::{Address, listening};
use crate::report::Section;
use crate::scalar::Scalar;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// The scene that is run when none is named.
pub const DEFAULT_SCENE: &str = "scenes/thesis.toml";

/// Simulator and host tools for the planar 3-RRR manipulator.
///
/// Without a command, runs scenes/thesis.toml in real time.
#[derive(Debug, Parser)]
#[command(name = "host-sim", version, max_term_width = 100)]
#[command(after_help = "\
Exit codes: 0 done; 1 failed, or the motion ended in a status; 2 refused: arguments, scene or \
table; 130 ended by Ctrl-C.")]
pub struct Cli {
    /// What to do; without it, `run`.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// What there is to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene's job tick by tick at its rate, write a table and figures
    Run(RunArgs),
    /// Play a board: a scene's service behind a TCP port, in real time
    Device(DeviceArgs),
    /// Stream a scene's job to a board, write its telemetry and figures
    Stream(StreamArgs),
    /// Evaluate a table of cases: a machine and a state or a move in each row
    Eval(EvalArgs),
    /// Solve a planar linkage over its motion: Assur groups, table, figures
    Linkage(LinkageArgs),
    /// Measure what the numbers are worth and what they cost: errors, run times, extremes
    Report(ReportArgs),
}

/// `host-sim run`.
///
/// Plays the job through the machine's service, in real time against absolute deadlines, and reports
/// how well they were kept.
/// Writes ticks.csv (one row per tick, SI units) and the figures as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Ctrl-C ends the run cleanly: what was computed so far is written. So does a move that the machine \
refuses (unreachable, singular, beyond a limit); the move, the leg or motor and the time in it are \
named.")]
pub struct RunArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Compute as fast as it goes instead of in real time
    #[arg(long)]
    pub fast: bool,
    /// Folder for what is written, made if missing; files of an earlier run are replaced
    /// [default: out/NAME, after the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number type to compute in [default: the scene's]
    #[arg(long)]
    pub scalar: Option<Scalar>,
}

impl Default for RunArgs {
    /// What `host-sim run` without arguments does.
    fn default() -> Self {
        Self {
            scene: DEFAULT_SCENE.into(),
            fast: false,
            out: None,
            scalar: None,
        }
    }
}

/// `host-sim device`.
///
/// Listens for one client at a time and answers it as a board with the scene's image would: same
/// service, same wire, same bits. Says on standard output where it listens, who comes and goes, what
/// the machine does and what it refuses.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Ctrl-C ends the device. A client that is lost leaves the machine to the scene's silence timeout: it \
comes to rest on its path. The client may come back and go on.")]
pub struct DeviceArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Where to listen: tcp:HOST:PORT; port 0 takes one that is free and prints it
    #[arg(long, value_name = "ADDRESS", default_value = "tcp:127.0.0.1:7333", value_parser = listening)]
    pub listen: String,
    /// Number type to compute in [default: the scene's]
    #[arg(long)]
    pub scalar: Option<Scalar>,
    /// The machine's seconds per second of real time: 10 for ten times as fast
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = factor)]
    pub speed: f64,
    /// In a scene with homing, how far the motors are from where the machine counts from when it is
    /// switched on, rad [default: one of its own for each scene]
    #[arg(
        long,
        value_names = ["A", "B", "C"],
        num_args = 3,
        allow_hyphen_values = true
    )]
    pub offset_rad: Option<Vec<f64>>,
}

/// `host-sim stream`.
///
/// Offers the scene's moves to a board as it has room for them, starts the job, and stays with it
/// to its end. Repeats what is not answered, opens the port anew when it is lost, and goes on where
/// the board is. Writes ticks.csv from the telemetry (one row per sample, SI units) and the figures
/// as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The scene must be the one that the board's image was built from. Ctrl-C stops the machine on its \
path and ends the stream; a second one ends the stream at once, and the board's silence timeout \
stops the machine. With --keys, a line `hold`, `resume` or `stop` on standard input does that.")]
pub struct StreamArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// The board: /dev/tty..., or tcp:HOST:PORT for an emulated one or `host-sim device`
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Rate of a serial port
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    pub baud: u32,
    /// Folder for what is written, made if missing; files of an earlier run are replaced
    /// [default: out/NAME, after the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number type of the board's image [default: the scene's]
    #[arg(long)]
    pub scalar: Option<Scalar>,
    /// Ticks from one telemetry sample to the next [default: the scene's, more where the port is too
    /// slow for them]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u16).range(1..))]
    pub telemetry: Option<u16>,
    /// Seconds without an answer, or without the port, after which the stream gives up
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = factor)]
    pub patience: f64,
    /// Acknowledge a latched fault, and bring the machine to where the job starts: one that is not
    /// homed by homing it, any other by moving its motors there in so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = factor)]
    pub recover: Option<f64>,
    /// Do not home a machine that is not homed: the stream ends instead
    #[arg(long)]
    pub no_homing: bool,
    /// Take `hold`, `resume` and `stop` from standard input, a line each
    #[arg(long)]
    pub keys: bool,
}

/// `host-sim eval`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = EVAL_COLUMNS)]
pub struct EvalArgs {
    /// Table of cases, CSV with a header (columns: see --help)
    #[arg(value_name = "CASES.csv")]
    pub cases: PathBuf,
    /// Number type to compute in
    #[arg(long, default_value = "f64")]
    pub scalar: Scalar,
    /// File for the results [default: standard output]
    #[arg(long, value_name = "RESULTS.csv")]
    pub out: Option<PathBuf>,
}

/// `host-sim linkage`.
///
/// Decomposes a mechanism of links and joints into Assur groups, prints them in solving order,
/// and solves them over a turn or a range of the drives. Writes linkage.csv (one row per position,
/// SI units) and figures as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Where the motion has an end (a dead point, a singular position), the input there and the group are \
named, and what was solved so far is written.")]
pub struct LinkageArgs {
    /// The mechanism, a TOML file (format: docs/linkage-files.md)
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Steps over the motion [default: the file's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub steps: Option<u32>,
    /// Folder for what is written, made if missing; files of an earlier run are replaced
    /// [default: out/NAME, after the linkage's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `host-sim report`.
///
/// Writes report.md with its tables as CSV and its figures as SVG. Instruction counts are those
/// that were checked in when this program was built; everything else is measured now.
#[derive(Args, Clone, Debug)]
pub struct ReportArgs {
    /// Folder for what is written, made if missing; files of an earlier report are replaced
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    pub out: PathBuf,
    /// A part of the report; repeat for more [default: all of them]
    #[arg(long)]
    pub section: Vec<Section>,
    /// A Markdown file whose copies of the report's parts are replaced, and the figures in
    /// `images` beside it
    #[arg(long, value_name = "FILE.md")]
    pub docs: Option<PathBuf>,
}

/// Reads a positive number.
fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        // Beyond these, no time is left to count or none to see.
        Ok(value) if (1e-3..=1e6).contains(&value) => Ok(value),
        _ => Err("expected a number from 0.001 to 1000000".into()),
    }
}

const EVAL_COLUMNS: &str = "\
Columns of CASES.csv, in any order, SI units and radians; others are ignored:
  case                          name of the row; its number if the column is missing
  for each leg i = 1, 2, 3:
    ax_i, ay_i                  base joint A
    z1_i, z2_i                  proximal and distal link length
    h_i, lam_i                  platform joint C in polar coordinates about D
    sg_i                        elbow sign, 1 or -1
  m, I                          platform mass and moment of inertia
  ml                            mass of each of the six links, uniform rods (0 if missing)
  gx, gy                        gravity (0 if missing)
  Wx, Wy, Wa                    wrench on the platform at D (0 if missing)
and either the state
  x, y, alpha, vx, vy, valpha, acx, acy, acalpha
or a move from rest to rest along a cubic, at the time t from 0 to T
  x0, xf, y0, yf, a0, af, T, t
The move is used only where the table does not have every column of the state.

Columns of the results, i = 1, 2, 3 side by side:
  case, status, th1_i, th2_i, dth1_i, dth2_i, ddth1_i, ddth2_i, D_i (named D1, D2, D3), detA,
  tau_i, P_i (named tau1, P1 and so on)
status is `ok`, or begins with why there are no numbers: `unreachable: leg 1`,
`serial singular: leg 2`, `parallel singular`, `out of range ...`, or `invalid: ` with column,
value and reason. Such rows do not change the exit code.";

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_defaults_are_those_of_the_contract() {
        let cli = Cli::parse_from(["host-sim"]);
        assert!(cli.command.is_none());
        let Some(Command::Run(run)) = Cli::parse_from(["host-sim", "run"]).command else {
            panic!("not run");
        };
        assert_eq!(run.scene, PathBuf::from(DEFAULT_SCENE));
        assert!(!run.fast && run.out.is_none() && run.scalar.is_none());
        let Some(Command::Eval(eval)) = Cli::parse_from(["host-sim", "eval", "a.csv"]).command
        else {
            panic!("not eval");
        };
        assert_eq!(eval.scalar, Scalar::F64);
        let micromath = [
            "host-sim",
            "eval",
            "--scalar",
            "micromath",
            "a.csv",
            "--out",
            "b.csv",
        ];
        assert!(Cli::try_parse_from(micromath).is_ok());
        assert!(Cli::try_parse_from(["host-sim", "eval"]).is_err());
        let linkage = ["host-sim", "linkage", "a.toml"];
        let Some(Command::Linkage(args)) = Cli::parse_from(linkage).command else {
            panic!("not linkage");
        };
        assert!(args.steps.is_none() && args.out.is_none());
        for steps in ["1", "100001", "-3", "x"] {
            let asked = linkage.into_iter().chain(["--steps", steps]);
            assert!(Cli::try_parse_from(asked).is_err(), "{steps}");
        }
    }
}
