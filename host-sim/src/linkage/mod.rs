//! `trirrr linkage`: arguments, printing and exit codes round [`trirrr_linkage::assur`].

mod inverse;
mod json;

pub use inverse::InverseArgs;

use crate::failure::CliError;
use crate::pictures::PictureArgs;
use crate::results::ResultFolder;
use crate::terminal::print;
use clap::Args;
use std::path::{Path, PathBuf};
use trirrr_linkage::assur::{Linkage, files, header, stopped, study, summary, track};

/// `trirrr linkage`.
///
/// Decomposes a mechanism of links and joints into Assur groups, prints them in solving order,
/// and solves them over a turn or a range of the drives. Says how many loops and unknowns there are, which class four-bar loops
/// have, where dead points and singular positions are, how far rockers swing and sliders go. Writes linkage.csv (one row per
/// position, SI units) and figures as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Where the motion has an end (a dead point, a singular position), the input there and the group are \
named, and what was solved so far is written. With --inverse-deg or --inverse-rad the motion is not solved: both solutions for the end \
link are printed and written to out/NAME-inverse.")]
pub struct LinkageArgs {
    /// The mechanism, a TOML file (format: docs/linkage-files.md)
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Steps over the motion [default: the file's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub steps: Option<u32>,
    /// The inverse of a serial arm.
    #[command(flatten)]
    pub inverse: InverseArgs,
    /// Print one JSON object in place of the summary
    #[arg(long)]
    pub json: bool,
    /// Folder for what is written, made if missing; those of an earlier run go
    /// [default: out/NAME, after the linkage's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Figures as PNG.
    #[command(flatten)]
    pub pictures: PictureArgs,
}

/// Reads the linkage file, follows the linkage over its motion, writes the table and the figures,
/// prints the groups and a summary.
///
/// # Errors
/// Refused: the file. Failed: a file cannot be written, or the motion ends early; the positions
/// until then are written.
pub fn command(args: &LinkageArgs) -> Result<(), CliError> {
    let mut linkage =
        Linkage::read(&args.file).map_err(|error| CliError::Refused(error.to_string()))?;
    if let Some(end) = args.inverse.end()? {
        return inverse::command(args, &linkage, &end);
    }
    if let Some(steps) = args.steps {
        linkage.motion.steps = steps;
    }
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&linkage.name),
    };
    let track = track(&linkage);
    let mut results =
        ResultFolder::for_command(&folder, "linkage")?.with_pictures(args.pictures.png);
    if !track.positions.is_empty() {
        for (name, drawn) in files(&linkage, &track) {
            results.figure(name, drawn)?;
        }
        results.pictures()?;
    }
    // No position is a result too: those of an earlier linkage must not stand for it.
    results.begin()?;
    let why = track.stop.as_ref().map(|stop| stopped(&linkage, stop));
    results.end(why.as_deref())?;
    let figures = study(&linkage, &track);
    let text = match args.json {
        true => format!("{:#}\n", json::as_json(&linkage, &track, &figures)),
        false => {
            let head = header(&args.file.display().to_string(), &linkage);
            head + &summary(&linkage, &track, &figures, &results.files())
        }
    };
    print(&text)?;
    why.map_or(Ok(()), |why| Err(CliError::Failed(why)))
}
