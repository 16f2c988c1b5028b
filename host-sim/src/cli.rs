//! The command line.

use crate::bridge::BridgeArgs;
use crate::check::CheckArgs;
use crate::device::DeviceArgs;
use crate::goals::{FollowArgs, GotoArgs, JogArgs, ParkArgs};
use crate::grbl::GrblArgs;
use crate::init::InitArgs;
use crate::key::KeyArgs;
use crate::machine::{DisableArgs, DrivesArgs, EnableArgs, OutputArgs, ProbeArgs, ToolArgs};
use crate::plan::PlanArgs;
use crate::run::RunArgs;
use crate::stream::StreamArgs;
use crate::watch::WatchArgs;
use clap::builder::ValueParser;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;
use trirrr_line::Address;

#[cfg(feature = "full")]
use crate::{
    assemble::AssembleArgs, calibrate::CalibrateArgs, completions::CompletionsArgs,
    design::DesignArgs, eval::EvalArgs, export::ExportArgs, identify::IdentifyArgs,
    install::InstallArgs, linkage::LinkageArgs, report::ReportArgs, ui::UiArgs, update::UpdateArgs,
};
// What `trirrr-full` carries out is not looked at here.
#[cfg(not(feature = "full"))]
use self::{
    HandedOver as AssembleArgs, HandedOver as CalibrateArgs, HandedOver as CompletionsArgs,
    HandedOver as DesignArgs, HandedOver as EvalArgs, HandedOver as ExportArgs,
    HandedOver as IdentifyArgs, HandedOver as InstallArgs, HandedOver as LinkageArgs,
    HandedOver as ReportArgs, HandedOver as UiArgs, HandedOver as UpdateArgs,
};

/// Arguments of a command that `trirrr-full` carries out.
#[cfg(not(feature = "full"))]
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct HandedOver {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    arguments: Vec<OsString>,
}

/// Simulator and host tools for the planar 3-RRR manipulator.
///
/// Without a command, runs scenes/thesis.toml in real time.
#[derive(Debug, Parser)]
#[command(name = "trirrr", version, max_term_width = 100)]
#[command(after_help = "\
Exit codes: 0 done; 1 failed, or the motion ended in a status; 2 refused: arguments, scene or \
table; 130 ended by Ctrl-C.")]
pub struct Cli {
    /// Command to carry out; `run` by default
    #[command(subcommand)]
    pub command: Option<Command>,
}

impl Cli {
    /// Returns the syntax of the command line. A value may begin with a minus sign wherever it is not a path, a text or an address:
    /// `--load-n -5` and `--origin -220,260` are no options.
    pub(crate) fn syntax() -> clap::Command {
        with_signed_values(Self::command())
    }

