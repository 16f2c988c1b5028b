//! `trirrr init`: writes a first scene.

use crate::arguments::BUILT_IN;
use crate::failure::CliError;
use crate::results::write_new;
use crate::terminal::print;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

/// `trirrr init`.
///
/// Writes a scene to begin with: a machine, its limits and a job, with comments. A file that is there stays.
#[derive(Args, Clone, Debug)]
pub struct InitArgs {
    /// File to write
    #[arg(default_value = "machine.toml", value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Scene to begin with: thesis lies flat and has no drives; vertical has gravity, masses and brushless motors; pick-stepper has steppers;
    /// engraving follows a path in the least time with a tool
    #[arg(long, value_name = "SCENE", default_value = BUILT_IN[0].0, value_parser = PossibleValuesParser::new(BUILT_IN.map(|(name, _)| name)))]
    pub from: String,
}

/// Writes the scene.
///
/// # Errors
/// Refused: the file is there already. Failed: it cannot be written.
pub fn command(args: &InitArgs) -> Result<(), CliError> {
    let file = &args.file;
    let text = BUILT_IN.iter().find(|(name, _)| *name == args.from);
    let text = text.map_or("", |(_, text)| text);
    write_new(file, text.as_bytes())?;
    let name = file.display();
    print(&format!(
        "wrote {name}. Change lengths, places and the job in it; then\n  trirrr check {name}\n  trirrr design {name}\n  trirrr run --fast {name}\n"
    ))
}
