//! The command line.

use crate::assemble::AssembleArgs;
use crate::bridge::BridgeArgs;
use crate::calibrate::CalibrateArgs;
use crate::check::CheckArgs;
use crate::completions::CompletionsArgs;
use crate::design::DesignArgs;
use crate::device::DeviceArgs;
use crate::eval::EvalArgs;
use crate::export::ExportArgs;
use crate::goals::{FollowArgs, GotoArgs, JogArgs, ParkArgs};
use crate::grbl::GrblArgs;
use crate::identify::IdentifyArgs;
use crate::init::InitArgs;
use crate::install::InstallArgs;
use crate::key::KeyArgs;
use crate::linkage::LinkageArgs;
use crate::machine::{DisableArgs, DrivesArgs, EnableArgs, OutputArgs, ProbeArgs, ToolArgs};
use crate::plan::PlanArgs;
use crate::report::ReportArgs;
use crate::run::RunArgs;
use crate::stream::StreamArgs;
use crate::ui::UiArgs;
use crate::update::UpdateArgs;
use crate::watch::WatchArgs;
use clap::{Parser, Subcommand};

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

/// Commands of the program.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene's job tick by tick at its rate, write a table and figures
    Run(RunArgs),
    /// Write a scene to begin with
    Init(InitArgs),
    /// Check a scene or a job, and say what it asks for
    Check(CheckArgs),
    /// Show a scene in a browser: drag the platform, edit, play the job
    Ui(UiArgs),
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
    /// Replace the program of a board over its line
    Update(UpdateArgs),
    /// Show the spare outputs and inputs of a machine, or switch an output
    Output(OutputArgs),
    /// Bring a scene to a board over its line, without a new image
    Install(InstallArgs),
    /// Move a machine to a pose, from rest or from any motion
    Goto(GotoArgs),
    /// Move a machine to the start of the scene's job, or to another pose, slowly
    Park(ParkArgs),
    /// Move a machine by hand: steps and velocities from standard input
    Jog(JogArgs),
    /// Send a machine to poses as they come, from standard input or a file
    Follow(FollowArgs),
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
    /// Plan a scene's path: its least time, a proven lower bound, what limits where, figures
    Plan(PlanArgs),
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
    use clap::CommandFactory;
    use std::path::PathBuf;
    use trirrr_scene::NumberType;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_defaults_are_those_of_the_contract() {
        let cli = Cli::parse_from(["trirrr"]);
        assert!(cli.command.is_none());
        let Some(Command::Run(run)) = Cli::parse_from(["trirrr", "run"]).command else {
            panic!("not run");
        };
        assert_eq!(run.scene, PathBuf::from(DEFAULT_SCENE));
        assert!(!run.fast && run.out.is_none() && run.scalar.is_none());
        let Some(Command::Eval(eval)) = Cli::parse_from(["trirrr", "eval", "a.csv"]).command else {
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
        assert!(Cli::try_parse_from(micromath).is_ok());
        assert!(Cli::try_parse_from(["trirrr", "eval"]).is_err());
        let linkage = ["trirrr", "linkage", "a.toml"];
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
