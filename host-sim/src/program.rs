//! The program: reads the command line and carries out its command.

use crate::cli::{Cli, Command, FullCommand};
use crate::failure::CliError;
use crate::run::{JobEnd, RunArgs};
use crate::stream::StreamArgs;
use crate::terminal::say;
#[cfg(feature = "full")]
use crate::{
    assemble, calibrate, completions, design, eval, export, identify, install, linkage, report, ui,
    update,
};
use crate::{bridge, check, device, goals, grbl, init, key, machine, plan, run, stream, watch};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program that Ctrl-C ended, as shells report it: 128 + SIGINT.
const INTERRUPTED: u8 = 130;

/// Runs the program, and returns its exit code.
pub fn main() -> ExitCode {
    #[cfg(not(feature = "full"))]
    if let Some(name) = helped() {
        return ended(crate::handover::hand_over(&name));
    }
    // A bare call does the main job with its defaults, as the parser has them.
    let command = Cli::read_from(std::env::args_os())
        .unwrap_or_else(|error| error.exit())
        .command
        .unwrap_or_else(|| Command::Run(RunArgs::default()));
    let done = match &command {
        Command::Run(args) => run(args),
        Command::Init(args) => init::command(args).map(|()| ExitCode::SUCCESS),
        Command::Check(args) => check::command(args).map(|()| ExitCode::SUCCESS),
        Command::Device(args) => on_interrupt()
            .and_then(|stop| device::command(args, &stop))
            .map(|()| ExitCode::SUCCESS),
        Command::Bridge(args) => switch(|stop| bridge::command(args, stop)),
        Command::Watch(args) => switch(|stop| watch::command(args, stop)),
        Command::Key(args) => key::command(args).map(|()| ExitCode::SUCCESS),
        Command::Stream(args) => stream(args),
        Command::Enable(args) => switch(|stop| machine::enable(args, stop)),
        Command::Disable(args) => switch(|stop| machine::disable(args, stop)),
        Command::Drives(args) => switch(|stop| machine::drives(args, stop)),
        Command::Tool(args) => switch(|stop| machine::tool(args, stop)),
        Command::Probe(args) => switch(|stop| machine::probe(args, stop)),
        Command::Output(args) => switch(|stop| machine::output(args, stop)),
        Command::Grbl(args) => switch(|stop| grbl::command(args, stop)),
        Command::Goto(args) => to_the_end(|stop| goals::goto(args, stop)),
        Command::Park(args) => to_the_end(|stop| goals::park(args, stop)),
        Command::Jog(args) => to_the_end(|stop| goals::jog(args, stop)),
        Command::Follow(args) => to_the_end(|stop| goals::follow(args, stop)),
        Command::Plan(args) => plan::command(args).map(|()| ExitCode::SUCCESS),
        Command::Full(command) => in_full(command),
    };
    #[cfg(not(feature = "full"))]
    let done = match done {
        Err(CliError::InFull(what)) => crate::handover::hand_over(what),
        done => done,
    };
    ended(done)
}

/// Exit code of a command, whose failure is reported.
fn ended(done: Result<ExitCode, CliError>) -> ExitCode {
    done.unwrap_or_else(|failure| {
        // Standard error may be closed; the exit code still tells.
        say(&failure.to_string());
        ExitCode::from(failure.exit_code())
    })
}

/// Command that `trirrr help` is asked about, where `trirrr-full` carries it out: that program has its options.
#[cfg(not(feature = "full"))]
fn helped() -> Option<String> {
    let mut words = std::env::args_os()
        .skip(1)
        .map_while(|word| word.into_string().ok());
    let name = words
        .next()
        .filter(|word| word == "help")
        .and(words.next())?;
    <FullCommand as clap::Subcommand>::has_subcommand(&name).then_some(name)
}

/// Carries out a command that only `trirrr-full` has.
#[cfg(feature = "full")]
fn in_full(command: &FullCommand) -> Result<ExitCode, CliError> {
    match command {
        FullCommand::Update(args) => switch(|stop| update::command(args, stop)),
        FullCommand::Install(args) => switch(|stop| install::command(args, stop)),
        FullCommand::Ui(args) => switch(|stop| ui::command(args, stop)),
        FullCommand::Design(args) => to_the_end(|stop| design::command(args, stop)),
        FullCommand::Assemble(args) => assemble::command(args).map(|()| ExitCode::SUCCESS),
        // Only a conversation with a board has a clean end at Ctrl-C.
        FullCommand::Calibrate(args) if args.board.port.is_some() => {
            switch(|stop| calibrate::command(args, stop))
        }
        FullCommand::Calibrate(args) => {
            calibrate::command(args, &AtomicBool::new(false)).map(|()| ExitCode::SUCCESS)
        }
        FullCommand::Identify(args) => identify::command(args).map(|()| ExitCode::SUCCESS),
        FullCommand::Export(args) => export::command(args).map(|()| ExitCode::SUCCESS),
        FullCommand::Eval(args) => eval::command(args).map(|()| ExitCode::SUCCESS),
        FullCommand::Linkage(args) => linkage::command(args).map(|()| ExitCode::SUCCESS),
        FullCommand::Report(args) => report::command(args).map(|()| ExitCode::SUCCESS),
        FullCommand::Completions(args) => completions::command(args).map(|()| ExitCode::SUCCESS),
    }
}

/// Leaves a command to `trirrr-full`.
#[cfg(not(feature = "full"))]
fn in_full(_: &FullCommand) -> Result<ExitCode, CliError> {
    Err(CliError::InFull("this command"))
}

/// Returns the flag that Ctrl-C raises.
fn on_interrupt() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        // The first Ctrl-C asks for a clean end; the second one does not wait for that.
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    })
    .map_err(|error| CliError::Failed(format!("Ctrl-C cannot be handled: {error}")))?;
    Ok(stop)
}

fn stream(args: &StreamArgs) -> Result<ExitCode, CliError> {
    let stop = on_interrupt()?;
    match stream::command(args, &stop)? {
        stream::StreamEnd::Stopped if stop.load(Ordering::Relaxed) => {
            Ok(ExitCode::from(INTERRUPTED))
        }
        stream::StreamEnd::Stopped | stream::StreamEnd::Complete => Ok(ExitCode::SUCCESS),
    }
}

fn switch(go: impl FnOnce(&AtomicBool) -> Result<(), CliError>) -> Result<ExitCode, CliError> {
    let stop = on_interrupt()?;
    match go(&stop) {
        Err(why) if stop.load(Ordering::Relaxed) => {
            say(&why.to_string());
            Ok(ExitCode::from(INTERRUPTED))
        }
        done => done.map(|()| ExitCode::SUCCESS),
    }
}

fn to_the_end(
    go: impl FnOnce(&AtomicBool) -> Result<bool, CliError>,
) -> Result<ExitCode, CliError> {
    let stop = on_interrupt()?;
    let code = match go(&stop)? {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(INTERRUPTED),
    };
    Ok(code)
}

fn run(args: &RunArgs) -> Result<ExitCode, CliError> {
    let stop = on_interrupt()?;
    match run::command(args, &stop)? {
        JobEnd::Complete => Ok(ExitCode::SUCCESS),
        JobEnd::Stopped => Ok(ExitCode::from(INTERRUPTED)),
        JobEnd::Refused(why) => Err(CliError::Refused(why)),
        JobEnd::Fault(what) => Err(CliError::Failed(format!("fault: {what}"))),
    }
}
