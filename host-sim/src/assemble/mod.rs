//! `trirrr assemble`: every pose for given motor angles, and all motor angles for a pose.

mod args;
mod document;
mod figure;
mod find;

pub use args::{AssembleArgs, StandingArgs};

use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::show;
use document::{assemblies_table, document, working_modes_table};
use find::Modes;
use std::path::Path;

/// Finds the modes, writes tables and figures, and prints both lists.
///
/// # Errors
/// Refused: the scene; a pose that a leg does not reach; angles at which the platform fits nowhere or is loose. Failed: a file cannot be
/// written.
pub fn command(args: &AssembleArgs) -> Result<(), CliError> {
    let modes = Modes::find(args)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-assemble", modes.scene.name)),
    };
    let mut results = ResultFolder::for_command(&folder, "assemble")?;
    let failed = |error: Box<dyn std::error::Error + Send + Sync>| {
        CliError::Failed(format!("a figure: {error}"))
    };
    for (name, text) in [
        ("assemblies.csv", assemblies_table(&modes)),
        ("working_modes.csv", working_modes_table(&modes)),
        (
            "assemblies.svg",
            figure::assemblies(&modes).map_err(failed)?,
        ),
        (
            "working_modes.svg",
            figure::working_modes(&modes).map_err(failed)?,
        ),
    ] {
        results.write(name, text)?;
    }
    results.end(None)?;
    show(document(&modes).files(results.files()), args.json)
}