    /// Reads a command line, whose first word is the program.
    ///
    /// # Errors
    /// The command line is not in the syntax, or asks for help.
    pub fn read_from(
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Self, clap::Error> {
        Self::from_arg_matches(&Self::syntax().try_get_matches_from(with_height(words))?)
    }
}

/// Words of a command line, in which `--tool-by-z` without a number behind it has 0: what follows is no height.
fn with_height(words: impl IntoIterator<Item = impl Into<OsString>>) -> Vec<OsString> {
    let mut words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    let is_height = |word: &OsString| {
        let text = word.to_str().unwrap_or_default();
        let has_digit = text.contains(|c: char| c.is_ascii_digit());
        has_digit
            && text
                .chars()
                .all(|c| c.is_ascii_digit() || "+-.,".contains(c))
    };
    for index in 0..words.len() {
        if words[index] == "--tool-by-z" && !words.get(index + 1).is_some_and(is_height) {
            words[index] = "--tool-by-z=0".into();
        }
    }
    words
}

fn with_signed_values(command: clap::Command) -> clap::Command {
    let command = command.mut_args(|argument| {
        let is_option = argument.get_long().is_some() && argument.get_action().takes_values();
        match is_option && !is_free_text(argument.get_value_parser()) {
            true => argument.allow_hyphen_values(true),
            false => argument,
        }
    });
    command.mut_subcommands(with_signed_values)
}

/// Returns `true` if any word at all is a value: an option without its value must not take the next option for it.
fn is_free_text(parser: &ValueParser) -> bool {
    let value = parser.type_id();
    [
        TypeId::of::<PathBuf>(),
        TypeId::of::<String>(),
        TypeId::of::<Address>(),
    ]
    .into_iter()
    .any(|free| value == free)
}

/// Commands of the program.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene's job tick by tick at its rate, write a table and figures
    Run(RunArgs),
    /// Write a scene to begin with
    Init(InitArgs),
    /// Check a scene or a job, and say what it asks for
    Check(CheckArgs),
    /// Play a board: a scene's service behind a TCP port, in real time
    Device(DeviceArgs),
    /// Put the line of a board behind a TCP port
    Bridge(BridgeArgs),
    /// Look on while a machine moves
    Watch(WatchArgs),
    /// Write a new key for a device, a bridge and their clients
    Key(KeyArgs),
    /// Stream a scene's job to a board, write its telemetry and figures
    Stream(StreamArgs),
    /// Speak GRBL to senders of G-code, on one side of a machine
    Grbl(GrblArgs),
    /// Switch the drives of a machine on, where its motors are
    Enable(EnableArgs),
    /// Bring a machine to rest and switch its drives off
    Disable(DisableArgs),
    /// Show what the drives of a machine tell
    Drives(DrivesArgs),
    /// Show which tool a machine carries, or mount another
    Tool(ToolArgs),
    /// Move a machine straight until its probe touches, and tell where that is
    Probe(ProbeArgs),
    /// Show the spare outputs and inputs of a machine, or switch an output
    Output(OutputArgs),
    /// Move a machine to a pose, from rest or from any motion
    Goto(GotoArgs),
    /// Move a machine to the start of the scene's job, or to another pose, slowly
    Park(ParkArgs),
    /// Move a machine by hand: steps and velocities from standard input
    Jog(JogArgs),
    /// Send a machine to poses as they come, from standard input or a file
    Follow(FollowArgs),
    /// Plan a scene's path: its least time, a proven lower bound, what limits where, figures
    Plan(PlanArgs),
    /// Commands that `trirrr-full` carries out.
    #[command(flatten)]
    Full(FullCommand),
}

/// Commands that only `trirrr-full` carries out.
#[derive(Debug, Subcommand)]
pub enum FullCommand {
    /// Bring a scene to a board over its line, without a new image
    Install(InstallArgs),
    /// Replace the program of a board over its line
    Update(UpdateArgs),
    /// Show a scene in a browser: drag the platform, edit, play the job
    Ui(UiArgs),
    /// Answer design questions: working modes, workspace, ratios, forces in joints, as a report
    Design(DesignArgs),
    /// Find every pose for given motor angles, and all motor angles for a pose
    Assemble(AssembleArgs),
    /// Calibrate a machine from measured poses or distances; propose what to measure next
    Calibrate(CalibrateArgs),
    /// Identify masses, inertias and friction of a machine from its angles and torques
    Identify(IdentifyArgs),
    /// Write a scene's machine for MuJoCo, Gazebo, Drake, Pinocchio: MJCF, SDF, URDF
    Export(ExportArgs),
    /// Evaluate a table of cases: a machine and a state or a move in each row
    Eval(EvalArgs),
    /// Solve a planar linkage over its motion: Assur groups, table, figures
    Linkage(LinkageArgs),
    /// Measure what the numbers are worth and what they cost: errors, run times, extremes
    Report(ReportArgs),
    /// Print a script by which a shell completes the command line
    Completions(CompletionsArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::DEFAULT_SCENE;
    use clap::error::ErrorKind;
    use trirrr_scene::NumberType;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::syntax().debug_assert();
    }

