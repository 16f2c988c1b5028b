//! `trirrr completions`: what a shell needs to complete the command line.

use crate::cli::Cli;
use crate::failure::CliError;
use crate::terminal::printed;
use clap::Args;
use clap_complete::Shell;
use std::io::{self, Write};

/// `trirrr completions`.
///
/// Prints a script that lets a shell complete commands and arguments: `trirrr completions bash > /etc/bash_completion.d/trirrr`.
#[derive(Args, Clone, Copy, Debug)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

/// Prints the script.
///
/// # Errors
/// Failed: standard output cannot be written.
pub fn command(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::syntax(), "trirrr", &mut script);
    let mut out = io::stdout().lock();
    printed(out.write_all(&script).and_then(|()| out.flush()))
}