    /// A height follows `--tool-by-z`, or anything else does.
    #[test]
    fn the_height_of_the_tool_is_0_where_none_is_given() {
        let height = |words: &[&str]| {
            let all = ["trirrr", "check", "--machine", "m.toml"]
                .iter()
                .chain(words);
            match Cli::read_from(all).map(|cli| cli.command) {
                Ok(Some(Command::Check(args))) => args.job.z.tool_by_z,
                other => panic!("{words:?}: {other:?}"),
            }
        };
        assert_eq!(height(&["a.nc"]), None);
        for words in [
            &["--tool-by-z", "3d.nc"][..],
            &["a.nc", "--tool-by-z"],
            &["a.nc", "--tool-by-z", "--json"],
            &["a.nc", "--tool-by-z", "0"],
        ] {
            assert_eq!(height(words), Some(0.0), "{words:?}");
        }
        assert_eq!(height(&["a.nc", "--tool-by-z", "-0.5"]), Some(-0.5));
        assert_eq!(height(&["--tool-by-z=2", "a.nc"]), Some(2.0));
        let comma = [
            "trirrr",
            "check",
            "a.nc",
            "--machine",
            "m.toml",
            "--tool-by-z",
            "0,5",
        ];
        let refused = Cli::read_from(comma).unwrap_err().to_string();
        assert!(refused.contains("comma: 0.5"), "{refused}");
    }

    #[test]
    fn a_negative_number_is_a_value_of_every_option_that_has_one() {
        let mut options = 0;
        for command in Cli::syntax().get_subcommands() {
            for option in command.get_arguments() {
                let (Some(name), true) = (option.get_long(), option.get_action().takes_values())
                else {
                    continue;
                };
                if is_free_text(option.get_value_parser()) {
                    continue;
                }
                options += 1;
                let count = option.get_num_args().map_or(1, |count| count.min_values());
                for value in ["-5", "-.5", "-5e-3", "-5,-6,-7", "-inf"] {
                    let name = format!("--{name}");
                    let mut words = vec!["trirrr", command.get_name(), &name];
                    words.extend(vec![value; count]);
                    // Others may lack, and the value may be out of its range: it is the value that is told.
                    if let Err(error) = Cli::read_from(words) {
                        let kind = error.kind();
                        assert_ne!(kind, ErrorKind::UnknownArgument, "{error}");
                        assert!(!error.to_string().contains("-- -"), "{error}");
                    }
                }
            }
        }
        assert!(options > 100, "{options}");
        let load = ["trirrr", "design", "--load-n", "-5"];
        let error = Cli::read_from(load).unwrap_err().to_string();
        assert!(error.contains("'-5' for '--load-n"), "{error}");
        let place = [
            "trirrr", "goto", "--port", "tcp:a:1", "--x", "-0.1", "--y", "-.2",
        ];
        let Some(Command::Goto(goto)) = Cli::read_from(place).unwrap().command else {
            panic!("not goto");
        };
        assert_eq!([goto.x, goto.y], [-0.1, -0.2]);
        // A value that is forgotten is not the next option.
        let forgotten = ["trirrr", "run", "--out", "--fast"];
        assert!(Cli::read_from(forgotten).is_err());
    }

    #[test]
    fn the_defaults_are_those_of_the_contract() {
        let cli = Cli::read_from(["trirrr"]).unwrap();
        assert!(cli.command.is_none());
        let Some(Command::Run(run)) = Cli::read_from(["trirrr", "run"]).unwrap().command else {
            panic!("not run");
        };
        assert_eq!(run.scene, PathBuf::from(DEFAULT_SCENE));
        assert!(!run.fast && run.out.is_none() && run.scalar.is_none());
        let Some(Command::Full(FullCommand::Eval(eval))) =
            Cli::read_from(["trirrr", "eval", "a.csv"]).unwrap().command
        else {
            panic!("not eval");
        };
        assert_eq!(eval.scalar, NumberType::F64);
        let micromath = [
            "trirrr",
            "eval",
            "--scalar",
            "micromath",
            "a.csv",
            "--out",
            "b.csv",
        ];
        assert!(Cli::read_from(micromath).is_ok());
        assert!(Cli::read_from(["trirrr", "eval"]).is_err());
        let linkage = ["trirrr", "linkage", "a.toml"];
        let Some(Command::Full(FullCommand::Linkage(args))) =
            Cli::read_from(linkage).unwrap().command
        else {
            panic!("not linkage");
        };
        assert!(args.steps.is_none() && args.out.is_none());
        for steps in ["1", "100001", "-3", "x"] {
            let asked = linkage.into_iter().chain(["--steps", steps]);
            assert!(Cli::read_from(asked).is_err(), "{steps}");
        }
    }
}
